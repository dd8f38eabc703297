// SPDX-License-Identifier: MIT
#include "arm/readers/mjcf_turns.hpp"

#include <cctype>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using namespace space;

class Turn {
  public:
    Turn(const std::string& source, const XmlElement& element) : source_(source), element_(element) {}

    Rotation quaternion(const std::vector<double>& q) const {
        if (!(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > 1e-200)) no_direction("quat");
        return of_quaternion({q[0], q[1], q[2], q[3]});
    }

    Rotation euler(const std::vector<double>& turns, const MjcfAngles& angles) const {
        Rotation all = unturned;
        for (std::size_t k = 0; k < 3; ++k) {
            const char letter = angles.sequence[k];
            const int axis = std::tolower(static_cast<unsigned char>(letter)) - 'x';
            Vector3 direction{};
            direction[static_cast<std::size_t>(axis)] = 1.0;
            const Rotation one = about(direction, angles.unit_deg * turns[k]);
            all = letter < 'a' ? times(one, all) : times(all, one);
        }
        return all;
    }

    Rotation axis_angle(const std::vector<double>& v, const MjcfAngles& angles) const {
        return about(direction({v[0], v[1], v[2]}, "axisangle"), angles.unit_deg * v[3]);
    }

    Rotation from_x_and_y(const std::vector<double>& v) const {
        const Vector3 x = direction({v[0], v[1], v[2]}, "xyaxes"), rough{v[3], v[4], v[5]};
        const Vector3 y = direction(rough + (-dot(x, rough)) * x, "xyaxes"), z = cross(x, y);
        return {x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]};
    }

    // The shortest way from the z axis.
    Rotation from_z(const std::vector<double>& v) const {
        const Vector3 z = direction({v[0], v[1], v[2]}, "zaxis");
        const double side = portable::hypot(z[0], z[1]);
        if (side < 1e-12) return z[2] > 0.0 ? unturned : about({1, 0, 0}, 180.0);
        return about({-z[1] / side, z[0] / side, 0.0},
                     180.0 / std::numbers::pi * portable::atan2(side, z[2]));
    }

  private:
    Vector3 direction(const Vector3& v, const char* attribute) const {
        const double length = portable::hypot(v[0], v[1], v[2]);
        if (!(length > 1e-9) || !std::isfinite(length)) no_direction(attribute);
        return (1.0 / length) * v;
    }
    [[noreturn]] void no_direction(const char* attribute) const {
        raise<DataError>("{}:{}: {} {}=\"{}\" has no direction", source_, element_.line, element_.name,
                         attribute, element_.attribute(attribute).value_or("").substr(0, 80));
    }

    const std::string& source_;
    const XmlElement& element_;
};

}  // namespace

Rotation mjcf_turn(const std::string& source, const XmlElement& element, const MjcfAngles& angles) {
    const Turn turn(source, element);
    const auto numbers = [&](const char* attribute, std::size_t count) {
        return numbers_of(source, element, attribute, count);
    };
    if (const auto quat = numbers("quat", 4)) return turn.quaternion(*quat);
    if (const auto euler = numbers("euler", 3)) return turn.euler(*euler, angles);
    if (const auto axis_angle = numbers("axisangle", 4)) return turn.axis_angle(*axis_angle, angles);
    if (const auto axes = numbers("xyaxes", 6)) return turn.from_x_and_y(*axes);
    if (const auto z = numbers("zaxis", 3)) return turn.from_z(*z);
    return unturned;
}

}  // namespace ripplenotch
