// SPDX-License-Identifier: MIT
#include "log/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

double largest(std::span<const double> values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

}  // namespace

std::vector<std::string> plausibility_warnings(const Layout& layout, const TraceView& trace,
                                               const Timebase& timebase) {
    std::vector<std::string> warnings;
    const JointColumns& chosen = layout.chosen;
    const auto assumed = [&](const std::optional<std::size_t>& column) {
        return column && layout.columns[*column].unit_assumed;
    };
    // Joints of robots turn at up to about 3.5 rad/s and 2 pi rad; in degrees such a log would hardly move.
    if (assumed(chosen.velocity) && trace.size() > 1) {
        const double speed = largest(trace.velocity_deg_s);
        const bool small_angle = !trace.has_position() || largest(trace.position_deg) <= 6.6;
        if (speed > 0.0 && speed <= 4.0 && small_angle) {
            warnings.push_back(
                fmt::format("speed stays below {:.3g} deg/s{}: these may be radians; --unit velocity=rad/s{} "
                            "would say so",
                            speed,
                            trace.has_position()
                                ? fmt::format(" and position within {:.3g} deg", largest(trace.position_deg))
                                : "",
                            assumed(chosen.position) ? " --unit position=rad" : ""));
        }
    }
    if (assumed(chosen.time) && timebase.sample_rate.value() > 0.0 && timebase.sample_rate.value() < 5.0) {
        warnings.push_back(
            fmt::format("the time column gives {:.3g} samples a second: it may be in ms; --unit time=ms "
                        "would say so",
                        timebase.sample_rate.value()));
    }
    return warnings;
}

}  // namespace ripplenotch
