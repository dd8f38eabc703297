// SPDX-License-Identifier: MIT
#pragma once
// How the joints of an arm follow one another, from its base to its tip. No masses: those are determined from
// a log (arm_fit.hpp).

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ripplenotch {

using Vector3 = std::array<double, 3>;
/// Row after row; turns a vector of the inner frame into the outer one.
using Rotation = std::array<double, 9>;

/// Turns about x, then y, then z of the outer frame, as URDF's roll, pitch and yaw.
[[nodiscard]] Rotation rotation_of_rpy(const Vector3& rpy_deg);
/// The same back, with the pitch in [-90, 90] deg.
[[nodiscard]] Vector3 rpy_of_rotation(const Rotation& rotation);

enum class JointKind { revolute, prismatic };

/// One moving joint. Its link's frame lies at `origin_m`, turned by `rotation`, in the frame of the link
/// before, and moves along or about `axis`, a unit vector in its own frame.
struct ChainJoint {
    std::string name;
    JointKind kind = JointKind::revolute;
    Vector3 origin_m{};
    Rotation rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
    Vector3 axis{0, 0, 1};
    std::optional<std::pair<double, double>> limits = {};  ///< in deg; of a prismatic joint in m
};

struct Chain {
    std::string source;  ///< for messages: a file, "axes zyyzyz"
    std::vector<ChainJoint> joints;
    Vector3 gravity_m_s2{0, 0, -9.81};  ///< in the frame of the base
    bool lengths_are_guessed = false;   ///< only the directions of the axes are known

    [[nodiscard]] std::size_t size() const { return joints.size(); }
    [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;
};

inline constexpr std::size_t max_chain_joints = 20;  ///< chosen, not derived
/// Lengths beyond are no arm's: a file in millimetres is read as metres.
inline constexpr double longest_link_m = 100.0;

/// Makes the axes unit vectors. Throws DataError, naming the source and the joint: no joints or too many, an
/// axis without a direction, a number that is not finite or out of range, a repeated name.
void settle_chain(Chain& chain);

/// The chain with one joint kept still at `position` (deg; of a prismatic joint m), and so no joint any more.
/// Throws UsageError where there is no such joint, or no other.
[[nodiscard]] Chain hold_joint(const Chain& chain, std::string_view name, double position);

/// "the joints of robot.urdf are a, b, c": all that move, for messages.
[[nodiscard]] std::string joint_list(const Chain& chain);

// The sources of a chain: the robot's description, a table of its manual, or inspection of the robot. Each
// takes the text of a file and its name for messages, and throws DataError with file and line where that is
// none, UsageError where a choice is left to the user.

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

// Which joint of a log is which of an arm, by their names alone, and how far each goes.

struct ArmFit;
struct ArmLog;

/// "panda_joint1" of the chain is "1" of the log.
using StatedJoints = std::vector<std::pair<std::string, std::string>>;

struct JointMatch {
    std::vector<std::size_t> of;  ///< for each joint of the chain, the place of its joint in the log
    std::string rule;             ///< "as stated", "by name", "by number", "by order"
    std::string option;           ///< option to force it: "joints=panda_joint1:1|panda_joint2:2"
    std::vector<std::string> warnings, notes;  ///< a sentence each
};

/// Joints that are stated first; then, for all the others, the first of these that finds one for each and no
/// two the same: the same name without case, '_', '-' and the words joint, axis, link, robot; the number at
/// the end of both names, the log's counted from 0 or 1; the order, where there are as many. Throws
/// UsageError that names the joint without a partner and the joints of the log.
[[nodiscard]] JointMatch match_joints(const Chain& chain, std::span<const std::string> log_joints,
                                      const StatedJoints& stated, std::string_view log_name);

// How far each joint of an arm goes in a log, and whether it can go there.

/// Below this travel, a link's inertia cannot be distinguished from the next one's.
inline constexpr double min_travel_deg = 5.0;

struct JointTravel {
    std::string name;       ///< in the chain
    std::string log;        ///< in the log
    double travel_deg = 0;  ///< from its least to its greatest position; of a prismatic joint m
};

/// `log_joints`: the joints' names in the log, in the order of the chain. Throws DataError where a position
/// is so far out of the chain's limits, so often, that its unit must be another one.
[[nodiscard]] std::vector<JointTravel> arm_travel(const Chain& chain, const ArmLog& log,
                                                  const std::vector<std::string>& log_joints);

/// Why the log determines fewer values of the arm than another one could; or nothing.
[[nodiscard]] std::vector<std::string> arm_warnings(const ArmFit& fit,
                                                    const std::vector<JointTravel>& travel);

}  // namespace ripplenotch
