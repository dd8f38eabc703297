// SPDX-License-Identifier: MIT
#pragma once
// The inner loop of the block form.

#include <cstddef>
#include <span>

#include "filter/kernels/block_form.hpp"

namespace ripplenotch {

/// One BlockForm on its way.
struct BlockPass {
    BlockForm form;
    alignas(32) BlockForm::Memory memory{};
};

/// out = origin + F(in - origin) for whole groups of BlockForm::samples, through all passes, of which there
/// is one at least; sizes are equal, and the spans may not overlap. False, with the memories as before and
/// nothing of use in `out`, where an input or a memory is so large, or no number, that an input could be
/// heard in an output before it (zero times infinity is no zero), unless it is to run `whatever` they are.
[[nodiscard]] bool run_groups(std::span<BlockPass> passes, std::span<const double> in, double origin,
                              std::span<double> out, bool whatever = false);

}  // namespace ripplenotch
