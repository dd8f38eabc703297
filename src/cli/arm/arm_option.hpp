// SPDX-License-Identifier: MIT
#pragma once
// --arm: where the chain of an arm comes from, as it is typed.

#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/arm/joint_matching.hpp"

namespace ripplenotch {

/// For help: what an --arm may be.
inline constexpr std::string_view arm_option_help =
    "rigid bodies of the whole arm: urdf,file=FILE[,tip=LINK], mjcf,file=FILE[,tip=BODY], mdh,file=FILE, "
    "dh,file=FILE, or axes,word=zyyzyz (which way each axis points); each with [,gravity=0:0:-9.81] and "
    "[,joints=NAME:NAME IN THE LOG|NAME:=0deg]";

struct ArmOption {
    Chain chain;          ///< without joints that are kept still
    StatedJoints stated;  ///< partners in the log
    std::string words;    ///< as it would be typed again
    std::optional<std::string> file = {};
};

/// Reads the file that the words name. Throws UsageError for the words, what the readers of chains throw for
/// the file.
[[nodiscard]] ArmOption read_arm_option(std::string_view words);

}  // namespace ripplenotch
