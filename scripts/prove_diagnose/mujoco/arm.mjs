// SPDX-License-Identifier: MIT
// The torque of an arm, by MuJoCo. usage: node arm.mjs < case.json > log.csv   (with @mujoco/mujoco in ./node_modules)
//
// case.json: {"xml": the arm, with a motor a cogging and its joints named, "rows": [[time, q..., v..., a...], ...] in rad}.
// A row of the log: time, then of each joint the torque that would have to act on it, and what its motors' cogging adds.
import fs from 'fs';
import path from 'path';
import url from 'url';

const entry = path.resolve('node_modules/@mujoco/mujoco/mujoco.js');
const mujoco = await (await import(url.pathToFileURL(entry).href)).default();
const told = JSON.parse(fs.readFileSync(0, 'utf8'));
const model = mujoco.MjModel.from_xml_string(told.xml);
const data = new mujoco.MjData(model);
const joints = model.nv;
const lines = [];
for (const row of told.rows) {
  for (let j = 0; j < joints; ++j) {
    data.qpos[j] = row[1 + j];
    data.qvel[j] = row[1 + joints + j];
  }
  mujoco.mj_forward(model, data);
  const cogging = Array.from(data.qfrc_actuator);
  for (let j = 0; j < joints; ++j) data.qacc[j] = row[1 + 2 * joints + j];
  mujoco.mj_inverse(model, data);
  lines.push([row[0], ...Array.from(data.qfrc_inverse), ...cogging].join(','));
}
fs.writeSync(1, lines.join('\n') + '\n');
