// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/arm/chain.hpp"

namespace ripplenotch::space {

// Vectors and rotations of space.

inline constexpr Rotation unturned{1, 0, 0, 0, 1, 0, 0, 0, 1};

/// A frame in another one.
struct Frame {
    Vector3 origin_m{};
    Rotation rotation = unturned;
};

inline Vector3 operator+(const Vector3& a, const Vector3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector3 operator*(double factor, const Vector3& a) {
    return {factor * a[0], factor * a[1], factor * a[2]};
}
inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// From the inner frame into the outer one.
inline Vector3 outward(const Rotation& r, const Vector3& v) {
    return {r[0] * v[0] + r[1] * v[1] + r[2] * v[2], r[3] * v[0] + r[4] * v[1] + r[5] * v[2],
            r[6] * v[0] + r[7] * v[1] + r[8] * v[2]};
}
/// From the outer frame into the inner one.
inline Vector3 inward(const Rotation& r, const Vector3& v) {
    return {r[0] * v[0] + r[3] * v[1] + r[6] * v[2], r[1] * v[0] + r[4] * v[1] + r[7] * v[2],
            r[2] * v[0] + r[5] * v[1] + r[8] * v[2]};
}
inline Rotation times(const Rotation& a, const Rotation& b) {
    Rotation product{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            product[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
    return product;
}
/// The matrix whose product with a vector is the cross product.
inline Rotation crossing(const Vector3& v) { return {0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0}; }
inline Frame times(const Frame& a, const Frame& b) {
    return {a.origin_m + outward(a.rotation, b.origin_m), times(a.rotation, b.rotation)};
}

/// By an angle about a unit vector.
[[nodiscard]] Rotation about(const Vector3& axis, double angle_deg);
/// Rotation of a quaternion w x y z of any length above 0.
[[nodiscard]] Rotation of_quaternion(const std::array<double, 4>& wxyz);

}  // namespace ripplenotch::space
