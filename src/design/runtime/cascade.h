// SPDX-License-Identifier: MIT
RN_INLINE rn_signal rn_cascade(const rn_section* c, rn_memory* m, rn_signal x) {
    int i;
    for (i = 0; i < RN_SECTIONS; ++i) x = rn_section_step(&c[i], &m[i], x);
    return x;
}

RN_INLINE void rn_settle_cascade(const rn_section* c, rn_memory* m, rn_signal x) {
    int i;
    for (i = 0; i < RN_SECTIONS; ++i) rn_settle(&c[i], &m[i], x);
}
