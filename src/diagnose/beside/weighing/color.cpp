// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/color.hpp"

#include <numeric>

#include "core/vectors/dot.hpp"

namespace ripplenotch {

std::vector<double> long_color(std::span<const double> left, std::size_t p, double floor) {
    const std::size_t n = left.size();
    std::vector<double> centred(left.begin(), left.end());
    const double mean = std::accumulate(left.begin(), left.end(), 0.0) / static_cast<double>(n);
    for (double& value : centred) value -= mean;
    std::vector<double> covariance;
    for (std::size_t lag = 0; lag <= p; ++lag)
        covariance.push_back(dot(centred.data(), centred.data() + lag, n - lag) / static_cast<double>(n));
    if (!(covariance[0] > 0.0)) return {};
    covariance[0] *= 1.0 + floor;
    // Levinson's recursion.
    std::vector<double> a;
    double variance = covariance[0];
    for (std::size_t lag = 1; lag <= p; ++lag) {
        double reflection = covariance[lag];
        for (std::size_t i = 0; i < a.size(); ++i) reflection -= a[i] * covariance[lag - 1 - i];
        reflection /= variance;
        std::vector<double> next = a;
        for (std::size_t i = 0; i < a.size(); ++i) next[i] -= reflection * a[a.size() - 1 - i];
        next.push_back(reflection);
        a = std::move(next);
        variance *= 1.0 - reflection * reflection;
        if (!(variance > 0.0)) break;
    }
    return a;
}

}  // namespace ripplenotch
