// SPDX-License-Identifier: BSD-3-Clause
// Reads an MCAP file with @mcap/core, as a stream with its check sums and by its index, tells what
// is in it, and writes its messages anew, for recording_writer_test.cpp: node copy_mcap.cjs FROM TO
const fs = require("fs");
const { McapStreamReader, McapIndexedReader, McapWriter, TempBuffer } = require("@mcap/core");

function readStream(bytes) {
  const stream = new McapStreamReader({ validateCrcs: true });
  stream.append(bytes);
  const [schemas, channels, messages] = [new Map(), new Map(), []];
  for (let record; (record = stream.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel" && !channels.has(record.id)) {
      channels.set(record.id, { ...record, count: 0 });
    }
    if (record.type !== "Message") continue;
    if (record.sequence !== channels.get(record.channelId).count++) throw new Error("sequence");
    messages.push(record);
  }
  if (!stream.done()) throw new Error("the file goes on");
  for (const c of channels.values()) {
    const schema = schemas.get(c.schemaId);
    console.log(c.topic, schema.name, schema.encoding, c.messageEncoding, c.count);
  }
  return [schemas, channels, messages];
}

async function readByIndex(bytes) {
  const reader = await McapIndexedReader.Initialize({ readable: new TempBuffer(bytes) });
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

async function write(path, schemas, channels, messages) {
  const writable = new TempBuffer();
  const writer = new McapWriter({ writable, chunkSize: 4096 });
  await writer.start({ profile: "ros2", library: "" });
  const ids = new Map();
  for (const [id, c] of channels) {
    const schemaId = await writer.registerSchema(schemas.get(c.schemaId));
    ids.set(id, await writer.registerChannel({ ...c, schemaId }));
  }
  for (const m of messages) await writer.addMessage({ ...m, channelId: ids.get(m.channelId) });
  await writer.end();
  fs.writeFileSync(path, writable.get());
}

async function main() {
  const bytes = fs.readFileSync(process.argv[2]);
  const read = readStream(bytes);
  await readByIndex(bytes);
  await write(process.argv[3], ...read);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
