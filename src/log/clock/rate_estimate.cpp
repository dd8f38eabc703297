// SPDX-License-Identifier: MIT
#include "ripplenotch/log/rate_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double nominal_tolerance = 0.001;  // by hand
// Steps cluster at their median when so many are this near, and their mean stays nearer still: rounded stamps
// of another rate (4.4 ms as 4 or 5 ms) are near it too, but to one side.
constexpr double cluster_width = 0.25, cluster_share = 0.75, cluster_lean = 0.03;
// Stamps that keep within so many steps of even ones were never late: then rows over time is the rate.
constexpr double even_steps = 1.5;
constexpr double few_repeats = 0.01;  // by hand

double two_digits(double value) {
    const double scale = portable::pow(10.0, std::floor(portable::log10(value)) - 1.0);
    // Dividing by a whole power of ten is exact where multiplying by a fraction is not: 0.001 s must give
    // 1000 Hz.
    return scale < 1.0 ? std::round(value / scale) / std::round(1.0 / scale)
                       : std::round(value / scale) * scale;
}

bool near(double a, double b) { return std::abs(a - b) <= nominal_tolerance * b; }

bool cluster(const std::vector<double>& advancing, double median_s) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const double step : advancing) {
        if (std::abs(step - median_s) > cluster_width * median_s) continue;
        sum += step;
        ++count;
    }
    return static_cast<double>(count) >= cluster_share * static_cast<double>(advancing.size()) &&
           std::abs(sum / static_cast<double>(count) - median_s) <= cluster_lean * median_s;
}

/// The furthest that times get from even ones, gaps closed.
double furthest_from_even(std::span<const double> time_s, double mean_s, double limit_s) {
    double off = 0.0, furthest = 0.0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double step = time_s[k] - time_s[k - 1];
        if (step > limit_s) continue;
        off += step - mean_s;
        furthest = std::max(furthest, std::abs(off));
    }
    return furthest;
}

}  // namespace

Hertz nominal_rate(Hertz measured) {
    const double rate = measured.value();
    if (!(rate > 0.0) || !std::isfinite(rate)) return measured;
    if (const double round_rate = two_digits(rate); near(rate, round_rate)) return Hertz(round_rate);
    if (const double period = two_digits(1.0 / rate); near(rate, 1.0 / period)) {
        const double by_period = 1.0 / period;
        // 1 / 0.008 is 125 but for rounding.
        return Hertz(std::abs(by_period - std::round(by_period)) < 1e-9 * by_period ? std::round(by_period)
                                                                                    : by_period);
    }
    return measured;
}

RateEstimate estimate_rate(std::span<const double> time_s, double gap_steps) {
    std::vector<double> advancing;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        if (time_s[k] > time_s[k - 1]) advancing.push_back(time_s[k] - time_s[k - 1]);
    }
    if (advancing.empty()) return {};
    RateEstimate rate;
    rate.step_s = median_in(advancing);
    const double limit_s = gap_steps * rate.step_s;
    double duration = 0.0;
    std::size_t gaps = 0;
    for (const double step : advancing) {
        gaps += step > limit_s;
        duration += step > limit_s ? 0.0 : step;
    }
    const double steps = static_cast<double>(time_s.size() - 1);
    const double mean_s = duration / (steps - static_cast<double>(gaps));
    rate.mean = Hertz(1.0 / mean_s);
    const bool repeats = steps - static_cast<double>(advancing.size()) > few_repeats * steps;
    const bool lost = !repeats && cluster(advancing, rate.step_s) &&
                      furthest_from_even(time_s, mean_s, limit_s) > even_steps * rate.step_s;
    rate.nominal = nominal_rate(lost ? Hertz(1.0 / rate.step_s) : rate.mean);
    return rate;
}

}  // namespace ripplenotch
