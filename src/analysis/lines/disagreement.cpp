// SPDX-License-Identifier: MIT
#include "analysis/lines/disagreement.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double least_spread = 0.1;       // of amplitudes, of their mean
constexpr double usual_scatter = 0.03;     // of amplitudes, from run to run of a joint that has not changed
constexpr double like_speed_share = 0.05;  // by hand
constexpr double like_order_share = 0.01, like_ratio_share = 0.1;  // by hand
constexpr double least_chance = 0.001;         // recordings that agree differ by as much less often than this
constexpr std::size_t fewest_for_scatter = 3;  // recordings: fewer have no median
constexpr double least_apart_deg = 20.0;       // by hand: of phases
constexpr double usual_turn_deg = 0.05;        // of the joint: by the load's torsion, from run to run
constexpr double coherent = 0.7;               // of the sum of a line's lengths, its sum
constexpr double least_above_noise = 4.0;      // in amplitude

using Value = Disagreement::Value;

/// Chance that chi-square with so many degrees of freedom is larger: Wilson and Hilferty's cube root.
double chance_of(double chi_square, double freedom) {
    const double spread = 2.0 / (9.0 * freedom);
    const double normal = (portable::cbrt(chi_square / freedom) - (1.0 - spread)) / std::sqrt(spread);
    return 0.5 * std::erfc(normal / std::sqrt(2.0));
}

/// The chance that values which are one differ by as much of their errors.
double chance_of_alike(const std::vector<Value>& values) {
    double top = 0.0, bottom = 0.0, misfit = 0.0;
    for (const Value& one : values) {
        top += one.value / (one.error * one.error);
        bottom += 1.0 / (one.error * one.error);
    }
    for (const Value& one : values) {
        const double off = (one.value - top / bottom) / one.error;
        misfit += off * off;
    }
    return chance_of(misfit, static_cast<double>(values.size()) - 1.0);
}

/// Signed speeds.
bool like_speed(double speed, double other) {
    return std::abs(speed - other) <= like_speed_share * std::abs(other);
}

const Line* same_line(const Identification& one, double order_output) {
    const Line* nearest = nullptr;
    for (const Line& line : one.lines) {
        if (!line.order_output || line.kind == LineKind::tone) continue;
        const double off = std::abs(*line.order_output - order_output);
        if (off > like_order_share * order_output) continue;
        if (nearest == nullptr || off < std::abs(*nearest->order_output - order_output)) nearest = &line;
    }
    return nearest;
}

/// Mean amplitude of a line near a speed, signed, with its error: of noise, or of the scatter where there are
/// enough.
std::optional<Value> amplitude_at(std::size_t recording, const Line& line, double speed_deg_s) {
    double sum = 0.0, noise = 0.0, count = 0.0, square = 0.0;
    for (const AmplitudeAtSpeed& at : line.by_speed) {
        if (!like_speed(at.speed_deg_s, speed_deg_s)) continue;
        // The noise beside a line turns its amplitude by half its power.
        const double error = at.amplitude_nm / std::max(at.snr, 1.0) / std::sqrt(2.0);
        sum += at.amplitude_nm;
        square += at.amplitude_nm * at.amplitude_nm;
        noise += error * error;
        count += 1.0;
    }
    if (count == 0.0) return std::nullopt;
    const double mean = sum / count;
    double variance = noise / (count * count);
    if (count >= static_cast<double>(fewest_for_scatter))
        variance = std::max(variance, (square / count - mean * mean) / (count - 1.0));
    return Value{recording, mean, portable::hypot(std::sqrt(std::max(variance, 0.0)), usual_scatter * mean)};
}

/// The speeds at which most recordings show the line, and what each of these shows there.
std::vector<Value> amplitudes_at_like_speed(std::span<const Identification> each, double order_output) {
    std::vector<Value> best;
    for (const Identification& one : each) {
        const Line* line = same_line(one, order_output);
        if (line == nullptr) continue;
        for (const AmplitudeAtSpeed& at : line->by_speed) {
            std::vector<Value> values;
            for (std::size_t i = 0; i < each.size(); ++i) {
                const Line* other = same_line(each[i], order_output);
                if (other == nullptr) continue;
                if (const auto value = amplitude_at(i, *other, at.speed_deg_s)) values.push_back(*value);
            }
            if (values.size() > best.size()) best = std::move(values);
        }
    }
    return best;
}

std::optional<Disagreement> about_amplitude(const Line& line, std::span<const Identification> each) {
    std::vector<Value> values = amplitudes_at_like_speed(each, *line.order_output);
    if (values.size() < 2) return std::nullopt;
    const auto by_value = [](const Value& a, const Value& b) { return a.value < b.value; };
    const auto [least, most] = std::minmax_element(values.begin(), values.end(), by_value);
    const double chance = chance_of_alike(values);
    if (chance > least_chance || most->value < (1.0 + least_spread) * least->value) return std::nullopt;
    return Disagreement{Disagreement::About::amplitude, line.order, line.order_output, std::move(values),
                        chance};
}

/// Of ratios that are near the common one: half of it is another reading of the same lines.
std::optional<Disagreement> about_ratio(const Identification& together,
                                        std::span<const Identification> each) {
    std::vector<Value> values;
    if (!together.gear_ratio.value) return std::nullopt;
    const double common = *together.gear_ratio.value;
    for (std::size_t i = 0; i < each.size(); ++i) {
        const GearRatioFit& fit = each[i].gear_ratio;
        if (fit.value && std::abs(*fit.value - common) < like_ratio_share * common)
            values.push_back({i, *fit.value, std::max(0.25 * (fit.ci95_high - fit.ci95_low), 1e-9)});
    }
    if (values.size() < 2) return std::nullopt;
    const double chance = chance_of_alike(values);
    if (chance > least_chance) return std::nullopt;
    return Disagreement{Disagreement::About::ratio, {}, {}, std::move(values), chance};
}

/// The line in one sweep: amplitude * exp(i phase) over the angle of the joint.
struct Phasor {
    double speed_deg_s = 0.0, middle_turns = 0.0;
    std::complex<double> value;
    double noise_power = 0.0;  ///< of |value|^2, from the cells near the line
};

/// The line in one recording near a speed.
struct Phase {
    std::size_t number = 0;
    double deg = 0.0, error_deg = 0.0, middle_turns = 0.0;
};

/// The sweeps of a recording with a position: phases of others cannot be compared.
struct Recording {
    std::size_t number = 0;  ///< as handed over, from 0
    std::vector<Sweep> sweeps;
};

double turned_to_half(double deg) { return deg - 360.0 * std::round(deg / 360.0); }

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

Phasor phasor_of(const Sweep& sweep, double order_output) {
    const auto at = [&](double order) {
        return 2.0 / sweep.weight_sum * fourier_point(sweep.turns, sweep.value, order).value;
    };
    Phasor seen{sweep.mean_deg_s, 0.5 * (sweep.turns.front() + sweep.turns.back()), at(order_output), 0.0};
    // The window of a line ends two cells from it.
    double count = 0.0;
    for (const double cells : {-5.0, -4.0, -3.0, 3.0, 4.0, 5.0}) {
        const double near = order_output + cells / sweep.length_turns;
        if (near < 1.0 / sweep.length_turns) continue;
        seen.noise_power += std::norm(at(near));
        count += 1.0;
    }
    seen.noise_power /= std::max(count, 1.0);
    return seen;
}

std::optional<Phase> phase_at(std::size_t number, std::span<const Phasor> seen, double speed_deg_s) {
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
std::vector<Phase> phases_of(std::span<const Recording> recordings, double order_output) {
    std::vector<std::vector<Phasor>> seen;
    std::vector<double> speeds;
    for (const Recording& one : recordings) {
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
            const auto phase = phase_at(recordings[i].number, seen[i], speed);
            if (phase) phases.push_back(*phase);
        }
        if (phases.size() > most.size()) most = std::move(phases);
    }
    return most;
}

std::optional<Disagreement> about_phase(const Line& line, std::span<const Recording> recordings) {
    if (recordings.size() < 2 || !line.order_output_stderr) return std::nullopt;
    const std::vector<Phase> phases = phases_of(recordings, *line.order_output);
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
    if (chance > least_chance || farthest_apart(values) < least_apart_deg) return std::nullopt;
    return Disagreement{Disagreement::About::phase, line.order, line.order_output, std::move(values), chance};
}

}  // namespace

std::vector<Disagreement> disagreements(const Identification& together, std::span<const Identification> each,
                                        std::span<const TraceView> logs) {
    std::vector<Disagreement> found;
    if (each.size() < 2) return found;
    if (auto ratio = about_ratio(together, each)) found.push_back(std::move(*ratio));
    std::vector<Recording> recordings;
    for (std::size_t i = 0; i < logs.size(); ++i) {
        if (logs[i].has_position()) recordings.push_back({i, cut_sweeps(logs.subspan(i, 1), {}).pieces});
    }
    for (const Line& line : together.lines) {
        if (!line.order_output || line.kind == LineKind::tone) continue;
        if (auto amplitude = about_amplitude(line, each)) found.push_back(std::move(*amplitude));
        if (auto phase = about_phase(line, recordings)) found.push_back(std::move(*phase));
    }
    return found;
}

}  // namespace ripplenotch
