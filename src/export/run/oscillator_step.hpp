// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {

/// The body of the oscillator's step, as export/run/oscillator_run.hpp computes it; fields as CodeStyle fills
/// them.
[[nodiscard]] std::string oscillator_step_code(const OscillatorDesign& design);

}  // namespace ripplenotch
