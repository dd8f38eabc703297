// SPDX-License-Identifier: MIT
#include "analysis/motion/line_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

/// Mean noise power |S|^2 of a sweep at a place; 0 where the sweep is not used there.
double noise_at(const Stack& stack, std::size_t sweep, double place) {
    const auto bin = static_cast<std::size_t>(std::lround(std::max(0.0, place / stack.spacing)));
    const auto& floors = stack.floors[sweep];
    return bin < floors.size() ? static_cast<double>(floors[bin]) : 0.0;
}

/// True when the evaluation of one position in all sweeps is worth a second thread.
bool are_long(std::span<const Sweep> sweeps) {
    // Chosen, not derived: a third of a millisecond at one position.
    constexpr std::size_t long_samples = 20'000;
    std::size_t samples = 0;
    for (const Sweep& sweep : sweeps) samples += sweep.value.size();
    return samples > long_samples;
}

constexpr double recurrence_chance = 0.01;  // chosen, not derived: as the false alarms allowed by default
constexpr double most_of_log = 0.6;         // chosen, not derived: no second piece to test

/// The sum at a position for each sweep whose noise there is known; on two cores where the sweeps are long.
/// `value_of` a sweep replaces its torque under the weights.
template <class ValueOf>
std::vector<FourierPoint> points_of(std::span<const Sweep> sweeps, const Stack& stack, double place,
                                    double noise_place, const ValueOf& value_of) {
    std::vector<FourierPoint> points(sweeps.size());
    on_two_cores(
        sweeps.size(),
        [&](std::size_t i) {
            if (noise_at(stack, i, noise_place) > 0.0)
                points[i] = fourier_point(places(sweeps[i], stack.axis), value_of(sweeps[i]), place);
        },
        are_long(sweeps));
    return points;
}

constexpr auto own_value = [](const Sweep& sweep) { return std::span(sweep.value); };

/// A sweep, or half of one, in which a line is to be seen again.
struct SweepPart {
    std::size_t sweep = 0, first = 0, count = 0;
    double weight = 0.0;
    /// Share of a steady line's power over noise in the whole sweep that falls into this part.
    double share = 1.0;
};

/// The sweeps whose noise at a place is known; where one is most of the log, its halves instead of it.
std::vector<SweepPart> parts_asked(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    std::vector<SweepPart> all;
    double total = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        if (!(noise_at(stack, i, place) > 0.0)) continue;
        all.push_back({i, 0, sweeps[i].turns.size(), stack.sweep_weights[i], 1.0});
        total += all.back().weight;
    }
    const auto heaviest = std::max_element(
        all.begin(), all.end(), [](const SweepPart& a, const SweepPart& b) { return a.weight < b.weight; });
    if (heaviest == all.end() || heaviest->weight <= most_of_log * total) return all;
    const SweepPart whole = *heaviest;
    all.erase(heaviest);
    const std::size_t half = whole.count / 2;
    all.push_back({whole.sweep, 0, half, 0.5 * whole.weight, 0.5});
    all.push_back({whole.sweep, half, whole.count - half, 0.5 * whole.weight, 0.5});
    return all;
}

/// Without the strongest: averages behind the weighted mean, and the share of a steady line's power there.
struct Others {
    double ratio = 0.0, share = 0.0, averages = 0.0;
};

Others without(const std::vector<SweepPart>& all, std::size_t left_out, const std::vector<double>& ratios) {
    double sum = 0.0, shares = 0.0, weights = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i == left_out) continue;
        sum += ratios.empty() ? 0.0 : all[i].weight * ratios[i];
        shares += all[i].weight * all[i].share;
        weights += all[i].weight;
        squares += all[i].weight * all[i].weight;
    }
    if (!(weights > 0.0)) return {};
    return {sum / weights, shares / weights, weights * weights / squares};
}

/// Independent cells behind the noise floor of the sweep that has most of them.
double floor_cells(const Stack& stack) {
    const double cells =
        static_cast<double>(stack.ratio.size() - stack.first) * stack.spacing / stack.resolution;
    return median_efficiency * std::min(80.0, cells);  // noise_floor() goes 40 cells to each side
}

template <class ValueOf>
double gain_in(std::span<const Sweep> sweeps, const Stack& stack, double place, const ValueOf& value_of) {
    const std::vector<FourierPoint> points = points_of(sweeps, stack, place, place, value_of);
    double most = 0.0, gain = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const double noise = noise_at(stack, i, place);
        if (!(noise > 0.0)) continue;
        const double power = std::norm(points[i].value);
        const double weight = sweeps[i].effective_samples();
        most = std::max(most, weight);
        gain += weight * (power / noise - 1.0);
    }
    return most > 0.0 ? gain / most : 0.0;
}

constexpr double clear_ratio = 6.0;      // power over noise; below, a peak's own position is not near normal
constexpr std::size_t few_sweeps = 4;    // chosen, not derived: fewer are cut in parts, for a scatter
constexpr std::size_t parts_of_few = 3;  // the fewest with a scatter
constexpr std::size_t fewest_samples_for_error = 24;  // chosen, not derived

/// The information of one piece of motion on a line near a position: slope and curvature of half its power
/// over noise, and the variance of the slope under noise.
struct Opinion {
    double slope = 0.0, curve = 0.0, slope_variance = 0.0;
    double ratio = 0.0;  ///< power over noise
    double reach = 0.0;  ///< the width of its line

    [[nodiscard]] bool clear() const { return ratio > clear_ratio && curve < 0.0; }
    [[nodiscard]] double shift() const { return std::clamp(-slope / curve, -reach, reach); }
    [[nodiscard]] double variance() const { return slope_variance / (curve * curve); }
};

Opinion opinion_of(const Sweep& sweep, Axis axis, double noise, double place) {
    const auto at = places(sweep, axis);
    const FourierPoint sum = fourier_point(at, sweep.value, place);
    double weights = 0.0, first = 0.0, second = 0.0;
    for (std::size_t k = 0; k < at.size(); ++k) {
        weights += sweep.weight[k];
        first += sweep.weight[k] * at[k];
    }
    const double middle = first / weights;
    for (std::size_t k = 0; k < at.size(); ++k) {
        const double arm = sweep.weight[k] * (at[k] - middle);
        second += arm * arm;
    }
    Opinion opinion;
    opinion.ratio = std::norm(sum.value) / noise;
    opinion.slope = std::real(std::conj(sum.value) * sum.first) / noise;
    opinion.curve = (std::norm(sum.first) + std::real(std::conj(sum.value) * sum.second)) / noise;
    // Slope = Re(conj(X) X'). Noise of power N in X has N full_turn^2 sum w^2 (u - mean)^2 / sum w^2 in X',
    // half of it in phase with X.
    opinion.slope_variance =
        0.5 * std::max(0.0, opinion.ratio - 1.0) * full_turn * full_turn * second / sweep.weight_square_sum;
    opinion.reach = 1.0 / length_of(sweep, axis);
    return opinion;
}

/// Thirds of a sweep, each with a window of its own.
void add_parts(const Sweep& sweep, Axis axis, double noise, double place, std::vector<Opinion>& opinions) {
    const std::size_t n = sweep.turns.size();
    for (std::size_t part = 0; part < parts_of_few; ++part) {
        const std::size_t first = n * part / parts_of_few, end = n * (part + 1) / parts_of_few;
        if (end - first < fewest_samples_for_error) return;
        const Sweep piece = part_of(sweep, first, end - first);
        if (!(piece.weight_square_sum > 0.0)) continue;
        opinions.push_back(
            opinion_of(piece, axis, noise * piece.weight_square_sum / sweep.weight_square_sum, place));
    }
}

/// By what factor the estimates scatter more than their own variances explain.
double disagreement(std::span<const Opinion> opinions) {
    double top = 0.0, bottom = 0.0, count = 0.0;
    for (const Opinion& one : opinions) {
        if (!one.clear()) continue;
        top += one.shift() / one.variance();
        bottom += 1.0 / one.variance();
        count += 1.0;
    }
    if (count < 2.0) return 1.0;
    double squares = 0.0;
    for (const Opinion& one : opinions) {
        if (!one.clear()) continue;
        const double off = one.shift() - top / bottom;
        squares += off * off / one.variance();
    }
    return excess_scatter(squares, count - 1.0);
}

/// Standard error of the position of the largest summed power, in turns or hertz. First from the noise near
/// the line (one Newton step, delta method, with the sweeps' own weights). Where the estimates of the sweeps,
/// or thirds of them when they are few, scatter more than that noise explains, as with a phase that drifts
/// with speed or load, the error is widened to their scatter.
double place_error(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    std::vector<std::size_t> asked;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        if (noise_at(stack, i, place) > 0.0) asked.push_back(i);
    }
    std::vector<Opinion> whole(asked.size()), parts;
    on_two_cores(
        asked.size(),
        [&](std::size_t i) {
            whole[i] = opinion_of(sweeps[asked[i]], stack.axis, noise_at(stack, asked[i], place), place);
        },
        are_long(sweeps));
    double variance = 0.0, curve = 0.0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
        const double weight = stack.sweep_weights[asked[i]];
        variance += weight * weight * whole[i].slope_variance;
        curve += weight * whole[i].curve;
        if (sweeps.size() < few_sweeps)
            add_parts(sweeps[asked[i]], stack.axis, noise_at(stack, asked[i], place), place, parts);
    }
    if (!(curve < 0.0) || !(variance > 0.0)) return stack.resolution;
    const double error = std::sqrt(variance) / -curve;
    return std::min(error * std::max(disagreement(whole), disagreement(parts)), stack.resolution);
}

}  // namespace

double gain_at(const Stack& stack, std::size_t bin) {
    double most = 0.0, total = 0.0;
    for (std::size_t i = 0; i < stack.floors.size(); ++i) {
        if (bin >= stack.floors[i].size() || stack.floors[i][bin] <= 0.0F) continue;
        most = std::max(most, stack.sweep_weights[i]);
        total += stack.sweep_weights[i];
    }
    return most > 0.0 ? (stack.ratio[bin] - 1.0) * total / most : 0.0;
}

double mean_ratio(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    const std::vector<FourierPoint> points = points_of(sweeps, stack, place, place, own_value);
    double weights = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const double noise = noise_at(stack, i, place);
        if (!(noise > 0.0)) continue;
        weights += stack.sweep_weights[i];
        sum += stack.sweep_weights[i] * std::norm(points[i].value) / noise;
    }
    return weights > 0.0 ? sum / weights : 0.0;
}

double gain_of(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    return gain_in(sweeps, stack, place, own_value);
}

GainDifference gain_difference(std::span<const Sweep> sweeps, const PlacedLine& one,
                               const PlacedLine& other) {
    const auto gains_of = [&](const PlacedLine& line) {
        std::vector<double> gains(sweeps.size(), 0.0);
        if (!line.place) return gains;
        const std::vector<FourierPoint> points =
            points_of(sweeps, line.stack, *line.place, *line.place, own_value);
        for (std::size_t i = 0; i < sweeps.size(); ++i) {
            const double noise = noise_at(line.stack, i, *line.place);
            if (noise > 0.0) gains[i] = line.stack.sweep_weights[i] * std::norm(points[i].value) / noise;
        }
        return gains;
    };
    const std::vector<double> first = gains_of(one), second = gains_of(other);
    double heaviest = 0.0, squares = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        for (const Stack* stack : {&one.stack, &other.stack})
            if (i < stack->sweep_weights.size()) heaviest = std::max(heaviest, stack->sweep_weights[i]);
        constexpr double same = 0.01;  // chosen, not derived: share of the larger
        const double larger = std::max(first[i], second[i]);
        if (std::abs(first[i] - second[i]) <= same * larger) continue;
        squares += larger * larger;
        difference += first[i] - second[i];
    }
    if (!(heaviest > 0.0)) return {};
    const double floor_error = 1.0 / std::sqrt(std::min(floor_cells(one.stack), floor_cells(other.stack)));
    return {difference / heaviest, floor_error * std::sqrt(squares) / heaviest};
}

double gain_without(std::span<const Sweep> sweeps, const KnownLine& line, const Stack& stack, double place) {
    return gain_in(sweeps, stack, place, [&](const Sweep& sweep) { return without_line(sweep, line).value; });
}

bool recurs(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    const std::vector<SweepPart> all = parts_asked(sweeps, stack, place);
    std::vector<double> ratios;
    std::size_t strongest = 0;
    for (const SweepPart& one : all) {
        const Sweep& whole = sweeps[one.sweep];
        const bool part = one.count < whole.turns.size();
        const Sweep piece = part ? part_of(whole, one.first, one.count) : Sweep{};
        const Sweep& seen = part ? piece : whole;
        const double noise =
            noise_at(stack, one.sweep, place) * seen.weight_square_sum / whole.weight_square_sum;
        const double power = std::norm(fourier_point(places(seen, stack.axis), seen.value, place).value);
        ratios.push_back(power / noise);
        if (ratios.back() * one.weight > ratios[strongest] * all[strongest].weight)
            strongest = ratios.size() - 1;
    }
    const Others others = without(all, strongest, ratios);
    return others.averages > 0.0 &&
           exceedance({.ratio = others.ratio, .averages = others.averages, .cells = floor_cells(stack)}) <
               recurrence_chance;
}

double recurring_ratio(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    const std::vector<SweepPart> all = parts_asked(sweeps, stack, place);
    if (all.size() < 2) return std::numeric_limits<double>::infinity();
    const auto heaviest = std::max_element(
        all.begin(), all.end(),
        [](const SweepPart& a, const SweepPart& b) { return a.weight * a.share < b.weight * b.share; });
    const Others others = without(all, static_cast<std::size_t>(heaviest - all.begin()), {});
    const PowerOverFloor noise{.averages = others.averages, .cells = floor_cells(stack)};
    return detectable_ratio(exceeded(recurrence_chance, noise)) / others.share;
}

bool shown_throughout(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    constexpr double least_power = 0.1, least_weight = 0.8;  // chosen, not derived
    double gain = 0.0, weights = 0.0, shown = 0.0;
    std::vector<std::pair<double, double>> each;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const double noise = noise_at(stack, i, place);
        if (!(noise > 0.0)) continue;
        const double power =
            std::norm(fourier_point(places(sweeps[i], stack.axis), sweeps[i].value, place).value);
        each.emplace_back(power / noise - 1.0, stack.sweep_weights[i]);
        gain += each.back().first * each.back().second;
        weights += each.back().second;
    }
    for (const auto& [power, weight] : each) {
        if (power > least_power * gain / weights) shown += weight;
    }
    return shown >= least_weight * weights;
}

bool at_two_speeds(std::span<const Sweep> sweeps, const Stack& time, double hz) {
    double speed = 0.0, weights = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        if (sweeps[i].rest() || !(noise_at(time, i, hz) > 0.0)) continue;
        speed += time.sweep_weights[i] * std::abs(sweeps[i].mean_deg_s);
        weights += time.sweep_weights[i];
    }
    const double middle = weights > 0.0 ? speed / weights : 0.0;
    struct Part {
        double power = 0.0, weight = 0.0, square = 0.0, speed = 0.0, speed_weight = 0.0;
        void add(double ratio, double averages) {
            power += averages * ratio;
            weight += averages;
            square += averages * averages;
        }
        [[nodiscard]] bool shows(double cells) const {
            if (!(weight > 0.0)) return false;
            return exceedance(
                       {.ratio = power / weight, .averages = weight * weight / square, .cells = cells}) <
                   recurrence_chance;
        }
        [[nodiscard]] double mean_speed() const { return speed_weight > 0.0 ? speed / speed_weight : 0.0; }
    };
    Part rest, slow, fast;
    std::vector<double> value;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const Sweep& sweep = sweeps[i];
        const double noise = noise_at(time, i, hz);
        if (!(noise > 0.0)) continue;
        if (sweep.rest()) {
            rest.add(std::norm(fourier_point(places(sweep, Axis::time), sweep.value, hz).value) / noise,
                     time.sweep_weights[i]);
            continue;
        }
        for (Part* part : {&slow, &fast}) {
            value.assign(sweep.value.size(), 0.0);
            double squares = 0.0;
            for (std::size_t k = 0; k < value.size(); ++k) {
                const double here = std::abs(sweep.speed_deg_s[k]);
                if ((here < middle) != (part == &slow)) continue;
                value[k] = sweep.value[k];
                squares += sweep.weight[k] * sweep.weight[k];
                part->speed += sweep.weight[k] * here;
                part->speed_weight += sweep.weight[k];
            }
            const double share = squares / sweep.weight_square_sum;
            constexpr double least_share = 0.05;  // chosen, not derived: less is a corner of the sweep
            if (share < least_share) continue;
            part->add(std::norm(fourier_point(places(sweep, Axis::time), value, hz).value) / (noise * share),
                      share * time.sweep_weights[i]);
        }
    }
    const double cells = floor_cells(time);
    if (rest.shows(cells)) return true;
    const bool apart = slow.speed_weight > 0.0 && fast.speed_weight > 0.0 &&
                       hz * (fast.mean_speed() - slow.mean_speed()) > time.resolution * fast.mean_speed();
    return apart && slow.shows(cells) && fast.shows(cells);
}

double refined(std::span<const Sweep> sweeps, const Stack& stack, std::size_t bin) {
    const double start = static_cast<double>(bin) * stack.spacing;
    double place = start;
    for (int round = 0; round < 8; ++round) {
        const std::vector<FourierPoint> points = points_of(sweeps, stack, place, start, own_value);
        double slope = 0.0, curve = 0.0;
        for (std::size_t i = 0; i < sweeps.size(); ++i) {
            const double noise = noise_at(stack, i, start);
            if (!(noise > 0.0)) continue;
            const FourierPoint& at = points[i];
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

void measure(std::span<const Sweep> sweeps, const Stack& stack, double place, MotionLine& line) {
    double weights = 0.0, power = 0.0, noise_power = 0.0, lengths = 0.0;
    std::complex<double> together;
    const std::vector<FourierPoint> points = points_of(sweeps, stack, place, place, own_value);
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const Sweep& sweep = sweeps[i];
        const double noise = noise_at(stack, i, place);
        if (!(noise > 0.0)) continue;
        const std::complex<double> amplitude = 2.0 * points[i].value / sweep.weight_sum;
        const double floor = 4.0 * noise / (sweep.weight_sum * sweep.weight_sum);
        const double weight = stack.sweep_weights[i];
        weights += weight;
        power += weight * std::norm(amplitude);
        noise_power += weight * floor;
        together += weight * amplitude;
        lengths += weight * std::abs(amplitude);
        const double order = stack.axis == Axis::angle ? place : 0.0;
        const double hz = stack.axis == Axis::angle ? order * std::abs(sweep.mean_deg_s) / 360.0 : place;
        line.by_speed.push_back(
            {sweep.mean_deg_s, hz, std::abs(amplitude), std::abs(amplitude) / std::sqrt(floor)});
    }
    const double error = place_error(sweeps, stack, place);
    if (stack.axis == Axis::angle) {
        line.order_output = place;
        line.order_stderr = error;
        constexpr double agreement =
            0.7;  // for random phases, two sweeps reach this by chance less than half the time
        if (lengths > 0.0 && std::abs(together) > agreement * lengths) {
            line.phase_deg = portable::arg(together) * degrees_per_radian;
        }
    } else {
        line.hz = place;
        line.hz_stderr = error;
    }
    line.floor_nm = std::sqrt(noise_power / weights);
    line.amplitude_nm = std::sqrt(std::max(power - noise_power, 0.0) / weights);
    line.snr = line.amplitude_nm / line.floor_nm;
}

}  // namespace ripplenotch
