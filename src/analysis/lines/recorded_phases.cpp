// SPDX-License-Identifier: MIT
#include "analysis/lines/recorded_phases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/lines/disagreement.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

/// The line in one sweep: amplitude * exp(i phase) over the angle of the joint.
struct RecordedPhases::Phasor {
    double speed_deg_s = 0.0, middle_turns = 0.0;
    std::complex<double> value;
    double noise_power = 0.0;  ///< of |value|^2, from what stands beside the line
};

/// The line in one recording near a speed.
struct RecordedPhases::Phase {
    std::size_t number = 0;
    double deg = 0.0, error_deg = 0.0, middle_turns = 0.0;
};

namespace {

constexpr double least_apart_deg = 20.0;   // by hand
constexpr double usual_turn_deg = 0.05;    // of the joint: by the load's torsion, from run to run
constexpr double coherent = 0.7;           // of the sum of a line's lengths, its sum
constexpr double least_above_noise = 4.0;  // in amplitude

double turned_to_half(double deg) { return deg - 360.0 * std::round(deg / 360.0); }

bool may_be_compared(const Line& line) {
    return line.order_output && line.order_output_stderr && line.kind != LineKind::tone &&
           line.kind != LineKind::alias;
}

double degrees_of(std::complex<double> value) { return portable::arg(value) * degrees_per_radian; }

/// Variance of the mean of phases that differ from it by these, where there are enough to tell.
double scatter_of(std::span<const double> off_deg) {
    if (off_deg.size() < fewest_for_scatter) return 0.0;
    double square = 0.0;
    for (const double off : off_deg) square += off * off;
    const auto count = static_cast<double>(off_deg.size());
    return square / (count * (count - 1.0));
}

/// Values about their common phase, so that none stands a turn apart.
void unwrap_about_mean(std::vector<Disagreement::Value>& values) {
    std::complex<double> sum;
    for (const auto& one : values)
        sum += std::complex(portable::cos_degrees(one.value), portable::sin_degrees(one.value)) /
               (one.error * one.error);
    const double mean = degrees_of(sum);
    for (auto& one : values) one.value = mean + turned_to_half(one.value - mean);
}

double farthest_apart(const std::vector<Disagreement::Value>& values) {
    double apart = 0.0;
    for (const auto& a : values) {
        for (const auto& b : values) apart = std::max(apart, std::abs(turned_to_half(a.value - b.value)));
    }
    return apart;
}

}  // namespace

RecordedPhases::RecordedPhases(std::span<const TraceView> logs) {
    for (std::size_t i = 0; i < logs.size(); ++i) {
        if (logs[i].has_position()) recordings_.push_back({i, cut_sweeps(logs.subspan(i, 1), {}).pieces});
    }
}

RecordedPhases::Phasor RecordedPhases::phasor_of(const Sweep& sweep, double order_output) {
    const auto at = [&](double order) {
        return 2.0 / sweep.weight_sum * fourier_point(sweep.turns, sweep.value, order).value;
    };
    Phasor seen{sweep.mean_deg_s, 0.5 * (sweep.turns.front() + sweep.turns.back()), at(order_output), 0.0};
    // The window of a line ends two cells from it.
    double count = 0.0;
    for (const double cells : {-5.0, -4.0, -3.0, 3.0, 4.0, 5.0}) {
        const double beside = order_output + cells / sweep.length_turns;
        if (beside < 1.0 / sweep.length_turns) continue;
        seen.noise_power += std::norm(at(beside));
        count += 1.0;
    }
    seen.noise_power /= std::max(count, 1.0);
    return seen;
}

std::optional<RecordedPhases::Phase> RecordedPhases::phase_at(std::size_t number,
                                                              std::span<const Phasor> seen,
                                                              double speed_deg_s) {
    std::complex<double> sum;
    double lengths = 0.0, noise = 0.0, middle = 0.0, count = 0.0;
    std::vector<double> phases_deg;
    for (const Phasor& one : seen) {
        if (!like_speed(one.speed_deg_s, speed_deg_s)) continue;
        sum += one.value;
        lengths += std::abs(one.value);
        noise += one.noise_power;
        middle += one.middle_turns;
        count += 1.0;
        phases_deg.push_back(degrees_of(one.value));
    }
    const double length = std::abs(sum);
    if (count == 0.0 || length < coherent * lengths || length < least_above_noise * std::sqrt(noise))
        return std::nullopt;
    const double mean_deg = degrees_of(sum);
    for (double& phase : phases_deg) phase = turned_to_half(phase - mean_deg);
    // Half of the noise lies across the line.
    const double by_noise = degrees_per_radian * std::sqrt(0.5 * noise) / length;
    return Phase{number, mean_deg, std::sqrt(by_noise * by_noise + scatter_of(phases_deg)), middle / count};
}

/// At the speed at which most recordings show the line.
std::vector<RecordedPhases::Phase> RecordedPhases::phases_of(double order_output) const {
    std::vector<std::vector<Phasor>> seen;
    std::vector<double> speeds;
    for (const Recording& one : recordings_) {
        auto& phasors = seen.emplace_back();
        for (const Sweep& sweep : one.sweeps) {
            phasors.push_back(phasor_of(sweep, order_output));
            const auto near = [&](double speed) { return like_speed(speed, phasors.back().speed_deg_s); };
            if (std::none_of(speeds.begin(), speeds.end(), near))
                speeds.push_back(phasors.back().speed_deg_s);
        }
    }
    std::vector<Phase> most;
    for (const double speed : speeds) {
        std::vector<Phase> phases;
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const auto phase = phase_at(recordings_[i].number, seen[i], speed);
            if (phase) phases.push_back(*phase);
        }
        if (phases.size() > most.size()) most = std::move(phases);
    }
    return most;
}

std::optional<Disagreement> RecordedPhases::about(const Line& line) const {
    if (recordings_.size() < 2 || !may_be_compared(line)) return std::nullopt;
    const std::vector<Phase> phases = phases_of(*line.order_output);
    if (phases.size() < 2) return std::nullopt;
    double middle = 0.0;
    for (const Phase& one : phases) middle += one.middle_turns / static_cast<double>(phases.size());
    const double by_load = usual_turn_deg * *line.order_output;
    std::vector<Disagreement::Value> values;
    for (const Phase& one : phases) {
        const double by_order = 360.0 * *line.order_output_stderr * (one.middle_turns - middle);
        values.push_back({one.number, one.deg, portable::hypot(one.error_deg, by_order, by_load)});
    }
    unwrap_about_mean(values);
    const double chance = chance_of_alike(values);
    if (chance > least_chance_of_alike || farthest_apart(values) < least_apart_deg) return std::nullopt;
    return Disagreement{Disagreement::About::phase, line.order, line.order_output, std::move(values), chance};
}

}  // namespace ripplenotch
