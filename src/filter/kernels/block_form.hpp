// SPDX-License-Identifier: MIT
#pragma once
// Two sections in series, eight samples at a time: outputs and the next memory as sums over eight inputs and
// the memory before. No output waits for another, so the work fills vector registers where the recursion
// waits for itself.

#include <array>
#include <cstddef>
#include <span>

#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

/// y = feed x + recall s, s' = drive x + turn s, by columns. The memory s is that of step(), s1 and s2 of the
/// first section and then of the second, so that either form can go on where the other stopped.
struct BlockForm {
    static constexpr std::size_t samples = 8;
    static constexpr std::size_t memory = 4;
    using Outputs = std::array<double, samples>;
    using Memory = std::array<double, memory>;

    /// At most two sections. Coefficients come from step() itself.
    explicit BlockForm(std::span<const Biquad> sections);

    alignas(32) std::array<Outputs, samples> feed{};   ///< by input
    alignas(32) std::array<Outputs, memory> recall{};  ///< by memory
    alignas(32) std::array<Memory, samples> drive{};   ///< by input
    alignas(32) std::array<Memory, memory> turn{};     ///< by memory
};

}  // namespace ripplenotch
