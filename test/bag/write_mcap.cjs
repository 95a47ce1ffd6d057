// SPDX-License-Identifier: BSD-3-Clause
// Writes an MCAP file with @mcap/core, for referee_test.cpp: node write_mcap.cjs FILE
const fs = require("fs");
const { McapWriter } = require("@mcap/core");

class Cdr {
  constructor() {
    this.bytes = [0, 1, 0, 0];
  }
  put(size, write) {
    while ((this.bytes.length - 4) % size) this.bytes.push(0);
    const buffer = Buffer.alloc(size);
    write(buffer);
    this.bytes.push(...buffer);
    return this;
  }
  u8(v) { return this.put(1, (b) => b.writeUInt8(v)); }
  u32(v) { return this.put(4, (b) => b.writeUInt32LE(v)); }
  f64(v) { return this.put(8, (b) => b.writeDoubleLE(v)); }
  text(v) {
    this.u32(v.length + 1);
    this.bytes.push(...Buffer.from(v + "\0"));
    return this;
  }
  header(ns, frame) {
    return this.u32(Math.floor(ns / 1e9)).u32(ns % 1e9).text(frame);
  }
}

function imu(ns, i) {
  const cdr = new Cdr().header(ns, "imu_link");
  const values = Array(37).fill(0);
  [values[13], values[14], values[15]] = [0.5, -0.25, i];
  [values[25], values[27]] = [0.125 * i, 9.75];
  values.forEach((v) => cdr.f64(v));
  return cdr.bytes;
}

function cloud(ns, i) {
  const names = ["x", "y", "z", "intensity", "velocity"];
  const cdr = new Cdr().header(ns, "radar").u32(1).u32(2).u32(names.length);
  names.forEach((name, k) => cdr.text(name).u32(4 * k).u8(7).u32(1));
  cdr.u8(0).u32(20).u32(40).u32(40);
  cdr.bytes.push(...Buffer.from(new Float32Array([1, 2, 3, 10, -0.5, 4, 5, 6, 20, i]).buffer));
  return cdr.u8(1).bytes;
}

async function main() {
  const chunks = [];
  let position = 0n;
  const writable = {
    position: () => position,
    write: async (bytes) => {
      chunks.push(Buffer.from(bytes));
      position += BigInt(bytes.length);
    },
  };
  const writer = new McapWriter({ writable, chunkSize: 4096 });
  await writer.start({ profile: "ros2", library: "" });
  const channel = async (topic, name) => {
    const data = Buffer.from("std_msgs/Header header\n");
    const schemaId = await writer.registerSchema({ name, encoding: "ros2msg", data });
    const metadata = new Map();
    return writer.registerChannel({ topic, schemaId, messageEncoding: "cdr", metadata });
  };
  const imuId = await channel("/imu", "sensor_msgs/msg/Imu");
  const radarId = await channel("/radar", "sensor_msgs/msg/PointCloud2");
  for (let i = 0; i < 300; ++i) {
    const ns = 1e12 + 1e6 * i;
    const add = (channelId, delay, bytes) =>
      writer.addMessage({
        channelId,
        sequence: i,
        logTime: BigInt(ns + delay),
        publishTime: BigInt(ns),
        data: Uint8Array.from(bytes),
      });
    await add(imuId, 500, imu(ns, i));
    if (i % 10 === 0) await add(radarId, 700, cloud(ns, i));
  }
  await writer.end();
  fs.writeFileSync(process.argv[2], Buffer.concat(chunks));
}

main();
