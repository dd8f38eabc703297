// SPDX-License-Identifier: MIT
#include "fleet/trend/kin_scatter.hpp"

#include <algorithm>
#include <cmath>

#include "fleet/trend/change_test.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double fewest_others = 4.0;  // by hand
constexpr double most_worth = 100.0;   // lines, however alike the joints are

/// One joint's scatter as a number that is about normal among joints: its logarithm, without the bias that
/// few lines have.
struct LogScatter {
    std::size_t history = 0;
    double value = 0.0, own_variance = 0.0;
};

// Sums over joints, from which one of them is easily taken out.
struct Sums {
    double count = 0.0, value = 0.0, squares = 0.0, own_variance = 0.0;

    void add(const LogScatter& one, double sign) {
        count += sign;
        value += sign * one.value;
        squares += sign * one.value * one.value;
        own_variance += sign * one.own_variance;
    }
};

// Logarithms of chi square over its freedom d have the mean -1/d and the variance 2/d + 2/d^2, to a few
// percent from four on.
LogScatter log_scatter(std::size_t history, const Scatter& own) {
    return {history, portable::log(own.variance) + 1.0 / own.freedom,
            2.0 / own.freedom + 2.0 / (own.freedom * own.freedom)};
}

// What joints differ by beside the chance of few lines tells what one is worth for another.
Scatter scatter_of(const Sums& others) {
    const double mean = others.value / others.count;
    const double variance = std::max(others.squares - others.count * mean * mean, 0.0) / (others.count - 1.0);
    const double apart = variance - others.own_variance / others.count;
    const double freedom = apart > 0.0 ? (1.0 + std::sqrt(1.0 + 2.0 * apart)) / apart : most_worth;
    const double worth = std::min(freedom, most_worth);
    return {worth, portable::exp(mean - 1.0 / worth)};
}

}  // namespace

std::vector<ScatterOfSeries> scatter_of_kin(std::span<const JointHistory> histories) {
    std::map<std::pair<std::string, std::string>, std::vector<LogScatter>> all;
    for (std::size_t h = 0; h < histories.size(); ++h) {
        if (histories[h].series.empty()) continue;
        for (const Scan& scan : scans_of(histories[h], regressions(histories[h], {})))
            if (scan.unit() > 0.0 && scan.scatter().variance > 0.0)
                all[{histories[h].joint, scan.name()}].push_back(log_scatter(h, scan.scatter()));
    }
    std::vector<ScatterOfSeries> told(histories.size());
    for (const auto& [name, joints] : all) {
        Sums sums;
        for (const LogScatter& one : joints) sums.add(one, 1.0);
        for (const LogScatter& one : joints) {
            Sums others = sums;
            others.add(one, -1.0);
            if (others.count >= fewest_others) told[one.history][name.second] = scatter_of(others);
        }
    }
    return told;
}

}  // namespace ripplenotch
