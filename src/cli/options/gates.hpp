// SPDX-License-Identifier: MIT
#pragma once
// Limits that a user sets on what a method may cost and must do; a violation is exit code 1.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/ledger.hpp"

namespace ripplenotch {

struct Gates {
    std::optional<Seconds> max_delay;
    std::optional<double> min_attenuation_db;
};
void attach_gates(Options& options, Gates& gates);

/// One sentence for each band that can come into force at |v| from slowest to fastest and delays by more than
/// the limit; for a method without bands one about the worst speed.
[[nodiscard]] std::vector<std::string> delay_violations(const Gates& gates, const Contender& contender,
                                                        Hertz sample_rate, DegPerSec slowest,
                                                        DegPerSec fastest);

/// One sentence for each order that is attenuated less than the limit, or was not measured.
[[nodiscard]] std::vector<std::string> attenuation_violations(const Gates& gates, const std::string& method,
                                                              std::span<const OrderAttenuation> orders);

/// Both, of a filtered log: delays at the speeds that it moved at, attenuation as it was measured there.
[[nodiscard]] std::vector<std::string> filter_violations(const Gates& gates, const Contender& contender,
                                                         const FilterMetrics& metrics);

}  // namespace ripplenotch
