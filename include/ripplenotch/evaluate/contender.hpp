// SPDX-License-Identifier: MIT
#pragma once
// A method with its settings, ready to be started as often as a comparison needs it.

#include <memory>
#include <optional>
#include <string>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

struct Contender {
    std::string text;  ///< as it would be typed: "fixed,centers=25Hz:50Hz,q=0.25"
    const Method* method = nullptr;
    Settings settings;
    std::shared_ptr<const CandidateTable> table;  ///< null unless the method needs one

    /// A filter without a past. Throws UsageError on what cannot be designed at this sample rate.
    [[nodiscard]] std::unique_ptr<CausalFilter> start(Hertz sample_rate) const;
    /// Null for methods that need no first pass over the log.
    [[nodiscard]] std::unique_ptr<Learner> learner(Hertz sample_rate) const;
    /// The linear filter in force at a constant speed; empty for methods that have none.
    [[nodiscard]] std::optional<FrozenFilter> frozen(Hertz sample_rate, DegPerSec speed) const;
};

/// Finds the method and checks its settings; `table` is needed by some methods. Throws UsageError.
[[nodiscard]] Contender make_contender(const Spec& spec,
                                       std::shared_ptr<const CandidateTable> table = nullptr);

}  // namespace ripplenotch
