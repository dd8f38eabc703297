// SPDX-License-Identifier: MIT
#pragma once
// The account of a recording as every document carries it.

#include <span>

#include "document/json/json.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// Adds "recording", or "recordings" where there are several, and nothing where there is none.
void add_recordings(Json& json, std::span<const Recording> recordings);

/// [{"row", "from_s", "to_s"}]: the listed gaps.
[[nodiscard]] Json gaps_json(const ClockFacts& clock);

}  // namespace ripplenotch
