// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/document/comparison_json.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/export/map_target.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

// --target: which methods an export target can hold.

struct TargetChoice {
    Spec spec;
    const Target* filters = nullptr;  ///< null where it holds none
    const MapTarget* maps = nullptr;  ///< the same

    [[nodiscard]] bool holds(const Contender& method) const;
    /// The map as the target has it, to be judged in place of the whole one; empty where it holds all of it.
    /// Throws what the target throws.
    [[nodiscard]] std::optional<RippleMap> held(const RippleMap& map) const;
    /// The command that makes the target's file of a method that it holds.
    [[nodiscard]] std::string command(const Contender& method, Hertz sample_rate) const;
};

}  // namespace ripplenotch
