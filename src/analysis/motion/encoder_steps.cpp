// SPDX-License-Identifier: MIT
#include "analysis/motion/encoder_steps.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "ripplenotch/analysis/sweeps.hpp"

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

SteppedAngle between_steps(const TraceView& log, std::vector<double> logged_turns) {
    SteppedAngle angle{std::move(logged_turns), 0.0};
    angle.step_turns = step_of(angle.turns);
    if (!(angle.step_turns > 0.0)) return angle;
    BetweenSteps between(angle.turns, angle.step_turns);
    for (std::size_t first = 0, k = 1; k <= log.size(); ++k) {
        if (k < log.size() && !log.starts_run(k)) continue;
        between.smooth({first, k});
        first = k;
    }
    return angle;
}

}  // namespace ripplenotch
