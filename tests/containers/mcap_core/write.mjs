// SPDX-License-Identifier: MIT
// A log as a recording of sensor_msgs/msg/JointState, by MCAP's own writer: node write.mjs SCHEMA LOG.csv OUT.mcap
import { McapWriter } from "@mcap/core";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { parse } from "@foxglove/rosmsg";
import fs from "node:fs";
const schema = fs.readFileSync(process.argv[2], "utf8");
const rows = fs.readFileSync(process.argv[3], "utf8").trim().split("\n").slice(1).map((l) => l.split(",").map(Number));
const out = fs.openSync(process.argv[4], "w");
let position = 0n;
const writable = { position: () => position, write: async (b) => { fs.writeSync(out, b); position += BigInt(b.byteLength); } };
const mcap = new McapWriter({ writable, useStatistics: true, useSummaryOffsets: true, useChunks: true, useMessageIndex: true });
await mcap.start({ profile: "ros2", library: "" });
const schemaId = await mcap.registerSchema({ name: "sensor_msgs/msg/JointState", encoding: "ros2msg", data: new TextEncoder().encode(schema) });
const channelId = await mcap.registerChannel({ topic: "/joint_states", schemaId, messageEncoding: "cdr", metadata: new Map() });
const writer = new MessageWriter(parse(schema, { ros2: true }));
const start = 1700000000n * 1000000000n;
let sequence = 0;
for (const [t, v, tau, q] of rows) {
  const ns = start + BigInt(Math.round(t * 1e9));
  const data = writer.writeMessage({ header: { stamp: { sec: Number(ns / 1000000000n), nanosec: Number(ns % 1000000000n) }, frame_id: "base" },
    name: ["elbow", "wrist"], position: [q * Math.PI / 180, 0], velocity: [v * Math.PI / 180, 0], effort: [tau, 0.5 * tau] });
  await mcap.addMessage({ channelId, sequence: sequence++, logTime: ns, publishTime: ns, data });
}
await mcap.end();
