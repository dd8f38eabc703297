// SPDX-License-Identifier: MIT
/* The largest error, in the unit of the torque; assert that it is within the tolerance. */
RN_INLINE rn_signal rn_self_test(void) {
    rn_state state;
    rn_signal largest = 0;
    int k;
    rn_init(&state);
    for (k = 0; k < RN_GOLDEN; ++k) {
        const rn_signal found = rn_step(&state, (rn_real)rn_golden[k][0], (rn_speed)rn_golden[k][1]);
        const rn_signal error = found - rn_golden[k][2], size = error < 0 ? -error : error;
        if (!(size <= largest)) largest = size;
        if (!(largest >= 0)) break; /* not a number, and nothing larger can come */
    }
    return largest;
}
#endif
