// SPDX-License-Identifier: MIT
typedef int32_t rn_real, rn_speed;
typedef int64_t rn_signal; /* a word of torque times 2^RN_FRACTION */
typedef int32_t rn_share;
enum {
    RN_ALL = 32768, /* the whole of a share */
    RN_UNUSED = 16  /* last bits of a signal that a product does without: it has 64, of which a coefficient takes 31 */
};

/* mantissa / 2^shift. Signals are shifted to the right as two's complement, as compilers do it. */
typedef struct {
    int32_t mantissa;
    int16_t shift;
} rn_coefficient;

RN_INLINE rn_signal rn_enter(rn_real torque) { return (rn_signal)torque * ((rn_signal)1 << RN_FRACTION); }
/* Rounded, and no larger than a word. */
RN_INLINE rn_real rn_leave(rn_signal x) {
    const rn_signal word = (x + ((rn_signal)1 << (RN_FRACTION - 1))) >> RN_FRACTION;
    return (rn_real)(word > 2147483647 ? 2147483647 : word < -2147483647 - 1 ? -2147483647 - 1 : word);
}
RN_INLINE rn_signal rn_product(rn_coefficient c, rn_signal x) {
    const int shift = c.shift - RN_UNUSED;
    return (c.mantissa * (x >> RN_UNUSED) + ((rn_signal)1 << (shift - 1))) >> shift;
}
/* What a section passes of x itself: its coefficient is what that is more than x, so that a notch passes a constant bit
   for bit. */
RN_INLINE rn_signal rn_direct(rn_coefficient c, rn_signal x) { return x + rn_product(c, x); }
RN_INLINE rn_signal rn_times(rn_signal x, rn_share share) { return (x >> 15) * share + (((x & 32767) * share) >> 15); }
/* The share that is left at a speed between full and none, and in a blend. */
RN_INLINE rn_share rn_fade(rn_speed speed, rn_speed full, rn_speed none) {
    const int64_t share = ((int64_t)speed - none) * RN_ALL / ((int64_t)full - none);
    return (rn_share)(share < 0 ? 0 : share > RN_ALL ? (int64_t)RN_ALL : share);
}
RN_INLINE rn_share rn_left(long step, long steps) { return (rn_share)((int64_t)(steps - step) * RN_ALL / steps); }
