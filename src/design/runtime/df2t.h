// SPDX-License-Identifier: MIT
/* y = b0 x + b1 x1 + b2 x2 - a1 y1 - a2 y2: a1 and a2 are subtracted (SciPy's sign). */
typedef struct {
    rn_coefficient b0, b1, b2, a1, a2;
} rn_section;

typedef struct {
    rn_signal s1, s2;
} rn_memory;

/* As if x had been there for ever. */
RN_INLINE void rn_settle(const rn_section* c, rn_memory* m, rn_signal x) {
    m->s2 = (c->b2 - c->a2) * x;
    m->s1 = (c->b1 - c->a1) * x + m->s2;
}

RN_INLINE rn_signal rn_section_step(const rn_section* c, rn_memory* m, rn_signal x) {
    const rn_signal y = c->b0 * x + m->s1;
    m->s1 = c->b1 * x - c->a1 * y + m->s2;
    m->s2 = c->b2 * x - c->a2 * y;
    return y;
}
