// SPDX-License-Identifier: MIT
/* How each order shows at an angle: h has its cosine and sine. One that is twice an earlier one is its double angle. */
RN_INLINE void rn_angles(rn_real turns, rn_real* h) {
    int i;
    for (i = 0; i < RN_ORDERS; ++i) {
        if (rn_half[i] < 0) {
            rn_on_circle(rn_orders[i] * turns, &h[2 * i], &h[2 * i + 1]);
        } else {
            const rn_real c = h[2 * rn_half[i]], s = h[2 * rn_half[i] + 1], twice = s + s;
            h[2 * i] = rn_fma(-twice, s, 1);
            h[2 * i + 1] = twice * c;
        }
    }
}

/* The ripple of amplitudes z, each a cosine's and a sine's. */
RN_INLINE rn_real rn_shown(const rn_real* z, const rn_real* h) {
    rn_real sum = z[0] * h[0];
    int i;
    for (i = 1; i < 2 * RN_ORDERS; ++i) sum = rn_fma(z[i], h[i], sum);
    return sum;
}
