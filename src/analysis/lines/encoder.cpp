// SPDX-License-Identifier: MIT
#include "analysis/lines/encoder.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/functions/many_numbers.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Beyond 17 bits the images of order 1000 are below a hundredth of it.
constexpr double finest_step_turns = 1.0 / (1 << 17);

/// The step of which nearly all differences between neighbours are multiples; 0 without. Taken from the whole
/// range, since the differences themselves are rounded to the decimals of the log.
double step_of(std::span<const double> turns) {
    constexpr double single = 1.5;    // between one step and two
    constexpr double farthest = 8.5;  // steps, whose rounding to the decimals of a log adds up
    constexpr double within = 0.2;    // of a whole step: two of five where there are no steps
    constexpr double most_off = 0.02;
    double least = 0.0;
    for (std::size_t k = 1; k < turns.size(); ++k) {
        const double size = std::abs(turns[k] - turns[k - 1]);
        if (size > 0.0 && (least == 0.0 || size < least)) least = size;
    }
    if (least < 0.5 * finest_step_turns) return 0.0;
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 1; k < turns.size(); ++k) {
        const double size = std::abs(turns[k] - turns[k - 1]);
        if (size == 0.0 || size > single * least) continue;
        sum += size;
        count += 1.0;
    }
    const double near = sum / count;
    double off = 0.0, near_ones = 0.0, uneven = 0.0, before = 0.0, steps = 0.0, top = 0.0, bottom = 0.0;
    for (std::size_t k = 1; k < turns.size(); ++k) {
        const double jump = (turns[k] - turns[k - 1]) / near, whole = std::round(jump);
        steps += whole;
        uneven += whole != before ? 1.0 : 0.0;
        before = whole;
        top += steps * (turns[k] - turns[0]);
        bottom += steps * steps;
        if (jump == 0.0 || std::abs(jump) > farthest) continue;
        near_ones += 1.0;
        off += std::abs(jump - whole) > within ? 1.0 : 0.0;
    }
    // At one exact speed all differences are alike, without steps.
    if (off > most_off * near_ones || uneven < most_off * near_ones || !(bottom > 0.0)) return 0.0;
    const double step = top / bottom;
    return step >= finest_step_turns && std::abs(step / near - 1.0) < within ? step : 0.0;
}

class BetweenSteps {
  public:
    BetweenSteps(std::vector<double>& turns, double step)
        : turns_(turns), step_(step), sum_(turns.size()), weight_(turns.size()) {}

    void smooth(const SampleRun& run) {
        constexpr std::size_t shortest = 8;
        for (std::size_t width = std::bit_floor(run.size()); width >= shortest; width /= 2) {
            for (std::size_t at = 0; at < run.size(); at += width / 2) {
                const std::size_t first = run.first + std::min(at, run.size() - width);
                const auto begin = weight_.begin() + static_cast<std::ptrdiff_t>(first);
                if (std::find(begin, begin + static_cast<std::ptrdiff_t>(width), 0.0) !=
                    begin + static_cast<std::ptrdiff_t>(width))
                    fit(first, width);
            }
        }
        for (std::size_t k = run.first; k < run.end; ++k)
            if (weight_[k] > 0.0) turns_[k] = sum_[k] / weight_[k];
    }

  private:
    /// Adds the quadratic of a window where what it leaves is rounding.
    void fit(std::size_t first, std::size_t width) {
        const double count = static_cast<double>(width), middle = 0.5 * (count - 1.0), start = turns_[first];
        const double square = (count * count - 1.0) / 12.0,
                     fourth = square * (3.0 * count * count - 7.0) / 20.0;
        double level = 0.0, slope = 0.0, bend = 0.0, squares = 0.0;
        for (std::size_t k = 0; k < width; ++k) {
            const double x = static_cast<double>(k) - middle, y = turns_[first + k] - start;
            level += y;
            slope += x * y;
            bend += (x * x - square) * y;
        }
        level /= count;
        slope /= count * square;
        bend /= count * (fourth - square * square);
        const auto value = [&](std::size_t k) {
            const double x = static_cast<double>(k) - middle;
            return start + level + slope * x + bend * (x * x - square);
        };
        for (std::size_t k = 0; k < width; ++k) {
            const double left = turns_[first + k] - value(k);
            squares += left * left;
        }
        // Of what is spread evenly over a step: the variance, and the relative error of that of `count`.
        const double variance = step_ * step_ / 12.0, error = std::sqrt(0.8 / count);
        if (squares > (count - 3.0) * variance * (1.0 + 2.0 * error)) return;
        for (std::size_t k = 0; k < width; ++k) {
            const double along = (static_cast<double>(k) + 0.5) / count, weight = along * (1.0 - along);
            sum_[first + k] += weight * weight * value(k);
            weight_[first + k] += weight * weight;
        }
    }

    std::vector<double>& turns_;
    double step_;
    std::vector<double> sum_, weight_;
};

}  // namespace

OutputAngle between_steps(const TraceView& log, std::vector<double> logged_turns) {
    OutputAngle angle{std::move(logged_turns), true};
    angle.step_turns = step_of(angle.turns);
    if (!(angle.step_turns > 0.0)) return angle;
    BetweenSteps between(angle.turns, angle.step_turns);
    for (const SampleRun& run : whole_runs(log.size(), log.run_starts)) between.smooth(run);
    return angle;
}

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
