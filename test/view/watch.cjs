// SPDX-License-Identifier: BSD-3-Clause
// Viewers of `rio replay --view PORT`, by @foxglove/ws-protocol: node watch.cjs PORT HOW
//   watch    subscribes to everything, decodes it, prints topics and counts as JSON at the end
//   stall    subscribes to everything, then reads nothing
//   hostile  sends what no viewer should
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const WebSocket = require("ws");

const [port, how] = process.argv.slice(2);

function connect(tries = 100) {
  const socket = new WebSocket(`ws://127.0.0.1:${port}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
  socket.on("error", () => (tries > 0 ? setTimeout(() => connect(tries - 1), 100) : process.exit(1)));
  socket.on("open", () => ({ watch, stall, hostile })[how](socket, tries));
}

function watch(socket, tries) {
  const client = new FoxgloveClient({ ws: socket });
  socket.onopen?.({});
  const readers = new Map();
  const topics = {};
  let info;
  client.on("serverInfo", (event) => (info = event));
  client.on("advertise", (channels) => {
    for (const channel of channels) {
      const id = client.subscribe(channel.id);
      readers.set(id, [channel.topic, new MessageReader(parse(channel.schema, { ros2: true }))]);
    }
  });
  client.on("message", (event) => {
    const [topic, reader] = readers.get(event.subscriptionId);
    reader.readMessage(event.data);
    topics[topic] = (topics[topic] ?? 0) + 1;
  });
  client.on("close", () => {
    if (!info && tries > 0) return setTimeout(() => connect(tries - 1), 100); // the places are taken
    console.log(JSON.stringify({ name: info?.name, topics }));
    process.exit(0);
  });
}

function stall(socket) {
  socket.on("message", (data, binary) => {
    if (binary) return;
    const message = JSON.parse(data);
    if (message.op !== "advertise") return;
    const subscriptions = message.channels.map((c) => ({ id: c.id, channelId: c.id }));
    socket.send(JSON.stringify({ op: "subscribe", subscriptions }));
    socket.pause();
  });
  socket.on("close", () => process.exit(0));
}

function hostile(socket) {
  const bad = ["", "{", "[]", "null", "{\"op\":7}", "{\"op\":\"subscribe\"}", "{\"op\":\"subscribe\",\"subscriptions\":7}",
    "{\"op\":\"subscribe\",\"subscriptions\":[{\"id\":-1,\"channelId\":1e99},{\"id\":{},\"channelId\":[]}]}",
    "{\"op\":\"unsubscribe\",\"subscriptionIds\":[\"x\",-4,1e300,null]}",
    JSON.stringify({ op: "subscribe", subscriptions: Array.from({ length: 1500 }, (_, i) => ({ id: i, channelId: i % 9 })) }),
    "[".repeat(60000)];
  for (const text of bad) socket.send(text);
  socket.send(Buffer.alloc(50000, 0xff));
  socket.send("x".repeat(300000)); // more than a request may have
  const others = Array.from({ length: 30 }, () => new WebSocket(`ws://127.0.0.1:${port}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]));
  for (const other of others) other.on("error", () => {});
  let closed = false;
  socket.on("close", () => (closed = true));
  setTimeout(() => {
    console.log(closed ? "disconnected" : "still connected");
    process.exit(0);
  }, 2000);
}

connect();
