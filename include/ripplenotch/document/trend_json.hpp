// SPDX-License-Identifier: MIT
#pragma once
// trend.json: what changed in a fleet, as tables that a page shows and others read.

#include <string>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// One sentence: how many joints changed, what changed most, and how many false alarms are to be expected.
[[nodiscard]] std::string trend_verdict(const Trend& trend);

/// The whole text of trend.json, schema ripplenotch/trend/1; same trend, same bytes.
[[nodiscard]] std::string trend_text(const Trend& trend, const Provenance& provenance);

/// An alert a line, for what reads lines: the fields of "alerts" in trend.json.
[[nodiscard]] std::string alert_lines(const Trend& trend);

}  // namespace ripplenotch
