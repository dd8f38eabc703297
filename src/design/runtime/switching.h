// SPDX-License-Identifier: MIT
/* band: -1 passes the torque, -2 keeps the active band. Where full and none differ, the share of the filtered torque
   falls from all of it at full to 0 at none. */
typedef struct {
    rn_speed to;
    int band;
    rn_speed full, none;
} rn_region;

#ifndef RN_PREVIEW
typedef struct {
    rn_memory memory[RN_CASCADES][RN_SECTIONS];
    int band;                      /* active band, counted from 0; -1 while the torque passes */
    int region;                    /* of speed; -1 before the first sample */
    long since;                    /* samples since the last switch, RN_DWELL at most */
    rn_share leaving[RN_OUTPUTS];  /* shares at the start of a blend, the torque's first */
    long blended;                  /* samples of the blend so far; -1 without one */
} rn_state;
#endif /* RN_PREVIEW */
/* TABLES */
/* Before the first sample, and after a gap in time: the next torque is met as if it had always been there. */
RN_INLINE void rn_init(rn_state* state) {
    int i;
    for (i = 0; i < RN_CASCADES; ++i) rn_settle_cascade(&rn_bands[i][0], &state->memory[i][0], 0);
    state->band = -1;
    state->region = -1;
    state->since = 0;
    for (i = 0; i < RN_OUTPUTS; ++i) state->leaving[i] = 0;
    state->blended = -1;
}

/* Which band is active from this sample on, by the size of the speed. */
RN_INLINE void rn_supervise(rn_state* state, rn_speed speed) {
    const int first = state->region < 0;
    int next = 0, band, changes;
    if (!first) {
        const rn_region* const region = &rn_regions[state->region];
        const rn_speed from = state->region > 0 ? region[-1].to : 0;
        /* Written so that a speed that is not a number is outside. */
        if (speed > from - RN_HYSTERESIS &&
            (state->region == RN_REGIONS - 1 || speed <= region->to + RN_HYSTERESIS)) {
            if (state->since < RN_DWELL) ++state->since;
            return;
        }
    }
    while (next < RN_REGIONS - 1 && speed > rn_regions[next].to) ++next;
    band = rn_regions[next].band == -2 ? state->band : rn_regions[next].band;
    changes = band != state->band;
    if (!first && changes && state->since < RN_DWELL) {
        ++state->since;
        return;
    }
    if (first) state->since = RN_DWELL;
    else if (changes) state->since = 0;
    if (state->since < RN_DWELL) ++state->since;
    state->region = next;
    state->band = band;
}

/* The present mixture becomes the start of a new blend. */
RN_INLINE void rn_blend_from(rn_state* state, int before) {
    const rn_share left = state->blended < 0 ? 0 : rn_left(state->blended, RN_CROSSFADE);
    rn_share rest = RN_ALL;
    int i;
    for (i = 0; i < RN_OUTPUTS; ++i) {
        state->leaving[i] = (rn_share)rn_times(state->leaving[i], left);
        rest -= state->leaving[i];
    }
    state->leaving[before + 1] += rest;
    state->leaving[state->band + 1] = 0;
    state->blended = 0;
}

RN_INLINE rn_signal rn_blend(rn_state* state, const rn_signal* outputs, rn_signal target) {
    rn_signal sum = 0;
    int i;
    ++state->blended;
    for (i = 0; i < RN_OUTPUTS; ++i) sum += rn_times(outputs[i] - target, state->leaving[i]);
    target += rn_times(sum, rn_left(state->blended, RN_CROSSFADE));
    if (state->blended >= RN_CROSSFADE) {
        state->blended = -1;
        for (i = 0; i < RN_OUTPUTS; ++i) state->leaving[i] = 0;
    }
    return target;
}

/* One cascade whose memory stays while its coefficients change, or, with outputs of their own, all of them side by side.
   before: the active band before this sample; starts: it is the first. */
RN_INLINE rn_signal rn_filter(rn_state* state, rn_signal* outputs, rn_signal x, rn_speed speed, int starts, int before) {
    const rn_region* const region = &rn_regions[state->region];
    rn_signal filtered = x;
    int i;
    if (RN_PARALLEL) {
        outputs[0] = x;
        for (i = 0; i < RN_BANDS; ++i) {
            if (starts) rn_settle_cascade(&rn_bands[i][0], &state->memory[i][0], x);
            outputs[i + 1] = rn_cascade(&rn_bands[i][0], &state->memory[i][0], x);
        }
        filtered = outputs[state->band + 1];
        if (RN_CROSSFADE > 0 && !starts && before != state->band) rn_blend_from(state, before);
        if (RN_CROSSFADE > 0 && state->blended >= 0) filtered = rn_blend(state, outputs, filtered);
    } else if (state->band >= 0) {
        if (before < 0) rn_settle_cascade(&rn_bands[state->band][0], &state->memory[0][0], x);
        filtered = rn_cascade(&rn_bands[state->band][0], &state->memory[0][0], x);
    }
    if (region->full == region->none) return filtered;
    return x + rn_times(filtered - x, rn_fade(speed, region->full, region->none));
}
#ifndef RN_PREVIEW

/* One sample, called at RN_SAMPLE_RATE_HZ; the speed may have either sign. */
RN_INLINE rn_real rn_step(rn_state* state, rn_real torque, rn_speed speed_deg_s) {
    const rn_speed speed = speed_deg_s < 0 ? -speed_deg_s : speed_deg_s;
    const int starts = state->region < 0, before = state->band;
    rn_signal outputs[RN_OUTPUTS];
    rn_supervise(state, speed);
    return rn_leave(rn_filter(state, outputs, rn_enter(torque), speed, starts, before));
}
#endif /* RN_PREVIEW */
