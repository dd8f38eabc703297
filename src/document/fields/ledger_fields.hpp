// SPDX-License-Identifier: MIT
#pragma once
// One entry of a delay ledger, as metrics.json and comparison.json write it, and one of a switching ledger.

#include "document/json/json.hpp"
#include "ripplenotch/evaluate/ledger.hpp"
#include "ripplenotch/evaluate/switch_ledger.hpp"

namespace ripplenotch {

[[nodiscard]] Json ledger_entry_to_json(const LedgerEntry& entry);

[[nodiscard]] Json switch_to_json(const Switch& change, Seconds time);

/// The change, and what it did to the output.
[[nodiscard]] Json switch_entry_to_json(const SwitchEntry& entry);

/// {"0.5": ms, "1": ms, ...}
[[nodiscard]] Json settling_to_json(const StepMeasurement& step);

}  // namespace ripplenotch
