// SPDX-License-Identifier: MIT
#include "analysis/lines/reported_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "analysis/shared_limits.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

/// Says which orders above those searched would explain the line about as well, seen folded.
void list_folds(const MotionLine& found, double highest_searched, double rate_hz, Line& line) {
    std::vector<Fold> folds = found.folds;
    std::erase_if(folds, [&](const Fold& fold) { return fold.order_output <= highest_searched; });
    if (folds.empty()) return;
    const double best = std::max(folds.front().gain, found.gain_angle);
    const double decisive = std::max(decisive_nats, floor_doubt * std::max(best, found.gain_time));
    for (const Fold& fold : folds) {
        if (fold.gain > best - decisive) line.could_be.push_back(fold.order_output);
    }
    if (line.could_be.empty()) return;
    std::sort(line.could_be.begin(), line.could_be.end());
    constexpr std::size_t most = 5;  // by hand: a note that a person reads
    const std::span listed(line.could_be.data(), std::min(most, line.could_be.size()));
    line.note += fmt::format("{}or folded at {:.4g} Hz from order {:.4g}", line.note.empty() ? "" : "; ",
                             rate_hz, fmt::join(listed, ", "));
}

}  // namespace

Reported from_motion(const MotionLines& motion, std::size_t source, double rate_hz) {
    const MotionLine& found = motion.lines[source];
    Reported reported;
    Line& line = reported.line;
    line.kind = found.kind;
    line.amplitude_nm = found.amplitude_nm;
    line.snr = found.snr;
    line.by_speed = found.by_speed;
    line.speed_from_deg_s = motion.slowest_deg_s;
    line.speed_to_deg_s = motion.fastest_deg_s;
    if (found.kind != LineKind::order && found.hz > 0.0) {
        line.hz = found.hz;
        reported.hz_error = found.hz_stderr;
    }
    const bool tone = found.kind == LineKind::tone;
    if (!tone) {
        line.order_output = found.order_output;
        line.order_output_stderr =
            portable::hypot(found.order_stderr, found.order_output * motion.order_share_error);
        reported.order = OrderLine{found.order_output,
                                   found.order_stderr,
                                   found.snr,
                                   found.amplitude_nm,
                                   found.kind == LineKind::order,
                                   0.5 * (motion.slowest_deg_s + motion.fastest_deg_s),
                                   motion.order_share_error};
    }
    if (found.phase_deg) {
        line.phase_deg = *found.phase_deg;
        line.phase_known = true;
    }
    if (found.kind == LineKind::unknown)
        line.note = "the speed varies too little to tell an order from a tone";
    if (!tone) list_folds(found, motion.highest_spectrum_order, rate_hz, line);
    return reported;
}

}  // namespace ripplenotch
