// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>

#include "ripplenotch/log/clock.hpp"

#include "ripplenotch/core/percent.hpp"

namespace ripplenotch {
namespace {

std::string gaps_in_words(const ClockFacts& clock) {
    const Gap& longest = clock.longest_gap;
    return fmt::format("{} {} in the time, the longest of {:.4g} s after {:.9g} s; each starts a new run",
                       clock.gap_count, clock.gap_count == 1 ? "gap" : "gaps", longest.to_s - longest.from_s,
                       longest.from_s);
}

std::string changes_in_words(const ClockFacts& clock) {
    const RateChange& first = clock.rate_changes.front();
    const std::string change = fmt::format("from {:.6g} Hz to {:.6g} Hz after data row {} ({:.6g} s)",
                                           first.from.value(), first.to.value(), first.row + 1, first.time_s);
    const std::string changes =
        clock.rate_changes.size() == 1
            ? fmt::format("the clock changes {}", change)
            : fmt::format("the clock changes {} times, first {}", clock.rate_changes.size(), change);
    if (clock.rows_left_out == 0) return changes;
    return fmt::format(
        "{}; {} rows at another rate than {:.6g} Hz are left out and pass unfiltered: give each part a log "
        "of "
        "its own",
        changes, clock.rows_left_out, clock.nominal_rate.value());
}

}  // namespace

std::vector<LogWarning> clock_warnings(const ClockFacts& clock) {
    std::vector<LogWarning> warnings;
    if (clock.gap_count > 0) warnings.push_back({"gaps", gaps_in_words(clock)});
    if (!clock.rate_changes.empty()) warnings.push_back({"changes of rate", changes_in_words(clock)});
    if (clock.repeated_times > 0) {
        warnings.push_back(
            {"repeated times",
             fmt::format("{} rows ({} %) repeat the time of the row before: the clock is coarser than the "
                         "rows, or rows "
                         "were doubled",
                         clock.repeated_times,
                         percent_text(100.0 * static_cast<double>(clock.repeated_times) /
                                      static_cast<double>(clock.rows)))});
    }
    const double mean = clock.mean_rate.value(), nominal = clock.nominal_rate.value();
    if (nominal > 0.0 && std::abs(mean / nominal - 1.0) > rate_worth_a_word) {
        warnings.push_back(
            {"mean rate",
             fmt::format("the rows come at {:.6g} Hz in the mean, but at {:.6g} Hz by the usual step: rows "
                         "are lost or late; "
                         "filters are designed for {:.6g} Hz",
                         mean, nominal, nominal)});
    }
    return warnings;
}

}  // namespace ripplenotch
