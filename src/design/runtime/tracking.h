// SPDX-License-Identifier: MIT
typedef struct {
    rn_real gear_ratio; /* turns of the shaft by which the orders count per turn of the speed's, in the speed's unit */
    rn_real sample_rate_hz, q_each, narrow_hz;
    rn_real depth_gain; /* at the centre of a notch */
    rn_real min_hz;     /* lowest centre */
    rn_real fade_hz, speed_pole, slew;
} rn_constants;

typedef struct rn_notch {
    rn_real a1, a2, a3, damping, s1, s2;
} rn_notch;

#ifndef RN_PREVIEW
typedef struct {
    rn_real center, taken; /* taken: share of the band-pass that is subtracted */
    rn_notch notch[RN_NOTCHES];
} rn_line;

typedef struct {
    rn_line line[RN_ORDERS];
    rn_real origin, speed, tuned_for;
    int started, arrived;
} rn_state;
#endif /* RN_PREVIEW */
/* TABLES */
/* At start, and after a gap in time. */
RN_INLINE void rn_init(rn_state* s) { s->started = 0; }

RN_INLINE rn_real rn_between(rn_real value, rn_real low, rn_real high) {
    return value < low ? low : value > high ? high : value;
}

/* Frequency of a line. */
RN_INLINE rn_real rn_hz(int order, rn_real speed) {
    return rn_orders[order] * rn_values.gear_ratio * (speed < 0 ? -speed : speed) / 360;
}

/* Where the notch of a line is put, and how narrow it is there. */
RN_INLINE rn_real rn_center(rn_real hz) {
    return rn_between(hz, rn_values.min_hz, (rn_real)RN_NONE_ABOVE * rn_values.sample_rate_hz);
}
RN_INLINE rn_real rn_q(rn_real center) {
    const rn_real narrow = rn_values.narrow_hz / center;
    return rn_values.q_each * (narrow > 1 ? narrow : 1);
}

/* What is left of a line at its centre. */
RN_INLINE rn_real rn_left(int order, rn_real hz) {
    const rn_constants* const c = &rn_values;
    const rn_real none = (rn_real)RN_NONE_ABOVE, full = (rn_real)RN_FULL_BELOW;
    rn_real gain = c->depth_gain;
    rn_real share = rn_weights[order] * rn_between((none - hz / c->sample_rate_hz) / (none - full), 0, 1);
    if (RN_PARKS) { /* the square root of the gain moves linearly */
        const rn_real on = rn_between((hz / c->min_hz - (rn_real)0.25) / (rn_real)0.75, 0, 1);
        const rn_real root = 1 - on * (1 - rn_sqrt(gain));
        gain = root * root;
    } else if (c->fade_hz > 0) {
        share *= rn_between((hz - c->min_hz) / c->fade_hz, 0, 1);
    } else if (hz < c->min_hz) {
        share = 0;
    }
    return 1 - share * (1 - gain);
}

RN_INLINE void rn_tune(rn_line* line, rn_real center) {
    const rn_real damping = 1 / rn_q(center);
    int j;
    line->center = center;
    for (j = 0; j < RN_NOTCHES; ++j) {
        const rn_real warped = rn_warped(center, rn_spread[j], rn_values.sample_rate_hz);
        const rn_real a1 = 1 / (1 + warped * (warped + damping));
        line->notch[j].a1 = a1;
        line->notch[j].a2 = warped * a1;
        line->notch[j].a3 = warped * warped * a1;
        line->notch[j].damping = damping;
    }
}

RN_INLINE void rn_follow(rn_state* s, int starts) {
    const rn_real slew = rn_values.slew;
    int i;
    s->arrived = 1;
    for (i = 0; i < RN_ORDERS; ++i) {
        rn_line* const line = &s->line[i];
        const rn_real hz = rn_hz(i, s->speed), wanted = rn_center(hz);
        rn_real center = wanted;
        if (!starts && slew < 1) center = rn_between(wanted, line->center * (1 - slew), line->center / (1 - slew));
        if (center != wanted) s->arrived = 0;
        if (starts || center != line->center) rn_tune(line, center);
        line->taken = 1 - rn_left(i, hz);
    }
    s->tuned_for = s->speed;
}

/* Every sample, RN_SAMPLE_RATE_HZ times a second: the torque without ripple. */
RN_INLINE rn_real rn_step(rn_state* s, rn_real torque_nm, rn_real speed_deg_s) {
    rn_real y;
    int i, j;
    if (!s->started) {
        s->started = 1;
        s->origin = torque_nm;
        s->speed = speed_deg_s;
        rn_follow(s, 1);
        for (i = 0; i < RN_ORDERS; ++i)
            for (j = 0; j < RN_NOTCHES; ++j) s->line[i].notch[j].s1 = s->line[i].notch[j].s2 = 0;
    } else {
        /* The signed speed is smoothed, so that a joint that turns round goes through zero. */
        s->speed = speed_deg_s + rn_values.speed_pole * (s->speed - speed_deg_s);
        if (s->speed != s->tuned_for || !s->arrived) rn_follow(s, 0);
    }
    y = torque_nm - s->origin;
    for (i = 0; i < RN_ORDERS; ++i) {
        for (j = 0; j < RN_NOTCHES; ++j) {
            rn_notch* const n = &s->line[i].notch[j];
            const rn_real v3 = y - n->s2;
            const rn_real v1 = n->a1 * n->s1 + n->a2 * v3;
            const rn_real v2 = n->s2 + n->a2 * n->s1 + n->a3 * v3;
            n->s1 = v1 + v1 - n->s1;
            n->s2 = v2 + v2 - n->s2;
            y -= s->line[i].taken * (n->damping * v1);
        }
    }
    return s->origin + y;
}
