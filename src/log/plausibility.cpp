// SPDX-License-Identifier: MIT
#include "log/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

double largest(std::span<const double> values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

}  // namespace

LogExtremes extremes_of(const TraceView& trace) {
    return {trace.size(), largest(trace.velocity_deg_s),
            trace.has_position() ? std::optional<double>(largest(trace.position_deg)) : std::nullopt,
            trace.sample_rate};
}

void require_rate(const Layout& layout, const LogExtremes& extremes, const ReadOptions& options) {
    const bool timed = layout.chosen.time || layout.stated_rate;
    if (!options.needs_torque || !timed || extremes.sample_rate.value() > 0.0) return;
    raise<DataError>("{}: read {} over no time at all, expected a time that advances; say --sample-rate",
                     layout.source, extremes.rows == 1 ? "one row" : fmt::format("{} rows", extremes.rows));
}

std::vector<std::string> doubts(const Layout& layout, std::optional<double> wrap_deg,
                                const LogExtremes& extremes) {
    std::vector<std::string> warnings;
    if (wrap_deg) {
        warnings.push_back(
            fmt::format("the position starts again at {:.4g} deg; it was made continuous", *wrap_deg));
    }
    const JointColumns& chosen = layout.chosen;
    const auto assumed = [&](const std::optional<std::size_t>& column) {
        return column && layout.columns[*column].unit_assumed;
    };
    // Joints of robots turn at up to about 3.5 rad/s and 2 pi rad; in degrees such a log would hardly move.
    if (assumed(chosen.velocity) && extremes.rows > 1) {
        const double speed = extremes.speed_deg_s;
        const bool small_angle = !extremes.position_deg || *extremes.position_deg <= 6.6;
        if (speed > 0.0 && speed <= 4.0 && small_angle) {
            warnings.push_back(fmt::format(
                "speed stays below {:.3g} deg/s{}: these may be radians; --unit velocity=rad/s{} "
                "would say so",
                speed,
                extremes.position_deg ? fmt::format(" and position within {:.3g} deg", *extremes.position_deg)
                                      : "",
                assumed(chosen.position) ? " --unit position=rad" : ""));
        }
    }
    if (assumed(chosen.time) && extremes.sample_rate.value() > 0.0 && extremes.sample_rate.value() < 5.0) {
        warnings.push_back(
            fmt::format("the time column gives {:.3g} samples a second: it may be in ms; --unit time=ms "
                        "would say so",
                        extremes.sample_rate.value()));
    }
    return warnings;
}

}  // namespace ripplenotch
