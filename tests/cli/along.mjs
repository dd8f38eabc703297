// SPDX-License-Identifier: MIT
// The torque that a sensor of one joint shows, by MuJoCo, along a motion of all joints.
// usage: node along.mjs < case.json > torque.json   (with @mujoco/mujoco in ./node_modules)
//
// case.json: {"xml": a file of diagnose --improved-model improved.xml, "joint": its name, "rows": [[time, q..., v..., a...], ...] in rad}.
// The torque is qfrc_inverse, plus the force of the actuators ripple_*, less that of friction_*, whose bristles go along:
// of dz/dt = v - stiffness |v| / friction z the exact step at the speed of the row before.
import fs from 'fs';
import path from 'path';
import url from 'url';

const entry = path.resolve('node_modules/@mujoco/mujoco/mujoco.js');
const mujoco = await (await import(url.pathToFileURL(entry).href)).default();
const told = JSON.parse(fs.readFileSync(0, 'utf8'));
const model = mujoco.MjModel.from_xml_string(told.xml);
const data = new mujoco.MjData(model);
const joints = model.nv, ndyn = 10;
const place = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT.value, told.joint);
const mine = [];
for (let i = 0; i < model.nactuator; ++i) {
  if (model.actuator_trnid[2 * i] !== place) continue;
  const name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_ACTUATOR.value, i);
  mine.push({i, sign: name.startsWith('friction_') ? -1 : 1, state: model.actuator_actadr[i],
             stiffness: model.actuator_dynprm[ndyn * i + 5]});
}
const torque = [];
let before = null;
for (const row of told.rows) {
  for (let j = 0; j < joints; ++j) {
    data.qpos[j] = row[1 + j];
    data.qvel[j] = row[1 + joints + j];
  }
  mujoco.mj_forward(model, data);
  const forces = Array.from(data.actuator_force), slopes = Array.from(data.act_dot);
  for (let j = 0; j < joints; ++j) data.qacc[j] = row[1 + 2 * joints + j];
  mujoco.mj_inverse(model, data);
  let sum = data.qfrc_inverse[place];
  for (const one of mine) sum += one.sign * forces[one.i];
  torque.push(sum);
  const next = told.rows[torque.length];
  if (next === undefined) continue;
  for (const one of mine) {
    if (one.state < 0) continue;
    const friction = model.actuator_biasprm[ndyn * one.i + 3];
    const rate = one.stiffness * Math.abs(data.qvel[place]) / friction, time = next[0] - row[0];
    data.act[one.state] += slopes[one.state] * (rate > 0 ? -Math.expm1(-rate * time) / rate : time);
  }
}
fs.writeSync(1, JSON.stringify(torque) + '\n');
