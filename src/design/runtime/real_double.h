// SPDX-License-Identifier: MIT
typedef double rn_real;

RN_INLINE double rn_fma(double a, double b, double c) { return a * b + c; }
RN_INLINE double rn_abs(double value) { return fabs(value); }
RN_INLINE double rn_sqrt(double value) { return sqrt(value); }
/* What is beyond the nearest whole number. */
RN_INLINE double rn_beside_whole(double value) { return value - floor(value + 0.5); }
RN_INLINE void rn_on_circle(double turns, double* cosine, double* sine) {
    const double angle = 6.283185307179586 * (turns - floor(turns));
    *cosine = cos(angle);
    *sine = sin(angle);
}
