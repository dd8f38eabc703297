// SPDX-License-Identifier: MIT
#pragma once
// Internal: which descriptors there are.

#include <span>
#include <string_view>

namespace ripplenotch {

struct DescriptorKind {
    std::string_view stem;  ///< "ripple_N_amplitude": with an order in the place of N
    std::string_view unit;
    bool scales_with_torque = false;
    std::string_view what;
};

/// In the order of descriptors.def, which is that of a line.
[[nodiscard]] std::span<const DescriptorKind> descriptor_kinds();

}  // namespace ripplenotch
