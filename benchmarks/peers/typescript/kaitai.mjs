// Code of Kaitai Struct's compiler beside generated code: payloads alone, which are read.

import { strict as assert } from "node:assert";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { measure } from "./timing.mjs";

const request = JSON.parse(readFileSync(0, "utf8"));
const found = createRequire(request.tools);
const KaitaiStream = found("kaitai-struct/KaitaiStream");
const modules = found(request.kaitai);
const kind = modules[request.class] ?? modules;
const ours = await import(pathToFileURL(request.module));
const { readPayload } = await import(pathToFileURL(request.runtime));
const plan = ours[request.plan];

const payloads = request.payloads.map((payload) => Uint8Array.from(Buffer.from(payload, "hex")));
const camel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

/** The message; numbers that are worked out when they are asked for are asked for. */
function byKaitai(payload) {
  const item = new kind(new KaitaiStream(payload, 0));
  if (request.class === "Gyro") void (item.intX + item.intY + item.intZ);
  // Instances would need an object for each distance.
  if (request.class === "Lidar") item.distances = item.codes.map((code) => (code & 0x7f) | ((code >> 1) & 0x3f80));
  return item;
}

function same(value, due) {
  if (Array.isArray(due)) due.forEach((item, index) => same(value[index], item));
  else if (typeof due === "object") for (const name of Object.keys(due)) same(value[camel(name)], due[name]);
  else assert.equal(Number(value), due);
}

for (const payload of payloads) {
  const { message, ...due } = readPayload(plan, payload);
  same(byKaitai(payload), due);
}

const over = (read) => () => {
  let last;
  for (let index = 0; index < payloads.length; index++) last = read(payloads[index]);
  return last;
};
const decode = await measure(
  { Kaitai: over(byKaitai), protogen: over((payload) => readPayload(plan, payload)) },
  request.rounds,
);
process.stdout.write(JSON.stringify({ frames: payloads.length, results: { decode } }));
