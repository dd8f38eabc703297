// SPDX-License-Identifier: MIT
#pragma once
// A method with its settings, its table and the gear whose ripple it is measured by, ready to be started as
// often as it is needed.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

struct Contender {
    std::string text;  ///< as it would be typed: "fixed,centers=25Hz:50Hz,q=0.25"
    const Method* method = nullptr;
    Settings settings;
    std::shared_ptr<const CandidateTable> table = nullptr;  ///< null unless the method needs one
    std::optional<GearAccount> gear = std::nullopt;         ///< empty when nobody says it
    std::vector<std::string> files = {};                    ///< that table and gear were read from, each once
    std::shared_ptr<const RippleMap> map = nullptr;         ///< that it was given, if any
    /// The same method that knows no ripple, where it knows one from a map.
    std::shared_ptr<const Contender> without_ripple = nullptr;

    /// A filter without a past. Throws UsageError on what cannot be designed at this sample rate.
    [[nodiscard]] std::unique_ptr<CausalFilter> start(Hertz sample_rate) const;
    /// The same for signals that have no ripple: what is known of it from a map is no part of them.
    [[nodiscard]] std::unique_ptr<CausalFilter> start_on_bench(Hertz sample_rate) const;
    /// Null for methods that need no first pass over the log.
    [[nodiscard]] std::unique_ptr<Learner> learner(Hertz sample_rate) const;
    /// The linear filter in force at a constant speed; empty for methods that have none.
    [[nodiscard]] std::optional<FrozenFilter> frozen(Hertz sample_rate, DegPerSec speed) const;
    /// The gear ratio that its filter is made for: its key's or its table's; empty where it has neither.
    [[nodiscard]] std::optional<GearRatio> made_for() const;
};

/// Finds the method and checks its settings; `table` is needed by some methods. Throws UsageError.
[[nodiscard]] Contender make_contender(const Spec& spec,
                                       std::shared_ptr<const CandidateTable> table = nullptr);

}  // namespace ripplenotch
