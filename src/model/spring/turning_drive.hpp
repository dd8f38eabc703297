// SPDX-License-Identifier: MIT
#pragma once
// A phasor that turns with the joint, as what it drives meets it step by step.

#include <cstddef>
#include <memory>
#include <vector>

#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

struct TurningDrive {
    /// From sample to sample, the first of no meaning but that of `hz`, which is of the first sample.
    std::vector<double> hz;            ///< mean of both samples; negative where the joint turns back
    std::vector<double> cosine, sine;  ///< of the drive's turn, reversed
    std::vector<std::size_t> step;     ///< place in `steps_s`

    /// Every length of a step once, the usual one first: a clock writes few. A step that is no step forward
    /// is a usual one.
    std::vector<double> steps_s;
};

/// A drive that turns `cycles_per_deg` times a degree of the joint. A search asks for hundreds of springs
/// along one motion: the last drive of each thread is kept.
[[nodiscard]] std::shared_ptr<const TurningDrive> turning_drive(const Motion& motion, double cycles_per_deg);

}  // namespace ripplenotch
