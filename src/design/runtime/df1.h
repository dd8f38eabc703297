// SPDX-License-Identifier: MIT
/* y = b0 x + b1 x1 + b2 x2 - a1 y1 - a2 y2: a1 and a2 are subtracted (SciPy's sign). */
typedef struct {
    rn_coefficient b0, b1, b2, a1, a2;
} rn_section;

typedef struct {
    rn_signal x1, x2, y1, y2;
} rn_memory;

/* As if x had been there for ever. */
RN_INLINE void rn_settle(const rn_section* c, rn_memory* m, rn_signal x) {
    (void)c;
    m->x1 = m->x2 = m->y1 = m->y2 = x;
}

RN_INLINE rn_signal rn_section_step(const rn_section* c, rn_memory* m, rn_signal x) {
    const rn_signal y = c->b0 * x + c->b1 * m->x1 + c->b2 * m->x2 - c->a1 * m->y1 - c->a2 * m->y2;
    m->x2 = m->x1;
    m->x1 = x;
    m->y2 = m->y1;
    m->y1 = y;
    return y;
}
