// SPDX-License-Identifier: MIT
#pragma once
// The five ways in which MuJoCo's description writes an orientation.

#include <string>

#include "arm/chain/space.hpp"
#include "arm/readers/xml_tree.hpp"

namespace ripplenotch {

/// What <compiler> says for the whole document.
struct MjcfAngles {
    double unit_deg = 1.0;         ///< of an angle in the file
    std::string sequence = "xyz";  ///< of three Euler angles; capitals turn about axes that stay
};

/// quat, euler, axisangle, xyaxes or zaxis of an element; unturned where there is none. Throws DataError.
[[nodiscard]] Rotation mjcf_turn(const std::string& source, const XmlElement& element,
                                 const MjcfAngles& angles);

}  // namespace ripplenotch
