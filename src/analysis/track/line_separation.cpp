// SPDX-License-Identifier: MIT
#include "analysis/track/line_separation.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

constexpr double close_share = 0.5;     ///< lines closer than this share of the bandwidth ...
constexpr std::size_t near_widths = 8;  ///< ... for most of so many times 1/bandwidth are one

/// True at the points around which a line turns by fewer than `fewest` cycles within `width` points.
std::vector<bool> stands(const std::vector<double>& cycles, std::size_t width, double fewest) {
    std::vector<double> travelled(cycles.size(), 0.0);
    for (std::size_t j = 1; j < cycles.size(); ++j) {
        travelled[j] = travelled[j - 1] + std::abs(cycles[j] - cycles[j - 1]);
    }
    std::vector<bool> still(cycles.size());
    for (std::size_t j = 0; j < cycles.size(); ++j) {
        const std::size_t from = std::min(j > width / 2 ? j - width / 2 : 0, cycles.size() - 1 - width);
        still[j] = travelled[from + width] - travelled[from] < fewest;
    }
    return still;
}

/// True at the points around which two lines stay together. They may cross: what each is before and after
/// tells them apart while they do.
std::vector<bool> stay_together(const std::vector<double>& apart_cycles, std::size_t width) {
    const std::size_t n = apart_cycles.size(), reach = std::max<std::size_t>(1, width / 16);
    std::vector<std::size_t> near(n + 1, 0);  // how many points before this one are near
    for (std::size_t j = 0; j < n; ++j) {
        const std::size_t from = j > reach ? j - reach : 0, to = std::min(j + reach, n - 1);
        const double rate = std::abs(apart_cycles[to] - apart_cycles[from]) / static_cast<double>(to - from);
        near[j + 1] = near[j] + (rate * static_cast<double>(width) < close_share ? 1 : 0);
    }
    const std::size_t window = std::min(near_widths * width, n);
    std::vector<bool> together(n);
    for (std::size_t j = 0; j < n; ++j) {
        const std::size_t from = std::min(j > window / 2 ? j - window / 2 : 0, n - window);
        together[j] = 2 * (near[from + window] - near[from]) > window;
    }
    return together;
}

}  // namespace

std::vector<std::vector<bool>> not_separable(const std::vector<std::vector<double>>& cycles,
                                             std::size_t width, double fewest) {
    std::vector<std::vector<bool>> unknown;
    for (const auto& line : cycles) unknown.push_back(stands(line, width, fewest));
    for (std::size_t i = 0; i < cycles.size(); ++i) {
        for (std::size_t other = 0; other < i; ++other) {
            for (const double sign : {-1.0, 1.0}) {  // a real line is a pair of turning ones
                std::vector<double> between(cycles[i]);
                for (std::size_t j = 0; j < between.size(); ++j) between[j] += sign * cycles[other][j];
                const auto still = stay_together(between, width);
                for (std::size_t j = 0; j < still.size(); ++j) {
                    if (still[j]) unknown[i][j] = unknown[other][j] = true;
                }
            }
        }
    }
    return unknown;
}

}  // namespace ripplenotch
