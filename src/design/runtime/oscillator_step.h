// SPDX-License-Identifier: MIT
/* Every sample, RN_SAMPLE_RATE_HZ times a second: the torque without ripple. motor_turns is the motor's angle in
   turns, 0 where the joint is at position 0; the fraction of the turn is enough. */
RN_INLINE rn_real rn_step(rn_state* s, rn_real torque_nm, rn_real motor_turns) {
    rn_sample now;
    return rn_run(s, &now, torque_nm, motor_turns, 0);
}
