// SPDX-License-Identifier: MIT
#include "analysis/motion/line_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/motion/place_error.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double recurrence_chance = 0.01;  // by hand: as the false alarms allowed by default
constexpr double most_of_log = 0.6;         // by hand: no second piece to ask

/// Of each sweep whose noise there is known its sum at a place; on two cores where they are long.
/// `value_of` a sweep stands for its torque under the weights.
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

/// Power over noise of one sweep, or of a part of it, at a place; noise scaled from the whole sweep's floor
/// there.
struct SweepPart {
    double ratio = 0.0, weight = 0.0;
};

SweepPart piece_at(const Sweep& part, const Sweep& whole, Axis axis, double noise, double place) {
    const double scale = part.weight_square_sum / whole.weight_square_sum;
    const double power = std::norm(fourier_point(places(part, axis), part.value, place).value);
    return {power / (noise * scale), part.effective_samples()};
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

double gain_of(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    return gain_in(sweeps, stack, place, own_value);
}

double gain_without(std::span<const Sweep> sweeps, const KnownLine& line, const Stack& stack, double place) {
    return gain_in(sweeps, stack, place, [&](const Sweep& sweep) { return value_without(sweep, line); });
}

bool recurs(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    std::vector<SweepPart> pieces;
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
    for (const SweepPart& piece : pieces) {
        sum += piece.weight * piece.ratio;
        weights += piece.weight;
        squares += piece.weight * piece.weight;
    }
    if (!(weights > 0.0)) return false;
    return exceedance(
               {.ratio = sum / weights, .averages = weights * weights / squares, .cells = floor_cells}) <
           recurrence_chance;
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
            0.7;  // of random phases, two sweeps reach this by chance less than half the time
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
