// SPDX-License-Identifier: BSD-3-Clause
// Frames of node-mavlink, for frame_test.cpp: node referee.cjs MESSAGES FRAMES
// A line of MESSAGES: name, version, sequence, system, component, the fields in the order of the wire, numbers of
// arrays one by one, floats as the integers of their bits.
const fs = require("fs");
const { MavLinkProtocolV1, MavLinkProtocolV2, common, minimal } = require("node-mavlink");

const kinds = {
  HEARTBEAT: minimal.Heartbeat,
  TIMESYNC: common.TimeSync,
  ODOMETRY: common.Odometry,
  HIGHRES_IMU: common.HighresImu,
  RAW_IMU: common.RawImu,
  SCALED_IMU: common.ScaledImu,
};

function number(text, type) {
  if (type.startsWith("float")) {
    const bytes = Buffer.alloc(4);
    bytes.writeUInt32LE(Number(text));
    return bytes.readFloatLE();
  }
  return type.includes("64") ? BigInt(text) : Number(text);
}

function frame(line) {
  const [name, version, sequence, system, component, ...values] = line.split(" ");
  const message = new kinds[name]();
  for (const field of kinds[name].FIELDS) {
    const take = () => number(values.shift(), field.type);
    message[field.name] = field.type.endsWith("[]") ? Array.from({ length: field.length }, take) : take();
  }
  if (values.length !== 0) throw new Error(`${name}: ${values.length} values too many`);
  const Protocol = version === "1" ? MavLinkProtocolV1 : MavLinkProtocolV2;
  return new Protocol(Number(system), Number(component)).serialize(message, Number(sequence));
}

const lines = fs.readFileSync(process.argv[2], "utf8").trim().split("\n");
fs.writeFileSync(process.argv[3], Buffer.concat(lines.map(frame)));
