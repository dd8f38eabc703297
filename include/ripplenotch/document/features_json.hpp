// SPDX-License-Identifier: MIT
#pragma once
// Lines of features as JSON, one object a line, and as CSV.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/fleet/shards.hpp"

namespace ripplenotch {

// The record that a complete shard leaves beside its lines.

/// Schema ripplenotch/shard/1; same record, same bytes.
[[nodiscard]] std::string shard_record_text(const ShardRecord& record);
/// Reads it back. Throws DataError that names `source`, the field, what it holds and what was expected.
[[nodiscard]] ShardRecord shard_record_from_json(std::string_view text, const std::string& source);

/// One line with its line feed, schema ripplenotch/features/1; same features, same bytes. Units stand in the
/// names, intervals under "..._ci95_...", reasons for null in "not_told".
[[nodiscard]] std::string feature_line_text(const FeatureLine& line);

/// A header and a row a line. Columns of intervals end in _low and _high; the last two are "not_told" and
/// "error".
[[nodiscard]] std::string features_csv(std::span<const FeatureLine> lines);

/// Reads one line back. Throws DataError that names `source`, the field, what it holds and what was expected.
[[nodiscard]] FeatureLine feature_line_from_json(std::string_view text, const std::string& source);

/// All lines of a text; empty ones do not count. Throws DataError with source and line.
[[nodiscard]] std::vector<FeatureLine> feature_lines_from_text(std::string_view text,
                                                               const std::string& source);

}  // namespace ripplenotch
