// SPDX-License-Identifier: MIT
/* An amplitude in one direction; between two speeds along goes from -0.5 to 0.5. */
RN_INLINE rn_real rn_amplitude(int direction, int i, int at, rn_real along) {
    const rn_real* const v = &rn_amplitudes[direction * RN_PARTS * RN_COLUMNS + 2 * RN_PARTS * at];
    return RN_SPEEDS > 1 ? rn_fma(along, v[i + RN_PARTS], v[i]) : v[i];
}

/* Of each order the amplitudes of cosine and sine, Nm: RN_PARTS numbers, those of a second comb behind the first's. */
RN_INLINE void rn_at(rn_real speed_deg_s, rn_real joint_deg, rn_real* z) {
    const rn_real size = rn_abs(speed_deg_s), slowest = rn_limits[0];
    rn_real along = 0;
    int at = 0, i;
    if (RN_SPEEDS > 1) {
        while (at + 2 < RN_SPEEDS && rn_speeds[at + 1] < size) ++at;
        along = rn_fma(size, rn_slopes[at], rn_offsets[at]);
        if (rn_abs(along) > (rn_real)0.5) along = along < 0 ? (rn_real)-0.5 : (rn_real)0.5;
    }
    for (i = 0; i < RN_PARTS; ++i) z[i] = rn_amplitude(RN_DIRECTIONS > 1 && speed_deg_s <= -slowest, i, at, along);
    if (RN_DIRECTIONS > 1 && !(size >= slowest)) { /* the directions run into each other */
        const rn_real share = (rn_real)0.5 - (rn_real)0.5 * speed_deg_s / slowest;
        for (i = 0; i < RN_PARTS; ++i) z[i] = rn_fma(share, rn_amplitude(1, i, at, along) - z[i], z[i]);
    }
    if (RN_SECOND_COMB != 0) { /* turned by the joint's angle */
        const rn_real turned = rn_fma(joint_deg, (rn_real)0.002777777777777778, rn_limits[1]);
        for (i = 0; i < RN_ORDERS; ++i) {
            rn_real* const first = &z[2 * i];
            const rn_real* const second = &z[2 * (RN_ORDERS + i)];
            rn_real c, s;
            rn_on_circle(rn_orders[i] * turned, &c, &s);
            if (RN_SECOND_COMB < 0) s = -s;
            first[0] += rn_fma(c, second[0], s * second[1]);
            first[1] += rn_fma(c, second[1], -s * second[0]);
        }
    }
}
