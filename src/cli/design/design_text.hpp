// SPDX-License-Identifier: MIT
#pragma once
// A candidate table as people read it.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/guarantee.hpp"
#include "ripplenotch/document/table_json.hpp"

namespace ripplenotch {

/// "No notch of Q 5 or less is within 20 ms below 4.3 deg/s."
[[nodiscard]] std::string slowest_sentence(Seconds delay, DegPerSec slowest);

// Speed ranges as people type them: "18:180:18", "0.3rad/s:3rad/s", "18:36,36:60,60:100deg/s".

struct SpeedRange {
    DegPerSec from, to;
    std::optional<DegPerSec> width;  ///< of one band; empty for FROM:TO
};

/// Reads FROM:TO or FROM:TO:WIDTH. Either each number has its unit, or only the last and it holds for all, or
/// none and all are deg/s. Throws UsageError that names `what`.
[[nodiscard]] SpeedRange parse_speed_range(std::string_view text, std::string_view what);

/// Reads FROM:TO,FROM:TO,... by the same rules, each band for itself.
[[nodiscard]] std::vector<std::pair<DegPerSec, DegPerSec>> parse_speed_bands(std::string_view text,
                                                                             std::string_view what);

/// What the table is for, one row a band, and sentences: the delays, what happens outside the bands, and what
/// it was designed for.
[[nodiscard]] std::string table_to_text(const CandidateTable& table, const DesignNote& note = {});

/// One sentence for each band whose middle can be notched but which reaches beyond half the sample rate,
/// where the line of the highest order comes back as an alias.
[[nodiscard]] std::vector<std::string> alias_warnings(const CandidateTable& table);

}  // namespace ripplenotch
