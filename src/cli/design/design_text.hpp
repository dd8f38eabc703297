// SPDX-License-Identifier: MIT
#pragma once
// A candidate table as people read it.

#include <string>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/document/table_json.hpp"

namespace ripplenotch {

/// What the table is for, one row a band, and sentences: the delays, what happens outside the bands, and what
/// it was designed for.
[[nodiscard]] std::string table_to_text(const CandidateTable& table, const DesignNote& note = {});

/// One sentence for each band whose middle can be notched but which reaches beyond half the sample rate,
/// where the line of the highest order comes back as an alias.
[[nodiscard]] std::vector<std::string> alias_warnings(const CandidateTable& table);

}  // namespace ripplenotch
