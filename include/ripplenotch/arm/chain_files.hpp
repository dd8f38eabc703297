// SPDX-License-Identifier: MIT
#pragma once
// The ways in which people have a chain: the robot's description, a table of its manual, or no more than a
// look at the robot. Each takes the text of a file and its name for messages, and throws DataError with file
// and line where that is none, UsageError where a choice is left to the user.

#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/arm/chain.hpp"

namespace ripplenotch {

/// A robot's description has links and joints, of which these elements and attributes count: robot, joint
/// {name, type}, parent, child, origin, axis, limit, mimic. Fixed joints become part of the next moving one.
/// `tip` is the link at which the chain ends; without it there must be one end.
[[nodiscard]] Chain chain_of_urdf(const std::string& source, std::string_view text,
                                  const std::optional<std::string>& tip);

/// MuJoCo's description: bodies within bodies, each with its joints: body {name, pos, quat, euler, axisangle,
/// xyaxes, zaxis, childclass}, joint {name, type, pos, axis, range, ref, class}, default, compiler {angle,
/// eulerseq}, option {gravity}.
[[nodiscard]] Chain chain_of_mjcf(const std::string& source, std::string_view text,
                                  const std::optional<std::string>& tip);

/// Denavit and Hartenberg's lengths and angles, a joint a row, with the header a_m,alpha_deg,d_m,theta_deg in
/// any order and, if one likes, joint: its name. `theta_deg` is added to the joint's angle. Standard: turn by
/// theta and shift by d along the joint's axis, then a and alpha (each row's frame is at the link's far end).
[[nodiscard]] Chain chain_of_dh(const std::string& source, std::string_view text);
/// Modified (Craig): a and alpha first, then theta and d.
[[nodiscard]] Chain chain_of_mdh(const std::string& source, std::string_view text);

/// A letter a joint, from the base: which way its axis points when all positions are 0, x, y, z or, the other
/// way, X, Y, Z. All links are taken as `length_m` along z.
[[nodiscard]] Chain chain_of_axes(std::string_view word, double length_m = 0.3);

/// The text of such a file. Throws FileError, and DataError beyond 16 MB, which no robot needs.
[[nodiscard]] std::string read_chain_file(const std::string& path);

}  // namespace ripplenotch
