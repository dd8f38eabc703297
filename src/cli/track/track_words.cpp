// SPDX-License-Identifier: MIT
#include "cli/track/track_words.hpp"

#include <fmt/format.h>

#include "ripplenotch/core/how_many.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

std::vector<std::string> track_warnings(const TrackReport& report) {
    const OrderTracks& tracks = report.tracks;
    std::vector<std::string> warnings;
    if (!report.angle_from_position) {
        warnings.emplace_back(
            "no usable position: the angle is integrated velocity, and phases count from the first sample");
    }
    if (tracks.windows_too_few_samples > 0) {
        warnings.push_back(fmt::format("{} left out: too few samples for so many lines; use a longer window",
                                       how_many(tracks.windows_too_few_samples, "window")));
    }
    if (tracks.rows_not_separable > 0) {
        warnings.push_back(
            fmt::format("{} rows where lines cannot be told apart from each other or from the trend are {}",
                        tracks.rows_not_separable, report.method == "ls" ? "left out" : "nan or left out"));
    }
    if (tracks.rows_folded > 0) {
        warnings.push_back(
            fmt::format("in {} rows a line lies above half the sample rate: its amplitude is what a "
                        "low-pass before the sampling left of it",
                        tracks.rows_folded));
    }
    return warnings;
}

std::string why_nothing_tracked(const TrackReport& report) {
    if (report.bandwidth) {
        return fmt::format(
            "no line anywhere turns faster than four times the bandwidth of {} Hz, apart from the others",
            shortest(report.bandwidth->value()));
    }
    const std::string window = report.window ? shortest(report.window->value()) + " s"
                                             : shortest(report.window_turns.value_or(0.0)) + " turns";
    return fmt::format("the joint nowhere moves in one direction for a window of {}, or for half of one",
                       window);
}

}  // namespace ripplenotch
