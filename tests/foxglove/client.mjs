// A program with Foxglove's own client: node client.mjs URL COUNT [TOPIC JSON]...
//
// Publishes what it is given, subscribes to every channel, and prints the messages that come, one
// JSON in each line, until there are COUNT of them.

import { createRequire } from "node:module";

const require = createRequire(`${process.env.FOXGLOVE_MODULES}/package.json`);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");

const [url, count, ...published] = process.argv.slice(2);
const client = new FoxgloveClient({ ws: new WebSocket(url, ["foxglove.sdk.v1"]) });
const topics = new Map();
let left = Number(count);

client.on("error", (error) => {
  console.error(String(error));
  process.exit(1);
});
client.on("serverInfo", () => {
  for (let at = 0; at < published.length; at += 2) {
    const channel = client.advertise({ topic: published[at], encoding: "json", schemaName: "" });
    client.sendMessage(channel, new TextEncoder().encode(published[at + 1]));
  }
});
client.on("advertise", (channels) => {
  for (const channel of channels) {
    topics.set(client.subscribe(channel.id), channel.topic);
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const row = JSON.parse(new TextDecoder().decode(data));
  console.log(JSON.stringify([topics.get(subscriptionId), String(timestamp), row]));
  left -= 1;
  if (left === 0) {
    client.close();
  }
});
