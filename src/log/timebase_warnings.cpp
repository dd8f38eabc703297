// SPDX-License-Identifier: MIT
#include "log/timebase_warnings.hpp"

#include <fmt/format.h>

namespace ripplenotch {
namespace {

double percent_of(const ClockTroubles& troubles, std::size_t count) {
    return 100.0 * static_cast<double>(count) / static_cast<double>(troubles.rows);
}

}  // namespace

void ClockTroubles::add_gap(const Gap& gap) {
    if (gaps++ == 0 || gap.to_s - gap.from_s > longest_gap.to_s - longest_gap.from_s) longest_gap = gap;
}

bool worth_telling(const ClockTroubles& troubles, std::size_t held) {
    return held > 0 && percent_of(troubles, held) >= 0.1;
}

std::vector<std::string> timebase_warnings(const ClockTroubles& troubles) {
    std::vector<std::string> warnings;
    if (troubles.gaps > 0) {
        const Gap& longest = troubles.longest_gap;
        warnings.push_back(fmt::format(
            "{} {} in the time, the longest of {:.4g} s after {:.9g} s; each starts a new run", troubles.gaps,
            troubles.gaps == 1 ? "gap" : "gaps", longest.to_s - longest.from_s, longest.from_s));
    }
    if (troubles.repeated_times > 0) {
        warnings.push_back(
            fmt::format("{} rows ({:.2g} %) repeat the time of the row before: the clock is coarser "
                        "than the rows, or rows were doubled",
                        troubles.repeated_times, percent_of(troubles, troubles.repeated_times)));
    }
    if (worth_telling(troubles, troubles.held.count)) {
        warnings.push_back(fmt::format(
            "{} rows ({:.2g} %) hold the sample before while the joint moves, up to {} in a row",
            troubles.held.count, percent_of(troubles, troubles.held.count), troubles.held.longest));
    }
    return warnings;
}

}  // namespace ripplenotch
