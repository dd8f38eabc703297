// SPDX-License-Identifier: MIT
#pragma once
// What a filter did to one log, as figures.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/units.hpp"
#include "ripplenotch/evaluate/ledger.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

struct FilterMetrics {
    std::string source, joint, method;  ///< the method as it would be typed again
    Hertz sample_rate;                  ///< that the filter was designed for, or started with
    std::optional<Hertz> table_rate;    ///< that the table was designed for
    StreamReport stream;
    std::optional<GearAccount> gear;  ///< empty when unknown: then there are no levels
    std::optional<RippleLevels>
        levels;  ///< of two signals, raw and filtered torque, one per order of the gear
    std::vector<LedgerEntry> delays;
    std::optional<Hertz> crossover;  ///< that the ledger's phase lags are for
};

/// Attenuation of one order in dB; empty when there was nothing to attenuate or nothing was left.
[[nodiscard]] std::optional<double> attenuation_db(const OrderLevel& level);

/// What the filter's own response says is left of one order at the speeds of this log: of the amplitude that
/// table or joint state, else of what the log shows before filtering. Empty when it was not worked out.
[[nodiscard]] std::optional<double> predicted_nm(const FilterMetrics& metrics, std::size_t order);

}  // namespace ripplenotch
