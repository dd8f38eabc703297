// SPDX-License-Identifier: MIT
#include "analysis/motion/stacks.hpp"

#include "analysis/spectrum/stacking.hpp"
#include "core/process/two_cores.hpp"

namespace ripplenotch {

Stacks stacked(const std::vector<Sweep>& sweeps, const MotionLinesOptions& options) {
    Stacking angle(sweeps, Axis::angle, options.stack), time(sweeps, Axis::time, options.stack);
    on_two_cores(angle.parts() + time.parts(), [&](std::size_t part) {
        if (part < time.parts())
            time.run(part);
        else
            angle.run(part - time.parts());
    });
    return {angle.stack(), time.stack()};
}

}  // namespace ripplenotch
