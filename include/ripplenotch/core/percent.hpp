// SPDX-License-Identifier: MIT
#pragma once
#include <string>

namespace ripplenotch {

/// A percentage as people print it, two significant digits and no exponent: "0.16", "4.2", "38", "100", and
/// "0" for none, never "-0.0" or "1e+02". Without the sign.
[[nodiscard]] std::string percent_text(double percent);

}  // namespace ripplenotch
