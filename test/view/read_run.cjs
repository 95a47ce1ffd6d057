// SPDX-License-Identifier: BSD-3-Clause
// Decodes every message of a file of `rio replay --mcap` by the definitions in it and prints, for
// each topic, its type, its number of messages, and the newest one of some, as JSON:
// node read_run.cjs FILE. Needs @mcap/core, @foxglove/rosmsg, @foxglove/rosmsg2-serialization.
const fs = require("fs");
const { McapIndexedReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

async function main() {
  const bytes = fs.readFileSync(process.argv[2]);
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  const decoders = new Map();
  const topics = {};
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (!decoders.has(channel.id)) {
      const text = new TextDecoder().decode(schema.data);
      decoders.set(channel.id, new MessageReader(parse(text, { ros2: true })));
    }
    const last = decoders.get(channel.id).readMessage(message.data);
    const stamp = last.header ?? (last.transforms ? last.transforms[0].header : undefined);
    if (stamp && BigInt(stamp.stamp.sec) * 1000000000n + BigInt(stamp.stamp.nanosec ?? stamp.stamp.nsec) !== message.logTime) {
      throw new Error(`${channel.topic}: the header has another time`);
    }
    const topic = (topics[channel.topic] ??= { type: schema.name, count: 0 });
    ++topic.count;
    topic.last = last;
  }
  const plain = (key, value) =>
    ArrayBuffer.isView(value) ? Array.from(value) : typeof value === "bigint" ? Number(value) : value;
  console.log(JSON.stringify(topics, plain));
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
