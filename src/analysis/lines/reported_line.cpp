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

constexpr double highest_by_hint = 4.0;  // of the comb of a hinted ratio, on which images are looked for

/// Phase against the output angle over all stretches that show the line, when they agree on it.
std::optional<double> phase_in_angle(std::span<const TraceView> logs, const SteadyLines& steady,
                                     const SteadyLine& line, double order_output) {
    std::complex<double> together;
    double lengths = 0.0;
    for (const Sighting& seen : line.sightings) {
        const StretchLines& at = steady.stretches[seen.stretch];
        const TraceView part = logs[at.log].part(at.stretch.first, at.stretch.count);
        if (!part.has_position()) return std::nullopt;
        std::vector<double> turns(part.size()), value(part.size());
        double mean = 0.0, weights = 0.0;
        for (const double torque : part.torque_nm) mean += torque / static_cast<double>(part.size());
        for (std::size_t k = 0; k < part.size(); ++k) {
            const double u = (static_cast<double>(k) + 0.5) / static_cast<double>(part.size());
            const double window = 0.5 - 0.5 * portable::cos(2.0 * std::numbers::pi * u);
            turns[k] = part.position_deg[k] / 360.0;
            value[k] = window * (part.torque_nm[k] - mean);
            weights += window;
        }
        const std::complex<double> sum = fourier_point(turns, value, order_output).value / weights;
        together += sum;
        lengths += 0.5 * seen.amplitude_nm;
    }
    constexpr double agreement = 0.7;  // by hand
    if (!(lengths > 0.0) || std::abs(together) < agreement * lengths) return std::nullopt;
    return portable::arg(together) * degrees_per_radian;
}

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

Reported from_steady(std::span<const TraceView> logs, const SteadyLines& steady, const SteadyLine& found,
                     const IdentifyOptions& options) {
    Reported reported;
    Line& line = reported.line;
    line.kind = found.kind;
    double amplitude = 0.0, hz_top = 0.0, hz_bottom = 0.0;
    double order_top = 0.0, order_bottom = 0.0, slowest = 1e300, fastest = 0.0;
    OrderLine order;
    for (const Sighting& seen : found.sightings) {
        line.by_speed.push_back({seen.speed_deg_s, seen.hz, seen.amplitude_nm, seen.snr});
        amplitude += seen.amplitude_nm / static_cast<double>(found.sightings.size());
        line.snr = std::max(line.snr, seen.snr);
        slowest = std::min(slowest, std::abs(seen.speed_deg_s));
        fastest = std::max(fastest, std::abs(seen.speed_deg_s));
        hz_top += seen.hz / (seen.hz_error * seen.hz_error);
        hz_bottom += 1.0 / (seen.hz_error * seen.hz_error);
        if (seen.speed_deg_s == 0.0) continue;
        const double error =
            portable::hypot(seen.order_error(), seen.order_output() * seen.speed_share_error);
        order_top += seen.order_output() / (error * error);
        order_bottom += 1.0 / (error * error);
        order.observations.push_back({seen.order_output(), seen.order_error(), seen.speed_deg_s,
                                      seen.speed_share_error, seen.hz, seen.stretch});
    }
    line.amplitude_nm = amplitude;
    line.speed_from_deg_s = slowest;
    line.speed_to_deg_s = fastest;
    if (found.kind == LineKind::tone || found.kind == LineKind::unknown) {
        line.hz = hz_top / hz_bottom;
        reported.hz_error = 1.0 / std::sqrt(hz_bottom);
    }
    if (found.kind == LineKind::tone) {
        line.note = fastest == 0.0 ? "seen at rest" : "";
        return reported;
    }
    order.order_output = order_top / order_bottom;
    const double shared = steady.offset ? steady.offset->order_share_error * order.order_output : 0.0;
    order.error = portable::hypot(1.0 / std::sqrt(order_bottom), shared);
    order.snr = line.snr;
    order.amplitude_nm = amplitude;
    order.certain = found.kind == LineKind::order || found.kind == LineKind::alias;
    line.order_output = order.order_output;
    line.order_output_stderr = order.error;
    if (order.certain) {
        if (const auto phase = phase_in_angle(logs, steady, found, order.order_output)) {
            line.phase_deg = *phase;
            line.phase_known = true;
        }
    } else {
        line.note = found.by_accident ? "shares an order with a line at another speed, as unrelated lines may"
                                      : "seen at one speed only";
    }
    const Sighting& first = found.sightings.front();
    if (found.kind == LineKind::alias) {
        line.phase_known = false;
        line.note = fmt::format("folded at {:.4g} Hz, at {:.3g} deg/s seen at {:.4g} Hz", first.rate_hz,
                                std::abs(first.speed_deg_s), first.seen_hz);
    }
    reported.order = std::move(order);
    if (found.kind == LineKind::unknown && options.hint) {
        // One speed, so every image explains it alike.
        std::vector<Fold> folds;
        for (const double fold : unfolded_orders(
                 {.seen = first.order_output(), .highest = highest_by_hint * options.hint->value()},
                 Hertz(first.rate_hz), DegPerSec(first.speed_deg_s)))
            folds.push_back({fold, 0.0});
        unfold(reported, {first.order_output(), 4.0 * reported.order->error, 0.0, 0.0, folds}, options,
               first.rate_hz);
        line.could_be.clear();
    }
    return reported;
}

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
    unfold(reported, {order, 0.5 * motion.resolution_orders, found.gain_angle, found.gain_time, found.folds},
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
