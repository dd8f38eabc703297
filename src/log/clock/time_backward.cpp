// SPDX-License-Identifier: MIT
#include "log/clock/time_backward.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

struct Round {
    double length = 0.0;  ///< in the unit of the column
    const char* words = "";
};

constexpr std::array rounds{
    Round{65536.0, "a counter of 16 bits"}, Round{4294967296.0, "a counter of 32 bits"},
    Round{86400.0, "a time of day"},        Round{86400e3, "a time of day"},
    Round{86400e6, "a time of day"},        Round{86400e9, "a time of day"}};

// By hand: a step longer than a hundredth of the round would be a gap of ten minutes in a day.
constexpr double longest_step_share = 0.01;

std::string shown_time(double value, std::int64_t origin) {
    if (origin == 0 || std::abs(value) > 9e15 || value != std::floor(value)) return shortest(value);
    std::int64_t whole = 0;
    return __builtin_add_overflow(static_cast<std::int64_t>(value), origin, &whole)
               ? shortest(value)
               : fmt::format("{}", whole);
}

const Round* round_of(const TimeStep& step) {
    for (const Round& round : rounds) {
        const double on = step.read + round.length - step.before;
        if (on >= 0.0 && on <= longest_step_share * round.length) return &round;
    }
    return nullptr;
}

}  // namespace

std::string time_backward(const TimeStep& step) {
    const std::string seen = fmt::format("read the time {} after {}, ", shown_time(step.read, step.origin),
                                         shown_time(step.before, step.origin));
    if (const Round* round = round_of(step)) {
        return seen +
               fmt::format(
                   "expected time to run forward; it falls as {} does that begins anew (at {}): take the "
                   "rows before with --to, or count rows with --sample-rate",
                   round->words, shortest(round->length));
    }
    return seen +
           "expected time to run forward; sort or split the log, or say --sample-rate if the clock is of no "
           "use";
}

}  // namespace ripplenotch
