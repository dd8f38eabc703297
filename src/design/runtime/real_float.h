// SPDX-License-Identifier: MIT
typedef float rn_real;

/* a b + c, in one instruction where the processor has it; RN_UNFUSED: the same bits on every processor. */
#if (defined FP_FAST_FMAF || defined __FP_FAST_FMAF) && !defined RN_UNFUSED
RN_INLINE float rn_fma(float a, float b, float c) { return fmaf(a, b, c); }
#else
RN_INLINE float rn_fma(float a, float b, float c) { return a * b + c; }
#endif
RN_INLINE float rn_abs(float value) { return fabsf(value); }
RN_INLINE float rn_sqrt(float value) { return sqrtf(value); }
/* What is beyond the nearest whole number, which an int has to hold. */
RN_INLINE float rn_beside_whole(float value) {
    value -= (float)(int)value;
    return value - (float)(int)(value + value);
}
/* Polynomials in the square of the quarter turns from the nearest whole one, by interpolation at Chebyshev points:
   within 2.5e-9 except for rounding. */
RN_INLINE void rn_on_circle(float turns, float* cosine, float* sine) {
    const float quarters = 4 * turns;
    const int quarter = (int)(quarters + (quarters < 0 ? -0.5f : 0.5f));
    const float a = quarters - (float)quarter, s = a * a;
    float y = rn_fma(s, rn_fma(s, -4.60214921e-3f, 7.96802176e-2f), -6.45963478e-1f);
    float x = rn_fma(s, rn_fma(s, 9.06739898e-4f, -2.08615283e-2f), 2.5366941e-1f);
    y = a * rn_fma(s, y, 1.57079632f);
    x = rn_fma(s, rn_fma(s, x, -1.23370055f), 1.0f);
    if (quarter & 1) {
        const float turned = x;
        x = -y;
        y = turned;
    }
    *cosine = quarter & 2 ? -x : x;
    *sine = quarter & 2 ? -y : y;
}
