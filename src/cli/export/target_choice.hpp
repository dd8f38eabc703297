// SPDX-License-Identifier: MIT
#pragma once
// --target: what of the methods an export target can hold.

#include <optional>
#include <span>
#include <string>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

/// Coefficients of a method that has some; a table has a rate of its own.
[[nodiscard]] FilterSet filters_of(const Contender& method, const std::optional<Hertz>& sample_rate);

/// The keys of a target, checked. Throws UsageError.
[[nodiscard]] Settings settings_of(const Spec& spec, std::span<const Key> keys);

struct TargetChoice {
    Spec spec;
    const Target* filters = nullptr;  ///< null where it holds none
    const MapTarget* maps = nullptr;  ///< the same

    /// Why the target cannot hold the method, as export would say it; empty where it can.
    [[nodiscard]] std::string refusal(const Contender& method, Hertz sample_rate) const;
    /// The map as the target has it, to be judged in place of the whole one; empty where it holds all of it,
    /// or none.
    [[nodiscard]] std::optional<RippleMap> held(const RippleMap& map) const;
    /// The command that makes the target's file of a method that it holds.
    [[nodiscard]] std::string command(const Contender& method, Hertz sample_rate) const;
};

/// Throws UsageError with all names.
[[nodiscard]] TargetChoice find_any_target(const std::string& text);

}  // namespace ripplenotch
