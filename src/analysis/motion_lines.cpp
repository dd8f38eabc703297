// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/motion_lines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/analysis/fourier.hpp"

namespace ripplenotch {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;
// An axis must explain a line better than the other by this factor of likelihood (in nats) to own it.
constexpr double decisive_nats = 5.0;
constexpr double recurrence_chance = 0.01;
constexpr double most_of_log = 0.6;
constexpr double kept_share = 0.8;
constexpr double floor_doubt = 0.15;
constexpr double floor_cells = 80.0;     // behind a sweep's own noise floor
constexpr double line_cells = 2.0;       // half width of a line's main lobe, in resolutions
constexpr double hann_variance = 2.343;  // of a Hann-windowed frequency over the Cramer-Rao bound

double noise_at(const Stack& stack, std::size_t sweep, double place) {
    const auto bin = static_cast<std::size_t>(std::lround(std::max(0.0, place / stack.spacing)));
    const auto& floors = stack.floors[sweep];
    return bin < floors.size() ? static_cast<double>(floors[bin]) : 0.0;
}

/// What one line at each bin explains beyond noise: weighted sum over sweeps of power over noise, less one
/// each.
double gain_at(const Stack& stack, std::size_t bin) {
    double most = 0.0, total = 0.0;
    for (std::size_t i = 0; i < stack.floors.size(); ++i) {
        if (bin >= stack.floors[i].size() || stack.floors[i][bin] <= 0.0F) continue;
        most = std::max(most, stack.sweep_weights[i]);
        total += stack.sweep_weights[i];
    }
    return most > 0.0 ? (stack.ratio[bin] - 1.0) * total / most : 0.0;
}

/// Power over noise of one sweep, or of a part of it, at a place; noise scaled from the whole sweep's floor
/// there.
struct Piece {
    double ratio = 0.0, weight = 0.0;
};

Piece piece_at(const Sweep& part, const Sweep& whole, Axis axis, double noise, double place) {
    const double scale = part.weight_square_sum / whole.weight_square_sum;
    const double power = std::norm(fourier_point(places(part, axis), part.value, place).value);
    return {power / (noise * scale), part.effective_samples()};
}

/// True when a line is seen even without the sweep that shows it best: a burst, or another joint's ripple
/// that passes by, fills one sweep. Where one sweep is most of the log, its halves count as two.
bool recurs(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    std::vector<Piece> pieces;
    std::size_t strongest = 0;
    double total = 0.0;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const double noise = noise_at(stack, i, place);
        if (!(noise > 0.0)) continue;
        pieces.push_back(piece_at(sweeps[i], sweeps[i], stack.axis, noise, place));
        index.push_back(i);
        total += pieces.back().weight;
        const auto says = [&](std::size_t k) { return pieces[k].ratio * pieces[k].weight; };
        if (says(pieces.size() - 1) > says(strongest)) strongest = pieces.size() - 1;
    }
    if (pieces.empty()) return false;
    if (pieces[strongest].weight > most_of_log * total) {
        const std::size_t i = index[strongest];
        const std::size_t half = sweeps[i].turns.size() / 2;
        pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(strongest));
        for (const auto& [first, count] :
             {std::pair{std::size_t{0}, half}, std::pair{half, sweeps[i].turns.size() - half}}) {
            pieces.push_back(piece_at(part_of(sweeps[i], first, count), sweeps[i], stack.axis,
                                      noise_at(stack, i, place), place));
        }
        strongest = pieces.size() - 1;
        if (pieces[strongest - 1].ratio > pieces[strongest].ratio) --strongest;
    }
    pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(strongest));
    double sum = 0.0, weights = 0.0, squares = 0.0;
    for (const Piece& piece : pieces) {
        sum += piece.weight * piece.ratio;
        weights += piece.weight;
        squares += piece.weight * piece.weight;
    }
    if (!(weights > 0.0)) return false;
    return exceedance(sum / weights, weights * weights / squares, floor_cells) < recurrence_chance;
}

/// What a line explains beyond noise, in nats: weighted sum over sweeps of power over noise, less one each.
/// Sweeps weigh by what they know, the best of them 1.
double gain_of(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    double most = 0.0, gain = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const double noise = noise_at(stack, i, place);
        if (!(noise > 0.0)) continue;
        const Piece piece = piece_at(sweeps[i], sweeps[i], stack.axis, noise, place);
        most = std::max(most, piece.weight);
        gain += piece.weight * (piece.ratio - 1.0);
    }
    return most > 0.0 ? gain / most : 0.0;
}

struct Candidate {
    SignificantPeak peak;
    double gain = 0.0;
};

bool near_any(std::span<const double> lines, double place, double within) {
    return std::any_of(lines.begin(), lines.end(),
                       [&](double line) { return std::abs(place - line) < within; });
}

/// The significant, recurring peak that explains most, apart from lines already found.
std::optional<Candidate> clearest(std::span<const Sweep> sweeps, const Stack& stack,
                                  std::span<const double> taken, double lowest, double false_alarm) {
    std::vector<Candidate> candidates;
    for (const SignificantPeak& peak : stack.peaks(false_alarm)) {
        const double place = static_cast<double>(peak.bin) * stack.spacing;
        if (place >= lowest && !near_any(taken, place, line_cells * stack.resolution))
            candidates.push_back({peak, gain_at(stack, peak.bin)});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.gain > b.gain; });
    for (const Candidate& candidate : candidates) {
        if (recurs(sweeps, stack, static_cast<double>(candidate.peak.bin) * stack.spacing)) return candidate;
    }
    return std::nullopt;
}

/// The most that any line of the other axis explains where this one could be seen there, from..to on that
/// axis.
Candidate best_between(const Stack& stack, double from, double to) {
    Candidate best;
    const auto last = static_cast<std::size_t>(std::max(0.0, to / stack.spacing)) + 2;
    const auto begin = static_cast<std::size_t>(std::max(0.0, from / stack.spacing - 1.0));
    for (std::size_t k = std::max(begin, stack.first); k < std::min(last, stack.ratio.size()); ++k) {
        const double gain = gain_at(stack, k);
        if (gain > best.gain) best = {{k, stack.floor_nm[k], 1.0}, gain};
    }
    return best;
}

/// Place of the maximum of the summed power near a bin, all sweeps together, by Newton steps.
double refined(std::span<const Sweep> sweeps, const Stack& stack, std::size_t bin) {
    const double start = static_cast<double>(bin) * stack.spacing;
    double place = start;
    for (int round = 0; round < 8; ++round) {
        double slope = 0.0, curve = 0.0;
        for (std::size_t i = 0; i < sweeps.size(); ++i) {
            const double noise = noise_at(stack, i, start);
            if (!(noise > 0.0)) continue;
            const FourierPoint at = fourier_point(places(sweeps[i], stack.axis), sweeps[i].value, place);
            const double weight = stack.sweep_weights[i] / noise;
            slope += weight * std::real(std::conj(at.value) * at.first);
            curve += weight * (std::norm(at.first) + std::real(std::conj(at.value) * at.second));
        }
        if (!(curve < 0.0)) return place;
        const double next = std::clamp(place - slope / curve, start - stack.spacing, start + stack.spacing);
        const bool settled = std::abs(next - place) < 1e-7 * stack.spacing;
        place = next;
        if (settled) break;
    }
    return place;
}

/// Standard error of a place from what the sweeps disagree about: each left out in turn, one Newton step
/// (jackknife).
double disagreement(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    std::vector<std::pair<double, double>> parts;  // slope and curvature of each sweep's power
    double slope = 0.0, curve = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const double noise = noise_at(stack, i, place);
        if (!(noise > 0.0)) continue;
        const FourierPoint at = fourier_point(places(sweeps[i], stack.axis), sweeps[i].value, place);
        const double weight = stack.sweep_weights[i] / noise;
        parts.emplace_back(weight * std::real(std::conj(at.value) * at.first),
                           weight * (std::norm(at.first) + std::real(std::conj(at.value) * at.second)));
        slope += parts.back().first;
        curve += parts.back().second;
    }
    double mean = 0.0, square = 0.0, count = 0.0;
    for (const auto& [own_slope, own_curve] : parts) {
        if (!(curve - own_curve < 0.0)) continue;
        const double shift =
            std::clamp(-(slope - own_slope) / (curve - own_curve), -stack.spacing, stack.spacing);
        mean += shift;
        square += shift * shift;
        count += 1.0;
    }
    // Too few sweeps to disagree: amplitude that changes along a sweep moves a line by about a tenth of its
    // width.
    if (count < 3.0) return 0.1 * stack.resolution;
    return std::sqrt(std::max(0.0, (square - mean * mean / count) * (count - 1.0) / count));
}

/// Fills in what the sweeps say about a line at `place`.
void measure(std::span<const Sweep> sweeps, const Stack& stack, double place, MotionLine& line) {
    double information = 0.0, weights = 0.0, power = 0.0, noise_power = 0.0, lengths = 0.0;
    std::complex<double> together;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const Sweep& sweep = sweeps[i];
        const double noise = noise_at(stack, i, place);
        if (!(noise > 0.0)) continue;
        const std::complex<double> sum = fourier_point(places(sweep, stack.axis), sweep.value, place).value;
        const std::complex<double> amplitude = 2.0 * sum / sweep.weight_sum;
        const double floor = 4.0 * noise / (sweep.weight_sum * sweep.weight_sum);
        const double weight = stack.sweep_weights[i];
        const double length = length_of(sweep, stack.axis);
        weights += weight;
        power += weight * std::norm(amplitude);
        noise_power += weight * floor;
        together += weight * amplitude;
        lengths += weight * std::abs(amplitude);
        // 1/variance = pi^2 L^2 (A^2 / floor^2) / 2.343, from var = 3 S / (pi^2 A^2 L^3) and floor^2 = 3 S /
        // L.
        information += std::numbers::pi * std::numbers::pi * length * length *
                       std::max(0.0, std::norm(amplitude) / floor - 1.0) / hann_variance;
        const double order = stack.axis == Axis::angle ? place : 0.0;
        const double hz = stack.axis == Axis::angle ? order * std::abs(sweep.mean_deg_s) / 360.0 : place;
        line.by_speed.push_back(
            {sweep.mean_deg_s, hz, std::abs(amplitude), std::abs(amplitude) / std::sqrt(floor)});
    }
    const double bound = information > 0.0 ? 1.0 / std::sqrt(information) : stack.resolution;
    const double error = std::max(bound, disagreement(sweeps, stack, place));
    if (stack.axis == Axis::angle) {
        line.order_output = place;
        line.order_stderr = error;
        constexpr double agreement =
            0.7;  // of random phases, two sweeps reach this by chance less than half the time
        if (lengths > 0.0 && std::abs(together) > agreement * lengths) {
            line.phase_deg = std::arg(together) * degrees_per_radian;
        }
    } else {
        line.hz = place;
        line.hz_stderr = error;
    }
    line.floor_nm = std::sqrt(noise_power / weights);
    line.amplitude_nm = std::sqrt(std::max(power - noise_power, 0.0) / weights);
    line.snr = line.amplitude_nm / line.floor_nm;
}

/// Takes a line out of each sweep with the amplitude and phase that it has there.
void subtract(std::vector<Sweep>& sweeps, Axis axis, double place) {
    for (Sweep& sweep : sweeps) {
        const auto at = places(sweep, axis);
        std::vector<double> cosine(at.size()), sine(at.size());
        double cc = 0.0, cs = 0.0, ss = 0.0, xc = 0.0, xs = 0.0;
        for (std::size_t k = 0; k < at.size(); ++k) {
            const double angle = tau * place * at[k];
            cosine[k] = std::cos(angle);
            sine[k] = std::sin(angle);
            cc += sweep.weight[k] * cosine[k] * cosine[k];
            cs += sweep.weight[k] * cosine[k] * sine[k];
            ss += sweep.weight[k] * sine[k] * sine[k];
            xc += sweep.value[k] * cosine[k];
            xs += sweep.value[k] * sine[k];
        }
        const double determinant = cc * ss - cs * cs;
        if (!(determinant > 1e-6 * cc * ss)) continue;
        const double a = (xc * ss - xs * cs) / determinant, b = (xs * cc - xc * cs) / determinant;
        for (std::size_t k = 0; k < at.size(); ++k) {
            const double line = a * cosine[k] + b * sine[k];
            sweep.torque_nm[k] -= line;
            sweep.value[k] -= sweep.weight[k] * line;
        }
    }
}

double torque_range(std::span<const TraceView> logs) {
    double range = 0.0;
    for (const TraceView& log : logs) {
        const auto [low, high] = std::minmax_element(log.torque_nm.begin(), log.torque_nm.end());
        if (low != log.torque_nm.end()) range = std::max(range, *high - *low);
    }
    return range;
}

/// Amplitude at which a line of median floor reaches the false-alarm rate.
double detectable(const Stack& stack, double false_alarm) {
    std::vector<double> floors(
        stack.floor_nm.begin() + static_cast<std::ptrdiff_t>(std::min(stack.first, stack.floor_nm.size())),
        stack.floor_nm.end());
    if (floors.empty()) return 0.0;
    const auto middle = floors.begin() + static_cast<std::ptrdiff_t>(floors.size() / 2);
    std::nth_element(floors.begin(), middle, floors.end());
    const double averages = stack.averages[(stack.first + stack.averages.size()) / 2];
    const double tries = static_cast<double>(floors.size()) * stack.spacing / stack.resolution;
    double ratio = 1.0;
    while (ratio < 1e3 && exceedance(ratio, averages, floor_cells) * tries > false_alarm) ratio *= 1.05;
    return *middle * std::sqrt(ratio - 1.0);
}

struct SpeedRange {
    double slow = 0.0, fast = 0.0;
};

SpeedRange speed_range(std::span<const Sweep> sweeps) {
    SpeedRange range{1e300, 0.0};
    for (const Sweep& sweep : sweeps) {
        range.slow = std::min(range.slow, sweep.slow_deg_s);
        range.fast = std::max(range.fast, sweep.fast_deg_s);
    }
    return range;
}

/// A line of one axis and the most that the other axis offers where the first could be seen there.
struct Rivals {
    double order = 0.0, hz = 0.0;
    bool has_order = false, has_hz = false;
    double gain_angle = 0.0, gain_time = 0.0;
};

/// True when a place is a significant peak itself, not merely the best that noise offers.
bool stands_out(const Stack& stack, double place, double false_alarm) {
    const auto peaks = stack.peaks(false_alarm);
    return std::any_of(peaks.begin(), peaks.end(), [&](const SignificantPeak& peak) {
        return std::abs(static_cast<double>(peak.bin) * stack.spacing - place) < stack.resolution;
    });
}

LineKind judged(const std::vector<Sweep>& sweeps, const Stack& angle, const Stack& time, const Rivals& rivals,
                bool by_angle, double false_alarm) {
    const double apart = rivals.gain_angle - rivals.gain_time;
    // The two noise floors are estimates of their own, a few per cent apart.
    const double decisive =
        std::max(decisive_nats, floor_doubt * std::max(rivals.gain_angle, rivals.gain_time));
    if (std::abs(apart) > decisive) return apart > 0.0 ? LineKind::order : LineKind::tone;
    const bool two_lines =
        rivals.has_order && rivals.has_hz &&
        (by_angle ? stands_out(time, rivals.hz, false_alarm) : stands_out(angle, rivals.order, false_alarm));
    if (!two_lines) return LineKind::unknown;
    // Two lines, not one seen twice, when each keeps what it explains after the other is taken out.
    std::vector<Sweep> without_order = sweeps, without_tone = sweeps;
    subtract(without_order, Axis::angle, rivals.order);
    subtract(without_tone, Axis::time, rivals.hz);
    const double order_left = gain_of(without_tone, angle, rivals.order);
    const double tone_left = gain_of(without_order, time, rivals.hz);
    if (order_left < kept_share * rivals.gain_angle || tone_left < kept_share * rivals.gain_time)
        return LineKind::unknown;
    return by_angle ? LineKind::order : LineKind::tone;
}

}  // namespace

MotionLines find_motion_lines(std::span<const TraceView> logs, const MotionLinesOptions& options) {
    MotionLines found;
    Sweeps cut = cut_sweeps(logs, options.sweeps);
    std::vector<Sweep>& sweeps = cut.pieces;
    found.sweeps = sweeps.size();
    found.sweeps_left_out = cut.pieces_left_out;
    found.absolute_angle = cut.absolute_angle;
    if (sweeps.empty()) return found;
    const SpeedRange range = speed_range(sweeps);
    found.slowest_deg_s = range.slow;
    found.fastest_deg_s = range.fast;
    for (const Sweep& sweep : sweeps) found.turns += sweep.length_turns;

    std::vector<double> taken_orders, taken_hz;
    Stack angle, time;
    bool changed = true;
    const double least_amplitude = options.least_share * torque_range(logs);
    for (std::size_t round = 0; round < 2 * options.most_lines && found.lines.size() < options.most_lines;
         ++round) {
        if (changed) {
            angle = stack_sweeps(sweeps, Axis::angle, options.stack);
            time = stack_sweeps(sweeps, Axis::time, options.stack);
            changed = false;
        }
        if (round == 0) {
            found.resolution_orders = angle.resolution;
            found.lowest_order = static_cast<double>(angle.first) * angle.spacing;
            found.detectable_nm = std::max(least_amplitude, detectable(angle, 0.5 * options.false_alarm));
            found.highest_order = static_cast<double>(angle.ratio.size()) * angle.spacing;
        }
        const auto order = clearest(sweeps, angle, taken_orders, 0.0, 0.5 * options.false_alarm);
        const auto tone = clearest(sweeps, time, taken_hz, options.lowest_tone_hz, 0.5 * options.false_alarm);
        if (!order && !tone) break;
        MotionLine line;
        const bool by_angle = order && (!tone || order->gain >= tone->gain);
        Rivals rivals;
        std::size_t order_bin = by_angle ? order->peak.bin : 0, hz_bin = by_angle ? 0 : tone->peak.bin;
        if (by_angle) {
            const double place = static_cast<double>(order_bin) * angle.spacing;
            hz_bin = best_between(time, place * range.slow / 360.0, place * range.fast / 360.0).peak.bin;
            line.false_alarm = order->peak.false_alarm;
        } else {
            const double place = static_cast<double>(hz_bin) * time.spacing;
            order_bin = best_between(angle, place * 360.0 / range.fast, place * 360.0 / range.slow).peak.bin;
            line.false_alarm = tone->peak.false_alarm;
        }
        rivals.has_order = order_bin > 0;
        rivals.has_hz = hz_bin > 0;
        if (rivals.has_order) rivals.order = refined(sweeps, angle, order_bin);
        if (rivals.has_hz) rivals.hz = refined(sweeps, time, hz_bin);
        rivals.gain_angle = line.gain_angle = rivals.has_order ? gain_of(sweeps, angle, rivals.order) : 0.0;
        rivals.gain_time = line.gain_time = rivals.has_hz ? gain_of(sweeps, time, rivals.hz) : 0.0;
        line.kind = judged(sweeps, angle, time, rivals, by_angle, 0.5 * options.false_alarm);
        const bool as_order =
            line.kind == LineKind::order || (line.kind == LineKind::unknown && rivals.has_order);
        const Stack& stack = as_order ? angle : time;
        auto& taken = as_order ? taken_orders : taken_hz;
        const double place = as_order ? rivals.order : rivals.hz;
        // What a line leaves beside itself, because its amplitude changes within a sweep, is no line.
        const bool rest_of_known = near_any(taken, place, line_cells * stack.resolution);
        measure(sweeps, stack, place, line);
        if (!cut.absolute_angle) line.phase_deg.reset();
        (by_angle ? taken_orders : taken_hz)
            .push_back(by_angle ? static_cast<double>(order_bin) * angle.spacing
                                : static_cast<double>(hz_bin) * time.spacing);
        const bool of_the_motion = !as_order && place < options.lowest_tone_hz;
        if (rest_of_known || of_the_motion || line.amplitude_nm < least_amplitude) continue;
        taken.push_back(place);
        if (line.kind == LineKind::unknown && as_order) {
            line.hz = rivals.hz;
            line.hz_stderr = time.resolution;
        }
        subtract(sweeps, stack.axis, place);
        changed = true;
        found.lines.push_back(std::move(line));
    }
    return found;
}

}  // namespace ripplenotch
