// SPDX-License-Identifier: MIT
#pragma once
// table.json, the candidate table between design, filter, compare and export; and the same table as CSV.

#include <string>
#include <string_view>

#include "ripplenotch/artifact/document.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

/// The whole text of table.json; same table, same bytes.
[[nodiscard]] std::string table_to_json(const CandidateTable& table, const Provenance& provenance);

/// Reads a table back. Nothing is believed: unknown fields are refused, sections and figures are worked out
/// again from centre, Q and depth and compared. Throws DataError that names `source`, the field, both values
/// and the remedy.
[[nodiscard]] CandidateTable table_from_json(std::string_view text, const std::string& source);

/// table_from_json of a file, or of standard input when the path is "-".
[[nodiscard]] CandidateTable load_table(const std::string& path);

/// One row a band: number, speed_from_deg_s, speed_to_deg_s, center_1_hz ..., q, dc_delay_ms, settle_ms,
/// overshoot_percent, worst_attenuation_1_db ... The suffix counts the orders from 1, lowest first.
[[nodiscard]] std::string table_to_csv(const CandidateTable& table);

}  // namespace ripplenotch
