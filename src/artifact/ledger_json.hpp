// SPDX-License-Identifier: MIT
#pragma once
// One entry of a delay ledger, as metrics.json and comparison.json write it.

#include "artifact/json.hpp"
#include "ripplenotch/evaluate/ledger.hpp"

namespace ripplenotch {

[[nodiscard]] Json ledger_entry_to_json(const LedgerEntry& entry);

/// {"0.5": ms, "1": ms, ...}
[[nodiscard]] Json settling_to_json(const StepMeasurement& step);

}  // namespace ripplenotch
