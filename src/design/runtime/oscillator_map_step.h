// SPDX-License-Identifier: MIT
/* Every sample, RN_SAMPLE_RATE_HZ times a second: the torque without ripple. motor_turns is the motor's angle in
   turns, 0 where the joint is at position 0; the fraction of the turn is enough. speed_deg_s and joint_deg: the joint's velocity and position,
   where its map depends on them. */
RN_INLINE rn_real rn_step(rn_state* s, rn_real torque_nm, rn_real motor_turns, rn_real speed_deg_s, rn_real joint_deg) {
    rn_sample now;
    rn_real z[RN_PARTS];
    rn_at(speed_deg_s, joint_deg, z);
    return rn_run(s, &now, torque_nm, motor_turns, z);
}
