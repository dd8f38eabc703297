// SPDX-License-Identifier: MIT
/* Ripple of the joint's torque in Nm: subtract it from the sensor. motor_turns: the motor's angle in turns, 0 where the
   joint is at the map's zero; the fraction of the turn is enough. joint_deg: the joint's position; only for the second comb. */
RN_INLINE rn_real rn_torque(rn_real speed_deg_s, rn_real motor_turns, rn_real joint_deg) {
    rn_real z[RN_PARTS], h[2 * RN_ORDERS];
    rn_at(speed_deg_s, joint_deg, z);
    rn_angles(motor_turns, h);
    return rn_shown(z, h);
}
