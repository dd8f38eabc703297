// SPDX-License-Identifier: MIT
#pragma once
// table.json, the candidate table between design, filter, compare and export; and the same table as CSV.

#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// What a table was asked to hold, empty for one that was spelled out, and whose ripple it is for. For
/// readers: no command depends on it.
struct DesignNote {
    std::optional<double> min_attenuation_db;
    std::optional<Seconds> max_delay;
    std::string reason;
    std::optional<DegPerSec> slowest;  ///< below it no notch that a design may take is within max_delay
    std::optional<GearAccount> gear;   ///< whose ripple the bands are for, and who says so
};

/// The whole text of table.json; same table, same bytes.
[[nodiscard]] std::string table_to_json(const CandidateTable& table, const Provenance& provenance,
                                        const DesignNote& note = {});

/// Reads a table back. Nothing is believed: unknown fields are refused, sections and figures are worked out
/// again from centre, Q and depth and compared. Throws DataError that names `source`, the field, both values
/// and the remedy.
[[nodiscard]] CandidateTable table_from_json(std::string_view text, const std::string& source);

/// table_from_json of a file, or of standard input when the path is "-".
[[nodiscard]] CandidateTable load_table(const std::string& path);

/// Whether all notches of each band have the same Q.
[[nodiscard]] bool one_q_a_band(const CandidateTable& table);

/// One row a band: number, speed_from_deg_s, speed_to_deg_s, center_1_hz ..., q, dc_delay_ms, settle_ms,
/// overshoot_percent, worst_attenuation_1_db ... The suffix counts the orders from 1, lowest first. Where the
/// orders of a band differ in Q, q_1, q_2 ... stand in place of q.
[[nodiscard]] std::string table_to_csv(const CandidateTable& table);

}  // namespace ripplenotch
