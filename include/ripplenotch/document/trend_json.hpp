// SPDX-License-Identifier: MIT
#pragma once
// trend.json: what changed in a fleet, as tables that a page shows and others read.

#include <string>
#include <string_view>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// One sentence: how many joints changed, what changed most, and how many false alarms are to be expected.
[[nodiscard]] std::string trend_verdict(const Trend& trend);

/// The whole text of trend.json, schema ripplenotch/trend/1; same trend, same bytes.
[[nodiscard]] std::string trend_text(const Trend& trend, const Provenance& provenance);

/// Reads back what a picture of it needs: joints, alerts, and the courses of the first.
/// Throws DataError that names `source`, the field, what it holds and what was expected.
[[nodiscard]] Trend trend_from_json(std::string_view text, const std::string& source);

}  // namespace ripplenotch
