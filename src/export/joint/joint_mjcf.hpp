// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "ripplenotch/export/joint_mjcf.hpp"

namespace ripplenotch {

// Pieces of MuJoCo's description that a file of its own and the user's file have alike.

/// A comment that lists what is held and what is not; `heading` first.
[[nodiscard]] std::string mjcf_comment(const JointMjcf& mjcf, std::span<const std::string> heading);
/// "0.3 1e-05", or one number where there is no friction with the square of the speed.
[[nodiscard]] std::string damping_words(const JointMjcf& mjcf);
/// The dcmotors, a line each, whose names end in `ending`. The compiler requires a motor constant and a
/// resistance above 0.
[[nodiscard]] std::string mjcf_motors(const JointMjcf& mjcf, std::string_view joint, std::string_view ending);
/// For an attribute between double quotes.
[[nodiscard]] std::string xml_words(std::string_view text);

}  // namespace ripplenotch
