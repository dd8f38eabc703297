// SPDX-License-Identifier: MIT
/* A Kalman filter of torque and ripple. Its first state is the measured value, torque and ripple together: a sample then
   measures one state alone, and a cold start has no prior on how the two share it. The decay of the amplitudes is applied
   to how they show, one number for all of them, and to the amplitudes themselves where that has sunk to a half. */

typedef struct {
    rn_real noise_nm;            /* the unit of the state */
    rn_real seen_noise;          /* variance of the sensor and of what a sample adds to the torque */
    rn_real cross_noise, rate_noise, first_rate_variance;
    rn_real amplitude_noise;     /* deviation that a turn adds */
    rn_real quarter_memory;      /* 0.25 / memory in turns */
    rn_real jump, largest_slip;  /* 0: never */
    rn_real turns_to_return;     /* 1 / return; 0: never */
    rn_real in_noise;            /* 1 / noise */
    rn_real lowest;              /* order */
    rn_real slowest_corrected;   /* turns a sample above which the angle's rate is corrected */
} rn_constants;

#ifndef RN_PREVIEW
typedef struct {
    rn_real x[RN_STATES];            /* torque and ripple together, the torque's rate, of each order a cosine and a sine, in
                                        units of the noise; the rate is per sample */
    rn_real p[RN_STATES][RN_STATES]; /* their covariance, from the diagonal on */
    rn_real h[RN_STATES - 2];        /* how each order shows */
    rn_real origin, turns, slip, slipped, lost, left;
    rn_real waited; /* periods of the lowest order before what is learnt counts */
    int started;
} rn_state;

/* What one sample computes. */
typedef struct {
    rn_real h[RN_STATES - 2], change[RN_STATES - 2]; /* how each order shows, and what that is more than before */
    rn_real v[RN_STATES];                            /* the covariance's first row before the sample is seen */
    rn_real squares, variance, surprise;
} rn_sample;
#endif /* RN_PREVIEW */
/* TABLES */
/* At start, and after a gap in time. */
RN_INLINE void rn_init(rn_state* s) { s->started = 0; }

/* The first sample: its torque is anything at all. */
RN_INLINE void rn_begin(rn_state* s, rn_real torque_nm) {
    int i, j;
    s->started = 1;
    s->origin = torque_nm;
    s->left = 1;
    s->waited = 0;
    for (i = 0; i < RN_STATES; ++i)
        for (j = i; j < RN_STATES; ++j) s->p[i][j] = 0;
    s->x[0] = s->x[1] = 0;
    s->p[0][0] = 1;
    s->p[1][1] = rn_values.first_rate_variance;
    for (i = 2; i < RN_STATES; ++i) {
        const rn_real* const prior = &rn_priors[3 * (i / 2 - 1)];
        s->x[i] = prior[i % 2];
        s->p[i][i] = prior[2] * prior[2];
    }
}

/* How each order shows; one that nears half the sample rate is let go. size: turns a sample. */
RN_INLINE void rn_look(rn_sample* now, rn_real turns, rn_real size) {
    const rn_real none = (rn_real)RN_NONE_ABOVE, full = (rn_real)RN_FULL_BELOW;
    int i;
    rn_angles(turns, &now->h[0]);
    now->squares = (rn_real)RN_ORDERS;
    for (i = 0; i < RN_ORDERS; ++i) {
        const rn_real rate = rn_orders[i] * size;
        if (rate > full) {
            const rn_real share = rate < none ? (none - rate) / (none - full) : 0;
            now->h[2 * i] *= share;
            now->h[2 * i + 1] *= share;
            now->squares -= 1 - share * share;
        }
    }
}

/* What was forgotten of the amplitudes, taken off themselves. */
RN_INLINE void rn_bring_back(rn_state* s) {
    const rn_real left = s->left;
    int i, j;
    for (i = 2; i < RN_STATES; ++i) {
        s->x[i] *= left;
        s->h[i - 2] /= left;
        s->p[0][i] *= left;
        s->p[1][i] *= left;
        for (j = i; j < RN_STATES; ++j) s->p[i][j] *= left * left;
    }
    s->left = 1;
}

RN_INLINE void rn_forget(rn_state* s, rn_sample* now, rn_real size) {
    int i;
    s->left *= rn_fma(-size, rn_values.turns_to_return, 1);
    if (s->left < (rn_real)0.5) rn_bring_back(s);
    for (i = 0; i < RN_STATES - 2; ++i) now->h[i] *= s->left;
}

/* The first state gains the rate, and how much each amplitude shows now less how much it showed before. */
RN_INLINE void rn_predict(rn_state* s, rn_sample* now, rn_real size) {
    const rn_real strays = size * rn_values.amplitude_noise, added = strays * strays;
    const rn_real strays_here = strays / s->left, more = strays_here * strays_here;
    rn_real first, expected = s->x[0] + s->x[1];
    int i, k;
    for (k = 2; k < RN_STATES; ++k) now->change[k - 2] = now->h[k - 2] - s->h[k - 2];
    for (i = 0; i < RN_STATES; ++i) {
        rn_real v = s->p[0][i] + (i == 0 ? s->p[0][1] : s->p[1][i]);
        for (k = 2; k < i; ++k) v = rn_fma(now->change[k - 2], s->p[k][i], v);
        for (; k < RN_STATES; ++k) v = rn_fma(now->change[k - 2], s->p[i][k], v);
        now->v[i] = v;
    }
    first = now->v[0] + now->v[1];
    for (k = 2; k < RN_STATES; ++k) {
        first = rn_fma(now->change[k - 2], now->v[k], first);
        expected = rn_fma(now->change[k - 2], s->x[k], expected);
    }
    now->variance = rn_fma(added, now->squares, first) + rn_values.seen_noise;
    now->v[1] += rn_values.cross_noise;
    s->x[0] = expected;
    s->p[1][1] += rn_values.rate_noise;
    for (i = 2; i < RN_STATES; ++i) {
        now->v[i] = rn_fma(more, now->h[i - 2], now->v[i]);
        s->p[i][i] += more;
    }
}

/* A sample that is nearly impossible under the model is a torque that jumped. */
RN_INLINE void rn_update(rn_state* s, rn_sample* now, rn_real torque_nm) {
    const rn_real surprise = rn_fma(torque_nm - s->origin, rn_values.in_noise, -s->x[0]), jump = rn_values.jump;
    rn_real scale;
    int i, j;
    if (jump > 0 && surprise * surprise > jump * jump * now->variance) now->variance += surprise * surprise;
    scale = 1 / now->variance;
    now->surprise = surprise * scale;
    for (i = 0; i < RN_STATES; ++i) {
        const rn_real gain = i == 0 ? 1 - scale : now->v[i] * scale;
        s->x[i] = rn_fma(gain, surprise, s->x[i]);
        s->p[0][i] = gain; /* the updated covariance of the first state is the gain itself */
        if (i > 0)
            for (j = i; j < RN_STATES; ++j) s->p[i][j] = rn_fma(-gain, now->v[j], s->p[i][j]);
    }
}

/* Corrects the angle's rate from the ripple's phase. */
RN_INLINE void rn_correct(rn_state* s, const rn_sample* now, rn_real step) {
    const rn_real size = rn_abs(step), most = rn_values.largest_slip;
    rn_real ahead = 0, weights = 0;
    int i;
    for (i = 2; i < RN_STATES; i += 2) {
        const rn_real a = s->x[i], b = s->x[i + 1], n = rn_orders[i / 2 - 1];
        const rn_real square = rn_fma(b, b, a * a);
        if (square > 9 * (s->p[i][i] + s->p[i + 1][i + 1])) {
            ahead -= n * rn_fma(a, now->v[i + 1], -b * now->v[i]);
            weights = rn_fma(n * n, square, weights);
        }
    }
    if (weights > 0) {
        rn_real share = size * rn_values.quarter_memory;
        share = share < (rn_real)0.01 ? share : (rn_real)0.01;
        s->slip += share * (ahead * now->surprise) / ((rn_real)6.283185307179586 * weights * step);
        s->slip = s->slip < -most ? -most : s->slip > most ? most : s->slip;
    }
}

/* What is learnt counts once the motor has turned far enough to tell it from the torque. */
RN_INLINE rn_real rn_faded_in(const rn_state* s, rn_real torque_nm, rn_real clean_nm) {
    const rn_real from = (rn_real)RN_WAIT_FROM, until = (rn_real)RN_WAIT_UNTIL, share = (s->waited - from) / (until - from);
    if (!RN_WAITS || !(s->waited < until)) return clean_nm;
    return share > 0 ? rn_fma(share, clean_nm - torque_nm, torque_nm) : torque_nm;
}

/* z: the amplitudes of a map that is subtracted first; 0 where there is none. */
RN_INLINE rn_real rn_run(rn_state* s, rn_sample* now, rn_real torque_nm, rn_real motor_turns, const rn_real* z) {
    const rn_constants* const c = &rn_values;
    rn_real moved, step, size, added, slipped, ripple;
    int i;
    if (!s->started) {
        s->turns = motor_turns;
        s->slip = s->slipped = s->lost = 0;
    }
    moved = rn_beside_whole(motor_turns - s->turns);
    step = rn_fma(moved, s->slip, moved);
    size = rn_abs(step);
    /* Compensated summation (Kahan): a phase that drifts is not lost at standstill. */
    added = rn_fma(moved, s->slip, -s->lost);
    slipped = s->slipped + added;
    s->lost = (slipped - s->slipped) - added;
    s->slipped = slipped - (rn_real)(int)slipped;
    rn_look(now, motor_turns + s->slipped, size);
    if (z) torque_nm -= rn_shown(z, &now->h[0]);
    if (s->started) {
        s->waited = rn_fma(size, c->lowest, s->waited);
        if (c->turns_to_return > 0) rn_forget(s, now, size);
        rn_predict(s, now, size);
        rn_update(s, now, torque_nm);
        if (c->largest_slip > 0 && size > c->slowest_corrected) rn_correct(s, now, step);
    } else {
        rn_begin(s, torque_nm);
    }
    for (i = 0; i < RN_STATES - 2; ++i) s->h[i] = now->h[i];
    s->turns = motor_turns;
    ripple = rn_shown(&s->x[2], &now->h[0]);
    return rn_faded_in(s, torque_nm, RN_MINUS_RIPPLE ? rn_fma(-c->noise_nm, ripple, torque_nm)
                                                     : rn_fma(c->noise_nm, s->x[0] - ripple, s->origin));
}
