// SPDX-License-Identifier: MIT
typedef struct {
    rn_memory memory[RN_SECTIONS];
    int started;
} rn_state;

/* Before the first sample, and after a gap in time: the next torque is met as if it had always been there. */
RN_INLINE void rn_init(rn_state* state) { state->started = 0; }

/* One sample, called at RN_SAMPLE_RATE_HZ. */
RN_INLINE rn_real rn_step(rn_state* state, rn_real torque) {
    const rn_signal x = rn_enter(torque);
    if (!state->started) rn_settle_cascade(rn_bands[0], state->memory, x);
    state->started = 1;
    return rn_leave(rn_cascade(rn_bands[0], state->memory, x));
}
