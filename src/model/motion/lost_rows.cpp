// SPDX-License-Identifier: MIT
#include "model/motion/local_motion.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// A step longer than this part of the usual one may hold a lost row; one longer than so many is a gap.
constexpr double may_be_lost = 1.5, is_gap = 6.0;
// Fewer lost rows than this part of all are not worth another clock.
constexpr double worth_it = 1e-3;

// Median of steps at intervals along the log, which gaps do not change.
double middle_step_s(std::span<const double> time_s) {
    constexpr std::size_t looks = 200;  // chosen, not derived: bounds the time
    std::vector<double> steps;
    for (std::size_t k = 1; k < time_s.size(); k += std::max<std::size_t>(1, time_s.size() / looks))
        steps.push_back(time_s[k] - time_s[k - 1]);
    return median_in(steps);
}

// Steps that may hold more than one sample. Most logs lost none, and every delay calls this.
std::size_t long_steps(std::span<const double> time_s, double middle_s) {
    std::size_t found = 0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double here = time_s[k] - time_s[k - 1];
        found += static_cast<std::size_t>((here > may_be_lost * middle_s) & (here < is_gap * middle_s));
    }
    return found;
}

// The clock common to the stamps: the mean of the steps that hold one sample; 0 where too few hold more.
double single_step_s(std::span<const double> time_s, double middle_s) {
    if (!(static_cast<double>(long_steps(time_s, middle_s)) > worth_it * static_cast<double>(time_s.size())))
        return 0.0;
    double single = 0.0, sum_s = 0.0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double here = time_s[k] - time_s[k - 1];
        if (here > may_be_lost * middle_s) continue;
        single += 1.0;
        sum_s += here;
    }
    return sum_s / single;
}

// Mean delay of the stamps after the first stamp relative to it, in steps from -0.5 to 0.5: the first may
// itself be early or late by nearly half a step.
double first_lateness(std::span<const double> time_s, double step_s) {
    constexpr std::size_t looks = 50;  // chosen, not derived: bounds the time
    std::complex<double> sum{0.0, 0.0};
    for (std::size_t k = 0; k < std::min(looks, time_s.size()); ++k) {
        if (k > 0 && time_s[k] - time_s[k - 1] >= is_gap * step_s) break;
        sum += portable::polar(1.0, 2.0 * std::numbers::pi * (time_s[k] - time_s[0]) / step_s);
    }
    return portable::arg(sum) / (2.0 * std::numbers::pi);
}

// As std::round, which is a call on most builds; of so few steps there is always a long.
double nearest(double steps) {
    return static_cast<double>(static_cast<long>(steps < 0.0 ? steps - 0.5 : steps + 0.5));
}

std::vector<std::size_t> places_on(std::span<const double> time_s, double step_s) {
    // Delay of each stamp, and its moving average, in steps.
    constexpr double followed = 0.02;
    double late = 0.0, mean_late = first_lateness(time_s, step_s);
    std::vector<std::size_t> places{0};
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double steps = (time_s[k] - time_s[k - 1]) / step_s;
        double whole = 1.0;
        if (steps < is_gap) {
            late += steps;
            whole = nearest(late - mean_late);
            if (whole < 1.0 && k > 1 && places[k - 1] - places[k - 2] > 1) {
                // The stamp before was later than a stamp may be: nothing is missing before it.
                --places[k - 1];
                whole += 1.0;
                late += 1.0;
                mean_late += followed;
            }
            whole = std::max(1.0, whole);
            late -= whole;
            mean_late += followed * (late - mean_late);
        }
        places.push_back(places.back() + static_cast<std::size_t>(whole));
    }
    return places;
}

// The step by which all stamps together go from place to place.
double step_over(std::span<const double> time_s, std::span<const std::size_t> places, double step_s) {
    double passed_s = 0.0, passed = 0.0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double here = time_s[k] - time_s[k - 1];
        if (here >= is_gap * step_s) continue;
        passed_s += here;
        passed += static_cast<double>(places[k] - places[k - 1]);
    }
    return passed_s / passed;
}

std::vector<std::size_t> places_found(std::span<const double> time_s, double& step_s) {
    step_s = single_step_s(time_s, middle_step_s(time_s));
    if (step_s == 0.0) return {};
    // With jittered stamps the longest single steps look like lost rows, so the mean of the others is too
    // short.
    constexpr int passes = 2;
    for (int pass = 0; pass < passes; ++pass) step_s = step_over(time_s, places_on(time_s, step_s), step_s);
    return places_on(time_s, step_s);
}

}  // namespace

std::vector<std::size_t> places_of_rows(std::span<const double> time_s, double& step_s) {
    if (time_s.size() < 8) return {};
    // A diagnosis needs the positions of one clock a thousand times.
    struct Asked {
        std::vector<double> time_s;
        std::vector<std::size_t> places;
        double step_s = 0.0;
    };
    thread_local Asked last;
    if (!std::ranges::equal(last.time_s, time_s)) {
        last.time_s.assign(time_s.begin(), time_s.end());
        last.places = places_found(time_s, last.step_s);
    }
    step_s = last.step_s;
    return last.places;
}

std::vector<double> with_lost_rows(std::span<const double> values, std::span<const std::size_t> places) {
    std::vector<double> whole(places.back() + 1, 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) whole[places[k]] = values[k];
    for (std::size_t k = 1; k < values.size(); ++k) {
        // The four samples about the gap, fewer at the ends.
        const std::size_t first = k > 1 ? k - 2 : 0, end = std::min(k + 2, values.size());
        for (std::size_t place = places[k - 1] + 1; place < places[k]; ++place) {
            double value = 0.0;
            for (std::size_t i = first; i < end; ++i) {
                double weight = 1.0;
                for (std::size_t j = first; j < end; ++j) {
                    if (j == i) continue;
                    weight *= (static_cast<double>(place) - static_cast<double>(places[j])) /
                              (static_cast<double>(places[i]) - static_cast<double>(places[j]));
                }
                value += weight * values[i];
            }
            whole[place] = value;
        }
    }
    return whole;
}

}  // namespace ripplenotch
