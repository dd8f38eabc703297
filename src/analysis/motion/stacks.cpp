// SPDX-License-Identifier: MIT
#include "analysis/motion/stacks.hpp"

#include "analysis/spectrum/stacking.hpp"
#include "core/process/two_cores.hpp"

namespace ripplenotch {

Stacks stacked(const std::vector<Sweep>& sweeps, const MotionLinesOptions& options) {
    // Two domains are asked.
    const double false_alarm = 0.5 * options.false_alarm;
    Stacking angle(sweeps, Axis::angle, options.stack), time(sweeps, Axis::time, options.stack);
    on_two_cores(angle.parts() + time.parts(), [&](std::size_t part) {
        if (part < time.parts())
            time.run(part);
        else
            angle.run(part - time.parts());
    });
    Stacks stacks{angle.stack(), time.stack(), {}, {}};
    on_two_cores(2, [&](std::size_t i) {
        if (i == 0)
            stacks.time_peaks = stacks.time.peaks(false_alarm);
        else
            stacks.angle_peaks = stacks.angle.peaks(false_alarm);
    });
    return stacks;
}

}  // namespace ripplenotch
