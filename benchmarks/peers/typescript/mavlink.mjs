// node-mavlink beside generated code for the same messages of MAVLink 2: frames there and back.

import { strict as assert } from "node:assert";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { measure } from "./timing.mjs";

const request = JSON.parse(readFileSync(0, "utf8"));
const found = createRequire(request.tools);
const peer = found("node-mavlink");
const { common, minimal } = found("mavlink-mappings");
const ours = await import(pathToFileURL(request.module));
const sender = Object.keys(request.senders)[0];

const KINDS = {
  heartbeat: minimal.Heartbeat,
  attitude: common.Attitude,
  global_position_int: common.GlobalPositionInt,
};
const REGISTRY = Object.fromEntries(Object.values(KINDS).map((kind) => [kind.MSG_ID, kind]));
const camel = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

function theirs({ message, ...values }) {
  const made = new KINDS[message]();
  for (const [name, value] of Object.entries(values)) made[camel(name)] = value;
  return made;
}

const protocol = new peer.MavLinkProtocolV2(1, 1);
const { messages } = request;
const made = messages.map(theirs);
const frames = messages.map((message, index) =>
  ours.encode(message, { sender, form: request.form, parts: { seq: index & 255 } }),
);
frames.forEach((frame, index) => {
  assert.deepEqual(Buffer.from(frame), protocol.serialize(made[index], index & 255));
});
const stream = Buffer.concat(frames);

/** What is read of the stream, as its users do: by the two transforms, a message of each packet. */
function readByPeer() {
  return new Promise((resolve) => {
    const splitter = new peer.MavLinkPacketSplitter();
    const parser = splitter.pipe(new peer.MavLinkPacketParser());
    const items = [];
    parser.on("data", (packet) => {
      items.push(packet.protocol.data(packet.payload, REGISTRY[packet.header.msgid]));
      if (items.length === messages.length) resolve(items);
    });
    for (let at = 0; at < stream.length; at += 1024) splitter.write(stream.subarray(at, at + 1024));
    splitter.end();
  });
}

function readByOurs() {
  const decoder = new ours.Decoder(sender);
  const events = [];
  for (let at = 0; at < stream.length; at += 1024) {
    events.push(...decoder.feed(stream.subarray(at, at + 1024)));
  }
  return events;
}

const plain = (record) => Object.fromEntries(Object.entries(record).map(([name, value]) => [camel(name), value]));
readByOurs().forEach((event, index) => assert.deepEqual({ ...event.message }, messages[index]));
(await readByPeer()).forEach((item, index) => {
  const { message, ...values } = messages[index];
  for (const [name, value] of Object.entries(plain(values))) assert.equal(item[name], value, name);
});

const count = messages.length;
const decode = await measure({ "node-mavlink": readByPeer, protogen: readByOurs }, request.rounds);
const encode = await measure(
  {
    "node-mavlink": () => made.reduce((size, item, index) => size + protocol.serialize(item, index & 255).length, 0),
    protogen: () =>
      messages.reduce(
        (size, message, index) =>
          size + ours.encode(message, { sender, form: request.form, parts: { seq: index & 255 } }).length,
        0,
      ),
  },
  request.rounds,
);
process.stdout.write(JSON.stringify({ frames: count, bytes: stream.length, results: { decode, encode } }));
