// SPDX-License-Identifier: MIT
typedef struct {
    rn_coefficient a1, a2, a3, m0, m1, m2;
} rn_section;

typedef struct {
    rn_signal s1, s2;
} rn_memory;

/* As if x had been there for ever. */
RN_INLINE void rn_settle(const rn_section* c, rn_memory* m, rn_signal x) {
    (void)c;
    m->s1 = 0;
    m->s2 = x;
}

RN_INLINE rn_signal rn_section_step(const rn_section* c, rn_memory* m, rn_signal x) {
    const rn_signal v3 = x - m->s2;
    const rn_signal v1 = rn_product(c->a1, m->s1) + rn_product(c->a2, v3);
    const rn_signal v2 = m->s2 + rn_product(c->a2, m->s1) + rn_product(c->a3, v3);
    m->s1 = v1 + v1 - m->s1;
    m->s2 = v2 + v2 - m->s2;
    return rn_direct(c->m0, x) + rn_product(c->m1, v1) + rn_product(c->m2, v2);
}
