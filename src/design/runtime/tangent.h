// SPDX-License-Identifier: MIT
/* tan(pi hz / sample_rate_hz), hz being relative to a centre. */
RN_INLINE rn_real rn_warped(rn_real center_hz, rn_real relative, rn_real sample_rate_hz) {
    rn_real cosine, sine;
    rn_on_circle((rn_real)0.5 * center_hz * relative / sample_rate_hz, &cosine, &sine);
    return sine / cosine;
}
