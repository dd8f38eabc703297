// SPDX-License-Identifier: MIT
#pragma once
// Doubts about a reading that only the values can raise, as warnings: they never change what was read.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// What of a log's values matters for them.
struct LogExtremes {
    std::size_t rows = 0;
    double speed_deg_s = 0.0;            ///< largest magnitude
    std::optional<double> position_deg;  ///< likewise, of the continuous position
    Hertz sample_rate;
};
[[nodiscard]] LogExtremes extremes_of(const TraceView& trace);

/// One sentence each: a position that starts again after `wrap` degrees, and readings that may be wrong.
[[nodiscard]] std::vector<std::string> doubts(const Layout& layout, std::optional<double> wrap_deg,
                                              const LogExtremes& extremes);

/// Throws DataError where a log that needs a rate has none.
void require_rate(const Layout& layout, const LogExtremes& extremes, const ReadOptions& options);

}  // namespace ripplenotch
