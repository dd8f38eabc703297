// SPDX-License-Identifier: MIT
#pragma once
// Effects that a log does not let be examined, because of what it does not hold.

namespace ripplenotch {

struct Effect;

/// True when the effect's torque depends on where the joint is and not only on how it moves. The integral of
/// a velocity tells how far the joint has gone and not from where: a log without position cannot decide such
/// an effect. Ripple is not among them: its phase is that of the motor, and a whole turn of it changes
/// nothing.
[[nodiscard]] bool needs_position(const Effect& effect);

}  // namespace ripplenotch
