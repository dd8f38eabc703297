// SPDX-License-Identifier: MIT
#pragma once
// What a name is worth in blocks of the log that nothing was fitted to.

#include <span>
#include <vector>

#include "diagnose/beside/weighing/ground.hpp"

namespace ripplenotch {

/// Fall of the squared residual from `without` to `with`, block by block.
struct OutsideGain {
    double gain = 0.0;  ///< in units of sigma squared
    double t = 0.0;     ///< of its own deviation, by the blocks and how each is like the one before
    std::vector<double> by_block;

    [[nodiscard]] std::size_t positive() const;
    /// The gain without its best blocks.
    [[nodiscard]] double without_best(std::size_t blocks) const;
};

/// Both residuals have a value per row, folds one after the other. `blocks` in order of time.
[[nodiscard]] OutsideGain outside_gain(std::span<const double> without, std::span<const double> with,
                                       std::span<const RowRange> blocks, double sigma);

/// Worth its price all over the log.
[[nodiscard]] bool is_worth(const OutsideGain& gain, double price, const BesideRules& rules);

}  // namespace ripplenotch
