// SPDX-License-Identifier: MIT
#include "arm/chain/chain.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

namespace space {

Rotation about(const Vector3& axis, double angle_deg) {
    const Rotation k = crossing(axis), square = times(k, k);
    const double sine = portable::sin_degrees(angle_deg), versed = 1.0 - portable::cos_degrees(angle_deg);
    Rotation turned = unturned;
    for (std::size_t i = 0; i < 9; ++i) turned[i] += sine * k[i] + versed * square[i];
    return turned;
}

Rotation of_quaternion(const std::array<double, 4>& wxyz) {
    const double largest =
        std::max({std::abs(wxyz[0]), std::abs(wxyz[1]), std::abs(wxyz[2]), std::abs(wxyz[3])});
    const double w = wxyz[0] / largest, x = wxyz[1] / largest, y = wxyz[2] / largest, z = wxyz[3] / largest;
    const double s = 2.0 / (w * w + x * x + y * y + z * z);
    return {1 - s * (y * y + z * z), s * (x * y - w * z),     s * (x * z + w * y),
            s * (x * y + w * z),     1 - s * (x * x + z * z), s * (y * z - w * x),
            s * (x * z - w * y),     s * (y * z + w * x),     1 - s * (x * x + y * y)};
}

}  // namespace space

Rotation rotation_of_rpy(const Vector3& rpy_deg) {
    using space::about, space::times;
    return times(about({0, 0, 1}, rpy_deg[2]),
                 times(about({0, 1, 0}, rpy_deg[1]), about({1, 0, 0}, rpy_deg[0])));
}

Vector3 rpy_of_rotation(const Rotation& r) {
    constexpr double degrees = 180.0 / std::numbers::pi;
    const double level = std::sqrt(r[0] * r[0] + r[3] * r[3]);
    const double pitch = portable::atan2(-r[6], level);
    // Straight up or down, roll and yaw turn about the same axis; all of it is called yaw.
    if (level < 1e-12) return {0.0, degrees * pitch, degrees * portable::atan2(-r[1], r[4])};
    return {degrees * portable::atan2(r[7], r[8]), degrees * pitch, degrees * portable::atan2(r[3], r[0])};
}

namespace {

template <std::size_t n>
bool finite(const std::array<double, n>& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double number) { return std::isfinite(number); });
}

void settle(const std::string& source, ChainJoint& joint) {
    for (const double length_m : joint.origin_m) {
        if (std::abs(length_m) <= longest_link_m) continue;
        raise<DataError>("{}: joint '{}' is {} m from the joint before; lengths are in metres, up to {} m",
                         source, joint.name, shortest(length_m), shortest(longest_link_m));
    }
    if (!finite(joint.rotation))
        raise<DataError>("{}: the orientation of joint '{}' is not finite", source, joint.name);
    const double length = portable::hypot(joint.axis[0], joint.axis[1], joint.axis[2]);
    if (!std::isfinite(length) || !(length > 1e-9)) {
        raise<DataError>("{}: the axis of joint '{}' is {} {} {}, which has no direction", source, joint.name,
                         shortest(joint.axis[0]), shortest(joint.axis[1]), shortest(joint.axis[2]));
    }
    for (double& component : joint.axis) component /= length;
    const bool limited = joint.limits && std::isfinite(joint.limits->first) &&
                         std::isfinite(joint.limits->second) && joint.limits->first < joint.limits->second;
    if (!limited) joint.limits.reset();
}

}  // namespace

std::optional<std::size_t> Chain::find(std::string_view name) const {
    const auto found = std::find_if(joints.begin(), joints.end(),
                                    [&](const ChainJoint& joint) { return joint.name == name; });
    if (found == joints.end()) return std::nullopt;
    return static_cast<std::size_t>(found - joints.begin());
}

void settle_chain(Chain& chain) {
    if (chain.joints.empty()) raise<DataError>("{}: no joint moves, revolute or prismatic", chain.source);
    if (chain.size() > max_chain_joints) {
        raise<DataError>("{}: {} moving joints from base to tip, at most {} are understood", chain.source,
                         chain.size(), max_chain_joints);
    }
    std::set<std::string> names;
    for (ChainJoint& joint : chain.joints) {
        if (!names.insert(joint.name).second)
            raise<DataError>("{}: two joints are named '{}'", chain.source, joint.name);
        settle(chain.source, joint);
    }
    const auto& g = chain.gravity_m_s2;
    if (!finite(g) || !(portable::hypot(g[0], g[1], g[2]) < 1000.0)) {
        raise<DataError>("{}: gravity is {} {} {} m/s2; expected something like 0 0 -9.81", chain.source,
                         shortest(g[0]), shortest(g[1]), shortest(g[2]));
    }
}

Chain hold_joint(const Chain& chain, std::string_view name, double position) {
    const auto place = chain.find(name);
    if (!place) {
        std::vector<std::string> names;
        for (const ChainJoint& joint : chain.joints) names.push_back(joint.name);
        raise<UsageError>("arm: '{}' is no joint of {}; {}{}", name, chain.source, joint_list(chain),
                          did_you_mean(name, names));
    }
    if (chain.size() == 1)
        raise<UsageError>("arm: {} has no moving joint but '{}', which is kept still", chain.source, name);
    const ChainJoint& still = chain.joints[*place];
    space::Frame fixed{still.origin_m, still.rotation};
    fixed = space::times(fixed, still.kind == JointKind::revolute
                                    ? space::Frame{{}, space::about(still.axis, position)}
                                    : space::Frame{space::operator*(position, still.axis), space::unturned});
    Chain rest = chain;
    rest.joints.erase(rest.joints.begin() + static_cast<std::ptrdiff_t>(*place));
    if (*place < rest.size()) {
        ChainJoint& next = rest.joints[*place];
        const space::Frame moved = space::times(fixed, {next.origin_m, next.rotation});
        next.origin_m = moved.origin_m;
        next.rotation = moved.rotation;
    }
    return rest;
}

std::string joint_list(const Chain& chain) {
    std::vector<std::string> names;
    for (const ChainJoint& joint : chain.joints) names.push_back(joint.name);
    return fmt::format("moving joints: {}", fmt::join(names, ", "));
}

}  // namespace ripplenotch
