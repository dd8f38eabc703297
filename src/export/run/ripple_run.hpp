// SPDX-License-Identifier: MIT
#pragma once
// The C of a map and of the oscillator (design/runtime/map.h, oscillator.h) over the tables of one header.

#include <cmath>
#include <vector>

#include "design/tracking_run.hpp"
#include "export/code/map_code.hpp"
#include "export/run/maths.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

/// The oscillator's numbers, as its header has them.
struct OscillatorTables {
    std::vector<double> orders, priors, values;
    bool minus_ripple = false, waits = false;
};

template <class Math>
class RippleRun : Math {
    using Math::rn_abs, Math::rn_beside_whole, Math::rn_fma, Math::rn_on_circle;
    using typename Math::rn_real;

  public:
    RippleRun(const std::vector<double>& orders, const RippleMap* map, const MapTables& tables)
        : RN_ORDERS(static_cast<int>(orders.size())),
          rn_half(halves_of(orders)),
          rn_orders(orders.begin(), orders.end()),
          h_(2 * orders.size()) {
        if (map == nullptr) return;
        const MapForm& form = map->form;
        RN_PARTS = 2 * RN_ORDERS * (form.second_comb != 0 ? 2 : 1);
        RN_SPEEDS = static_cast<int>(form.speeds_deg_s.size());
        RN_DIRECTIONS = static_cast<int>(form.directions);
        RN_SECOND_COMB = form.second_comb;
        RN_COLUMNS = static_cast<int>(MapTables::columns_a_direction(form));
        rn_speeds.assign(tables.speeds.begin(), tables.speeds.end());
        rn_slopes.assign(tables.slopes.begin(), tables.slopes.end());
        rn_offsets.assign(tables.offsets.begin(), tables.offsets.end());
        rn_limits.assign(tables.limits.begin(), tables.limits.end());
        rn_amplitudes.assign(tables.amplitudes.begin(), tables.amplitudes.end());
        z_.resize(static_cast<std::size_t>(RN_PARTS));
    }
    RippleRun(const OscillatorTables& oscillator, const RippleMap* map, const MapTables& tables)
        : RippleRun(oscillator.orders, map, tables) {
        const std::size_t states = h_.size() + 2;
        RN_STATES = static_cast<int>(states);
        RN_MINUS_RIPPLE = oscillator.minus_ripple;
        RN_WAITS = oscillator.waits;
        rn_priors.assign(oscillator.priors.begin(), oscillator.priors.end());
        rn_values = constants_of<rn_constants, rn_real>(oscillator.values);
        state_.x.resize(states);
        state_.p.resize(states, state_.x);
        now_.v.resize(states);
        state_.h = now_.h = now_.change = h_;
    }

    /// The map's ripple at a state, as design/runtime/map_torque.h has it.
    double torque(const CodeInput& in) {
        rn_angles(static_cast<rn_real>(in.motor_turns), h_.data());
        return static_cast<double>(rn_shown(amplitudes(in), h_.data()));
    }
    /// The oscillator's next sample, as design/runtime/oscillator_step.h and oscillator_map_step.h have it.
    double step(const CodeInput& in) {
        return static_cast<double>(rn_run(&state_, &now_, static_cast<rn_real>(in.torque_nm),
                                          static_cast<rn_real>(in.motor_turns),
                                          z_.empty() ? nullptr : amplitudes(in)));
    }

  private:
    struct rn_state {
        std::vector<rn_real> x, h;
        std::vector<std::vector<rn_real>> p;
        rn_real origin = 0, turns = 0, slip = 0, slipped = 0, lost = 0, left = 0, waited = 0;
        int started = 0;
    };
    struct rn_sample {
        std::vector<rn_real> h, change, v;
        rn_real squares = 0, variance = 0, surprise = 0;
    };
    static constexpr double RN_NONE_ABOVE = none_above_rate, RN_FULL_BELOW = full_below_rate,
                            RN_WAIT_FROM = OscillatorWait::from, RN_WAIT_UNTIL = OscillatorWait::until;
#define RN_INLINE
#define RN_PREVIEW
#include "design/runtime/angles.h"
#include "design/runtime/map.h"
#include "design/runtime/oscillator.h"
#undef RN_PREVIEW
#undef RN_INLINE

    const rn_real* amplitudes(const CodeInput& in) {
        rn_at(static_cast<rn_real>(in.speed_deg_s), static_cast<rn_real>(in.joint_deg), z_.data());
        return z_.data();
    }

    int RN_ORDERS, RN_PARTS = 0, RN_SPEEDS = 0, RN_DIRECTIONS = 0, RN_SECOND_COMB = 0, RN_COLUMNS = 0;
    int RN_STATES = 0, RN_MINUS_RIPPLE = 0, RN_WAITS = 0;
    std::vector<int> rn_half;
    std::vector<rn_real> rn_orders, rn_speeds, rn_slopes, rn_offsets, rn_limits, rn_amplitudes, rn_priors;
    rn_constants rn_values{};
    rn_state state_;
    rn_sample now_;
    std::vector<rn_real> h_, z_;
};

}  // namespace ripplenotch
