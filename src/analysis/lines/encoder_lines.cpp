// SPDX-License-Identifier: MIT
#include "analysis/lines/encoder_lines.hpp"

#include <algorithm>
#include <array>

#include "core/functions/many_numbers.hpp"
#include "ripplenotch/analysis/stack.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// The twelfth has less than a hundredth of the power of the first.
constexpr std::size_t harmonics = 12;

/// A sweep with its torque and the harmonics of the rounding of its angle, all under its window.
struct SteppedSweep {
    Sweep sweep;
    std::vector<double> torque;
    std::vector<std::vector<double>> rounding;  ///< empty where the log has no steps
};

/// Less the line through it, under the window.
std::vector<double> weighed(const Sweep& sweep, std::span<const double> values) {
    double level = 0.0, slope = 0.0, middle = 0.0, square = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) middle += sweep.weight[k] * sweep.time_s[k];
    middle /= sweep.weight_sum;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double aside = sweep.time_s[k] - middle;
        level += sweep.weight[k] * values[k];
        slope += sweep.weight[k] * aside * values[k];
        square += sweep.weight[k] * aside * aside;
    }
    std::vector<double> weighed(values.size());
    for (std::size_t k = 0; k < values.size(); ++k)
        weighed[k] = sweep.weight[k] *
                     (values[k] - level / sweep.weight_sum - slope / square * (sweep.time_s[k] - middle));
    return weighed;
}

std::vector<SteppedSweep> stepped_sweeps(std::span<const TraceView> logs, const SweepRule& rule) {
    std::vector<double> steps;
    for (const TraceView& log : logs) steps.push_back(output_angle(log).step_turns);
    std::vector<SteppedSweep> stepped;
    if (std::none_of(steps.begin(), steps.end(), [](double step) { return step > 0.0; })) return stepped;
    for (Sweep& sweep : cut_sweeps(logs, rule).pieces) {
        if (sweep.rest()) continue;
        SteppedSweep one;
        one.torque = weighed(sweep, sweep.measured_nm);
        if (const double step = steps[sweep.log]; step > 0.0) {
            for (std::size_t m = 1; m <= harmonics; ++m) {
                std::vector<double> angle(sweep.turns);
                for (double& turns : angle) turns *= full_turn * static_cast<double>(m) / step;
                portable::cos(angle, angle);
                one.rounding.push_back(weighed(sweep, angle));
            }
        }
        one.sweep = std::move(sweep);
        stepped.push_back(std::move(one));
    }
    return stepped;
}

/// The lowest harmonic of the rounding that is seen at a line in the sweeps that hold most of it; 0: none is.
std::size_t harmonic_at(std::span<const SteppedSweep> sweeps, Axis axis, double place) {
    constexpr double clear = 8.0;       // power over noise; once in 3000 places of noise
    constexpr double most_of_it = 0.8;  // chosen, not derived: share of the line's power
    double all = 0.0;
    std::array<double, harmonics> shown{};
    for (const SteppedSweep& one : sweeps) {
        const auto where = places(one.sweep, axis);
        std::vector<double> angle(where.size()), cosine(where.size()), sine(where.size());
        for (std::size_t k = 0; k < where.size(); ++k) angle[k] = full_turn * place * where[k];
        portable::phasors(angle, cosine, sine);
        const auto power = [&](std::span<const double> values) {
            double real = 0.0, imaginary = 0.0;
            for (std::size_t k = 0; k < values.size(); ++k) {
                real += values[k] * cosine[k];
                imaginary += values[k] * sine[k];
            }
            return real * real + imaginary * imaginary;
        };
        const double of_torque =
            power(one.torque) * one.sweep.length_turns / (one.sweep.weight_sum * one.sweep.weight_sum);
        all += of_torque;
        for (std::size_t m = 0; m < one.rounding.size(); ++m)
            if (power(one.rounding[m]) > clear * 0.5 * one.sweep.weight_square_sum) shown.at(m) += of_torque;
    }
    const auto most = std::find_if(shown.begin(), shown.end(),
                                   [&](double of) { return all > 0.0 && of > most_of_it * all; });
    return most == shown.end() ? 0 : static_cast<std::size_t>(most - shown.begin()) + 1;
}

std::size_t harmonic_of(std::span<const SteppedSweep> sweeps, const MotionLine& line) {
    std::size_t harmonic =
        line.kind == LineKind::tone ? 0 : harmonic_at(sweeps, Axis::angle, line.order_output);
    if (harmonic == 0 && line.kind != LineKind::order && line.hz > 0.0)
        harmonic = harmonic_at(sweeps, Axis::time, line.hz);
    return harmonic;
}

}  // namespace

std::size_t take_off_encoder_lines(std::span<const TraceView> logs, const SweepRule& rule,
                                   std::vector<MotionLine>& lines) {
    if (lines.empty()) return 0;
    const std::vector<SteppedSweep> sweeps = stepped_sweeps(logs, rule);
    if (sweeps.empty()) return 0;
    std::vector<std::size_t> harmonic;
    for (const MotionLine& line : lines) harmonic.push_back(harmonic_of(sweeps, line));
    // Rounding falls with its harmonics: a higher one without a lower, larger one is not of the steps.
    std::size_t taken = 0, next = 0;
    const std::vector<MotionLine> all = lines;
    std::erase_if(lines, [&](const MotionLine& line) {
        const std::size_t own = harmonic[next++];
        const bool made =
            own == 1 || (own > 1 && [&] {
                for (std::size_t i = 0; i < all.size(); ++i)
                    if (harmonic[i] > 0 && harmonic[i] < own && all[i].amplitude_nm > line.amplitude_nm)
                        return true;
                return false;
            }());
        taken += made ? 1 : 0;
        return made;
    });
    return taken;
}

}  // namespace ripplenotch
