// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/outside_gain.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {
std::size_t OutsideGain::positive() const {
    return static_cast<std::size_t>(
        std::count_if(by_block.begin(), by_block.end(), [](double g) { return g > 0.0; }));
}

double OutsideGain::without_best(std::size_t blocks) const {
    std::vector<double> sorted = by_block;
    std::sort(sorted.rbegin(), sorted.rend());
    double rest = gain;
    for (std::size_t b = 0; b < std::min(blocks, sorted.size()); ++b) rest -= sorted[b];
    return rest;
}

OutsideGain outside_gain(std::span<const double> without, std::span<const double> with,
                         std::span<const RowRange> blocks, double sigma) {
    // A gain whose blocks pull against each other is not taken for surer than by half.
    constexpr double least_variance = 0.25;
    OutsideGain told;
    for (const RowRange& block : blocks) {
        double sum = 0.0;
        for (std::size_t k = block.first; k < block.first + block.count; ++k)
            sum += without[k] * without[k] - with[k] * with[k];
        told.by_block.push_back(sum / (sigma * sigma));
        told.gain += told.by_block.back();
    }
    const double mean = told.gain / static_cast<double>(blocks.size());
    double variance = 0.0, alike = 0.0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const double off = told.by_block[b] - mean;
        variance += off * off;
        if (b > 0) alike += off * (told.by_block[b - 1] - mean);
    }
    told.t = told.gain / std::max(std::sqrt(std::max(variance + alike, least_variance * variance)), 1e-12);
    return told;
}

bool is_worth(const OutsideGain& gain, double price, const BesideRules& rules) {
    return gain.gain >= price && gain.t >= rules.least_t && gain.without_best(rules.best_blocks) >= price;
}

}  // namespace ripplenotch
