// SPDX-License-Identifier: MIT
#include "analysis/lines/reported_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

std::string listed_orders(std::span<const double> orders) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(orders.size(), 5); ++i)
        text += fmt::format("{}{:.4g}", i == 0 ? "" : ", ", orders[i]);
    return text;
}

/// Says what the seen order could be besides, and unfolds it where that can be told.
void unfold(Reported& reported, const FoldQuestion& question, const IdentifyOptions& options,
            double rate_hz) {
    Line& line = reported.line;
    const FoldAnswer answer = answer_fold(question, options.hint);
    if (line.kind == LineKind::tone && !answer.order_output) return;
    line.could_be = answer.could_be;
    const std::string others = listed_orders(line.could_be);
    if (!answer.order_output) {
        if (others.empty()) return;
        line.note += fmt::format("{}or folded at {:.4g} Hz from order {}", line.note.empty() ? "" : "; ",
                                 rate_hz, others);
        return;
    }
    const double share = *answer.order_output / question.seen;
    line.kind = LineKind::alias;
    line.order_output_seen = question.seen;
    line.order_output = answer.order_output;
    line.phase_known = false;
    line.hz.reset();
    line.note = fmt::format("folded at {:.4g} Hz, seen at output order {:.4g}{}{}", rate_hz, question.seen,
                            answer.by_hint ? "; unfolded by the hint" : "",
                            others.empty() ? "" : "; alike: " + others);
    reported.order->order_output = *answer.order_output;
    reported.order->certain = !answer.by_hint;
    for (OrderObservation& seen : reported.order->observations) {
        seen.order_output = *answer.order_output;
        seen.hz *= share;
    }
}

}  // namespace

Reported from_motion(const MotionLines& motion, std::size_t source, const IdentifyOptions& options,
                     double rate_hz) {
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
    const double order = tone ? found.order_seen : found.order_output;
    const double own = tone ? 0.1 * motion.resolution_orders : found.order_stderr;
    const double share = motion.order_share_error;
    const double error = portable::hypot(own, order * share);
    if (!tone) {
        line.order_output = order;
        line.order_output_stderr = error;
    }
    if (found.phase_deg) {
        line.phase_deg = *found.phase_deg;
        line.phase_known = true;
    }
    if (found.kind == LineKind::unknown)
        line.note = "the speed varies too little to tell an order from a tone";
    const double speed = 0.5 * (line.speed_from_deg_s + line.speed_to_deg_s);
    // Lines whose angle is off alike are no witnesses of each other: they are one source of the ratio.
    const OrderObservation seen{order, own, speed, share, order * speed / 360.0, share > 0.0 ? 0 : source};
    reported.order =
        OrderLine{order, error, found.snr, found.amplitude_nm, found.kind == LineKind::order, {seen}};
    // Orders that were searched have shown there what they explain.
    std::vector<Fold> folds = found.folds;
    std::erase_if(folds,
                  [&](const Fold& fold) { return fold.order_output <= motion.highest_spectrum_order; });
    unfold(reported, {order, 0.5 * motion.resolution_orders, found.gain_angle, found.gain_time, folds},
           options, rate_hz);
    if (line.kind == LineKind::tone) reported.order.reset();
    if (line.kind == LineKind::alias) line.order_output_stderr = error;
    return reported;
}

namespace {

/// Which multiple of the mains frequency a tone is; 0: none.
int mains_multiple(const Line& line, double mains_hz) {
    constexpr double tolerance = 0.004;  // mains keep within 1 %, nearly always within a fifth of that
    if (line.kind != LineKind::tone || !line.hz) return 0;
    const double n = std::round(*line.hz / mains_hz);
    const bool near = n >= 1.0 && n <= 6.0 && std::abs(*line.hz - n * mains_hz) <= tolerance * n * mains_hz;
    return near ? static_cast<int>(n) : 0;
}

}  // namespace

void name_mains(std::span<Reported> reported) {
    const auto support = [&](double mains_hz) {
        double sum = 0.0;
        for (const Reported& one : reported) {
            if (const int n = mains_multiple(one.line, mains_hz)) sum += one.line.snr / n;
        }
        return sum;
    };
    const double mains_hz = support(60.0) > support(50.0) ? 60.0 : 50.0;
    for (Reported& one : reported) {
        const int n = mains_multiple(one.line, mains_hz);
        if (n == 0) continue;
        const std::string name = n == 1 ? fmt::format("mains {:.0f} Hz", mains_hz)
                                        : fmt::format("{} times mains {:.0f} Hz", n, mains_hz);
        one.line.note = one.line.note.empty() ? name : name + ", " + one.line.note;
    }
}

}  // namespace ripplenotch
