// SPDX-License-Identifier: BSD-3-Clause
// Reads an MCAP file with @mcap/core, as a stream with its check sums and by its index, for
// recording_writer_test.cpp: node read_mcap.cjs FILE
const fs = require("fs");
const { McapStreamReader, McapIndexedReader } = require("@mcap/core");

async function main() {
  const bytes = fs.readFileSync(process.argv[2]);
  const stream = new McapStreamReader({ validateCrcs: true });
  stream.append(bytes);
  const schemas = new Map();
  const channels = new Map();
  for (let record; (record = stream.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel" && !channels.has(record.id)) {
      channels.set(record.id, { ...record, count: 0 });
    }
    if (record.type === "Message") {
      const channel = channels.get(record.channelId);
      if (record.sequence !== channel.count++) throw new Error("sequence");
    }
  }
  if (!stream.done()) throw new Error("the file goes on");
  for (const c of channels.values()) {
    const schema = schemas.get(c.schemaId);
    console.log(c.topic, schema.name, schema.encoding, c.messageEncoding, c.count);
  }
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) =>
      new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  let count = 0;
  let last = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    if (message.logTime < last) throw new Error("order of time");
    last = message.logTime;
    ++count;
  }
  if (reader.statistics.messageCount !== BigInt(count)) throw new Error("statistics");
  console.log(
    `chunks ${reader.statistics.chunkCount}, with an index ${reader.chunkIndexes.length}, ` +
      `messages by the index ${count}`,
  );
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
