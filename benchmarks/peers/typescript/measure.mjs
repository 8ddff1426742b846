// Compares what contenders read and write with what is due, and then measures them.
//
// Takes a request as JSON and prints the times as JSON. Each protocol has a process of its own, as a
// user has one protocol most often: what the machine compiles for one would be slower for several.

import { strict as assert } from "node:assert";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { measure } from "./timing.mjs";

const request = JSON.parse(readFileSync(0, "utf8"));
const codecs = {};
for (const [name, { module, adapter }] of Object.entries(request.contenders)) {
  const { codec } = await import(pathToFileURL(adapter ?? module));
  codecs[name] = typeof codec === "function" ? codec(await import(pathToFileURL(module)), request) : codec;
}

const frames = request.frames.map((frame) => Uint8Array.from(Buffer.from(frame, "hex")));
const { messages, counters } = request;
const stream = Uint8Array.from(Buffer.concat(frames));

function portions(size) {
  const found = [];
  for (let at = 0; at < stream.length; at += size) found.push(stream.subarray(at, at + size));
  return found;
}

/** Events of all portions; the number of messages is told, so that nothing is left out. */
function decodeAll(codec, parts) {
  const decoder = codec.decoder();
  let count = 0;
  for (const part of parts) count += decoder.feed(part).length;
  return count;
}

for (const [name, codec] of Object.entries(codecs)) {
  for (const size of [...request.portions, stream.length]) {
    const decoder = codec.decoder();
    const events = portions(size).flatMap((part) => decoder.feed(part));
    assert.deepEqual(events.map((event) => ({ ...event.message })), messages, name);
    assert.ok(events.every((event) => event.kind === "message"), name);
    if (codec.counter) assert.deepEqual(events.map(codec.counter), counters, name);
  }
  messages.forEach((message, index) => {
    assert.deepEqual(Buffer.from(codec.encode(message, counters[index])), Buffer.from(frames[index]), name);
  });
}

if (request.noise) {
  // What stands in noise, by each contender.
  const found = {};
  for (const [name, codec] of Object.entries(codecs)) {
    found[name] = request.noise.map((data) => {
      const decoder = codec.decoder();
      const bytes = Uint8Array.from(Buffer.from(data, "hex"));
      const events = [];
      for (let at = 0; at < bytes.length; at += 7) events.push(...decoder.feed(bytes.slice(at, at + 7)));
      return events.filter(({ kind }) => kind === "message").map(({ offset, message }) => [offset, message]);
    });
  }
  process.stdout.write(JSON.stringify(found));
} else {
  const results = {};
  for (const size of [...request.portions, stream.length]) {
    const parts = portions(size);
    const runs = {};
    for (const [name, codec] of Object.entries(codecs)) runs[name] = () => decodeAll(codec, parts);
    results[size === stream.length ? "whole" : size] = await measure(runs, request.rounds);
  }
  const runs = {};
  for (const [name, codec] of Object.entries(codecs)) {
    runs[name] = () => {
      let size = 0;
      for (let index = 0; index < messages.length; index++) {
        size += codec.encode(messages[index], counters[index]).length;
      }
      return size;
    };
  }
  results.encode = await measure(runs, request.rounds);
  process.stdout.write(JSON.stringify({ bytes: stream.length, frames: frames.length, results }));
}
