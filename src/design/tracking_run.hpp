// SPDX-License-Identifier: MIT
#pragma once
// The notches that follow the speed: the C of exported code (design/runtime/tracking.h), which the method
// runs in double and export in the precision of what it wrote.

#include <array>
#include <bit>
#include <cstddef>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {

/// In the order of the runtime's constants.
inline constexpr std::array tracking_members = {
    &TrackingDesign::gear_ratio, &TrackingDesign::sample_rate_hz, &TrackingDesign::q_each,
    &TrackingDesign::narrow_hz,  &TrackingDesign::depth_gain,     &TrackingDesign::min_hz,
    &TrackingDesign::fade_hz,    &TrackingDesign::speed_pole,     &TrackingDesign::slew};
[[nodiscard]] inline std::vector<double> tracking_values(const TrackingDesign& d) {
    std::vector<double> values;
    for (const auto member : tracking_members) values.push_back(d.*member);
    return values;
}

/// These numbers in a type of C whose members are that many of `Real`.
template <class Constants, class Real>
[[nodiscard]] Constants constants_of(const std::vector<double>& numbers) {
    std::array<Real, sizeof(Constants) / sizeof(Real)> held{};
    for (std::size_t i = 0; i < held.size(); ++i) held[i] = static_cast<Real>(numbers[i]);
    return std::bit_cast<Constants>(held);
}

/// `Math` has rn_real, and rn_sqrt and rn_warped over it.
template <class Math>
class TrackingRun : Math {
  public:
    using typename Math::rn_real;

    explicit TrackingRun(const TrackingDesign& d)
        : RN_ORDERS(static_cast<int>(d.orders.size())),
          RN_NOTCHES(static_cast<int>(d.spread.size())),
          RN_PARKS(d.parks),
          rn_orders(d.orders.begin(), d.orders.end()),
          rn_weights(d.weights.begin(), d.weights.end()),
          rn_spread(d.spread.begin(), d.spread.end()),
          rn_values(constants_of<rn_constants, rn_real>(tracking_values(d))),
          state_{.line = std::vector<rn_line>(d.orders.size(),
                                              {.notch = std::vector<rn_notch>(d.spread.size())})} {}

    /// The torque without ripple.
    rn_real next(rn_real torque_nm, rn_real speed_deg_s) { return rn_step(&state_, torque_nm, speed_deg_s); }
    void restart() { rn_init(&state_); }

    using Math::rn_sqrt, Math::rn_warped;
    struct rn_notch;
    struct rn_line {
        rn_real center = 0, taken = 0;
        std::vector<rn_notch> notch;
    };
    struct rn_state {
        std::vector<rn_line> line;
        rn_real origin = 0, speed = 0, tuned_for = 0;
        int started = 0, arrived = 0;
    };
    static constexpr double RN_NONE_ABOVE = none_above_rate, RN_FULL_BELOW = full_below_rate;
#define RN_INLINE
#define RN_PREVIEW
#include "design/runtime/tracking.h"
#undef RN_PREVIEW
#undef RN_INLINE

  private:
    int RN_ORDERS, RN_NOTCHES, RN_PARKS;
    std::vector<rn_real> rn_orders, rn_weights, rn_spread;
    rn_constants rn_values;
    rn_state state_;
};

}  // namespace ripplenotch
