// Foxglove's own client of its protocol, with the reader of ROS 2 messages that Foxglove and Lichtblick use. It prints
// what it gets as lines of JSON.
//
// usage: OCTOSKIN_NPM=FOLDER node foxglove_client.js PORT SUBPROTOCOL SECONDS TOPIC... [-- SERVICE JSON|asset URI]...
// FOLDER has the installed packages in oracles/node_modules.
"use strict";

const path = require("path");
const oracles = path.join(path.resolve(process.env.OCTOSKIN_NPM ?? "build/npm"), "oracles", "node_modules");
const load = (name) => require(path.join(oracles, name));
const { FoxgloveClient } = load("@foxglove/ws-protocol");
const { parse } = load("@foxglove/rosmsg");
const { MessageReader } = load("@foxglove/rosmsg2-serialization");
const WebSocket = load("ws");

const [port, subprotocol, seconds, ...rest] = process.argv.slice(2);
const split = rest.indexOf("--") < 0 ? rest.length : rest.indexOf("--");
const topics = rest.slice(0, split);
const calls = rest.slice(split + 1);

const print = (event, content) => console.log(JSON.stringify({ event, ...content }, (_, value) =>
  typeof value === "bigint" ? value.toString() :
  ArrayBuffer.isView(value) && !(value instanceof DataView) ? Array.from(value).slice(0, 16) : value));

const socket = new WebSocket(`ws://127.0.0.1:${port}`, [subprotocol]);
socket.on("unexpected-response", (_, response) => {
  print("refused", { status: response.statusCode });
  process.exit(1);
});
const client = new FoxgloveClient({ ws: socket });
const readers = new Map();

client.on("error", (error) => print("error", { message: error.message }));
client.on("close", () => process.exit(0));
client.on("open", () => print("open", { subprotocol: socket.protocol }));
client.on("serverInfo", (info) => {
  print("serverInfo", { info });
  for (let i = 0; i + 1 < calls.length; i += 2)
    if (calls[i] === "asset") client.fetchAsset(calls[i + 1], i / 2);
});
client.on("fetchAssetResponse", ({ requestId, status, error, data }) =>
  print("asset", { call: requestId, status, error, data: data && Buffer.from(data.buffer, data.byteOffset, data.byteLength).toString("base64") }));
client.on("status", (status) => print("status", { status }));
client.on("advertise", (channels) => {
  for (const channel of channels) {
    print("channel", { topic: channel.topic, encoding: channel.encoding, schemaName: channel.schemaName });
    if (!topics.includes(channel.topic)) continue;
    const reader = channel.encoding === "cdr" ? new MessageReader(parse(channel.schema, { ros2: true })) : undefined;
    readers.set(client.subscribe(channel.id), { channel, reader });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { channel, reader } = readers.get(subscriptionId);
  const message = { topic: channel.topic, timestamp, bytes: data.byteLength };
  if (reader) message.fields = reader.readMessage(data);
  if (channel.encoding === "json") message.fields = JSON.parse(new TextDecoder().decode(data));
  print("message", message);
});
client.on("advertiseServices", (services) => {
  for (let i = 0; i + 1 < calls.length; i += 2) {
    const service = services.find((one) => one.name === calls[i]);
    if (!service) continue;
    const bytes = new TextEncoder().encode(calls[i + 1]);
    const data = new DataView(bytes.buffer);
    client.sendServiceCallRequest({ serviceId: service.id, callId: i / 2, encoding: "json", data });
  }
});
client.on("serviceCallResponse", (answer) => print("answer", {
  call: answer.callId, encoding: answer.encoding, fields: JSON.parse(new TextDecoder().decode(answer.data)) }));
client.on("serviceCallFailure", (failure) => print("failure", { call: failure.callId, message: failure.message }));
setTimeout(() => process.exit(0), Number(seconds) * 1000);
