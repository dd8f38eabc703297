// SPDX-License-Identifier: MIT
#include "cli/readings/log_doubts.hpp"

#include <fmt/format.h>

#include <cmath>

namespace ripplenotch {
namespace {

// Position over velocity and time is known within 5 % where it is stated at all. A scale that is off by less
// moves a gear ratio by as little; the fit of the ratio speaks of it.
constexpr double agreement = 0.05;
constexpr double widest_clock = 5.0;  // no clock is off by more; a unit or a side is

}  // namespace

std::vector<Doubt> log_doubts(const Log& log, const OtherReading& reading) {
    const auto& factor = log.recording.angle.factor;
    if (!factor) return {};
    // A turned sign leaves every order where it is.
    const double size =
        std::abs(*factor) * reading.position_factor / (reading.velocity_factor * reading.time_factor);
    if (std::abs(size - 1.0) <= agreement) return {};
    const bool clock = size < widest_clock && size > 1.0 / widest_clock;
    return {{DoubtReason::clock,
             fmt::format(
                 "in {} the position changes {:.4g} times as much as velocity and time say, so {}",
                 log.layout.source, size,
                 clock ? fmt::format("the clock or a unit is wrong: --sample-rate {:.4g}Hz would mend "
                                     "the clock, --unit the velocity or the position",
                                     log.recording.clock.nominal_rate.value() / reading.time_factor / size)
                       : "a unit is wrong, or one of the two is the motor's: --unit would mend it")}};
}

}  // namespace ripplenotch
