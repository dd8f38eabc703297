// SPDX-License-Identifier: MIT
#include "arm/chain/space.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/portable_math.hpp"

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

}  // namespace ripplenotch
