// SPDX-License-Identifier: MIT
#pragma once
// Lines of features as JSON, one object a line.

#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// One line with its line feed, schema ripplenotch/features/1; same features, same bytes. Units stand in the
/// names, intervals under "..._ci95_...", reasons for null in "not_told".
[[nodiscard]] std::string feature_line_text(const FeatureLine& line);

/// Reads one line back. Throws DataError that names `source`, the field, what it holds and what was expected.
[[nodiscard]] FeatureLine feature_line_from_json(std::string_view text, const std::string& source);

/// All lines of a text; empty ones do not count. Throws DataError with source and line.
[[nodiscard]] std::vector<FeatureLine> feature_lines_from_text(std::string_view text,
                                                               const std::string& source);

// trend.json: what changed in a fleet, as tables that a page shows and others read.

/// One sentence: how many joints changed, what changed most, and how many false alarms are to be expected.
[[nodiscard]] std::string trend_verdict(const Trend& trend);

/// The whole text of trend.json, schema ripplenotch/trend/1; same trend, same bytes.
[[nodiscard]] std::string trend_text(const Trend& trend, const Provenance& provenance);

}  // namespace ripplenotch
