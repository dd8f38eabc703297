// SPDX-License-Identifier: MIT
typedef rn_real rn_coefficient, rn_signal, rn_speed, rn_share;
enum { RN_ALL = 1 }; /* the whole of a share */

RN_INLINE rn_signal rn_enter(rn_real torque) { return torque; }
RN_INLINE rn_real rn_leave(rn_signal x) { return x; }
RN_INLINE rn_signal rn_product(rn_coefficient c, rn_signal x) { return c * x; }
/* What a section passes of x itself. */
RN_INLINE rn_signal rn_direct(rn_coefficient c, rn_signal x) { return c * x; }
RN_INLINE rn_signal rn_times(rn_signal x, rn_share share) { return share * x; }
/* The share that is left at a speed between full and none, and in a blend. */
RN_INLINE rn_share rn_fade(rn_speed speed, rn_speed full, rn_speed none) {
    const rn_share share = (speed - none) / (full - none);
    return share < 0 ? 0 : share > 1 ? 1 : share;
}
RN_INLINE rn_share rn_left(long step, long steps) { return 1 - (rn_share)step / (rn_share)steps; }
