// SPDX-License-Identifier: MIT
#pragma once
// Figures of a filter on one log, by the measurement that methods are compared by.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

struct FilterMetrics {
    std::string source, joint, method;  ///< the method as it would be typed again
    Hertz sample_rate;                  ///< rate that the filter was designed for, or started with
    std::optional<Hertz> table_rate;    ///< rate that the table was designed for
    StreamReport stream;
    std::optional<GearAccount> gear;    ///< empty when unknown: then nothing is measured
    std::optional<LogLevels> measured;  ///< of the one method
    std::vector<LedgerEntry> delays;
    std::optional<Hertz> crossover;  ///< frequency of the ledger's phase lags

    /// Lines of raw and filtered torque, one per order of the gear; null without a window that shows any.
    [[nodiscard]] const RippleLevels* lines() const {
        return measured && measured->lines.windows > 0 ? &measured->lines : nullptr;
    }
};

/// measure_on_log() of a filter that has run, on the rows that were kept of its log; not on the bench.
[[nodiscard]] LogLevels measure_kept(const Contender& contender, const KeptRows& kept,
                                     const GearAccount& lines);

/// Attenuation of one order in dB; empty when there was nothing to attenuate or nothing was left.
[[nodiscard]] std::optional<double> attenuation_db(const OrderLevel& level);

/// Above this MethodFigures::start_ratio a filter's start is warned of: it does more harm than a half of what
/// the ripple does.
inline constexpr double start_worth_a_word = 1.5;

/// What the filter made worse, one sentence each with the remedy: an order that grew, more torque moved than
/// ripple taken out, a start that is worse than the ripple, a jump at a switch larger than the ripple. Empty
/// where nothing was measured.
[[nodiscard]] std::vector<std::string> harm_done(const FilterMetrics& metrics);
/// Orders of which far more is left than was predicted, one sentence each.
[[nodiscard]] std::vector<std::string> short_of_prediction(const FilterMetrics& metrics);

/// Ripple of all measured orders together, rms, of one of the signals: 0 is the raw torque.
[[nodiscard]] double ripple_rms_nm(const RippleLevels& levels, std::size_t signal);

/// The remaining ripple of one order at the speeds of this log, predicted from the filter's response: from
/// the amplitude in the table or joint if stated, else from the measured one before filtering. Empty when it
/// was not computed.
[[nodiscard]] std::optional<double> predicted_nm(const FilterMetrics& metrics, std::size_t order);

}  // namespace ripplenotch
