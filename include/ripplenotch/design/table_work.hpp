// SPDX-License-Identifier: MIT
#pragma once
// How much work it is to measure the bands of a table: told before it is done, so that no table keeps anybody
// waiting.

#include <cstddef>

#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

constexpr std::size_t most_bands = 10000;  ///< by hand: docs/security.md
constexpr std::size_t most_orders = 64;    ///< by hand: docs/security.md

/// Adds up what measure_band() will have to do. A table that can be designed can be read again: both ask
/// here.
class TableWork {
  public:
    /// Throws UsageError when the bands added so far take more than about a second together.
    void add(const Band& band, double settle_band_percent);

  private:
    std::size_t bands_ = 0;
    double responses_ = 0.0, steps_ = 0.0;
};

}  // namespace ripplenotch
