// SPDX-License-Identifier: MIT
// A joint as a file of MuJoCo's of its own.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "export/joint/mjcf_elements.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double gravity_m_s2 = 9.81;
// MuJoCo needs some: what a model that states no inertia gets, and the body about its own centre.
constexpr double next_to_no_inertia_kgm2 = 1e-6, own_inertia_kgm2 = 1e-9;
// tanh(v / width) as a sum of parts, each share * clip(v / (wider * width), -1, 1): by squares over all
// speeds the nearest of two, 0.05 apart at most.
struct StepPart {
    double share, wider;
};
constexpr StepPart steep{0.5163, 0.8}, flat{0.4837, 1.95};
// The least impedance that MuJoCo takes: the constraint is soft then, and its force goes with the speed
// alone.
constexpr double softest = 1e-4;
constexpr double longest_step_s = 0.002, shortest_step_s = 1e-5;

// A point mass that weighs as the model says, with at most a quarter of its inertia.
struct PointMass {
    double mass_kg = 1.0, distance_m = 0.0;
    [[nodiscard]] double inertia_kgm2() const { return mass_kg * distance_m * distance_m; }
};

PointMass point_mass(const JointMjcf& mjcf, double inertia_kgm2) {
    const double first_moment = mjcf.weight_nm / gravity_m_s2;
    const double kg = std::max(1.0, 4.0 * first_moment * first_moment / inertia_kgm2);
    return {kg, first_moment / kg};
}

// The friction's force is -R^-1 (acceleration + B v), R = (1 - softest) / softest / inertia, held within
// frictionloss; direct values of solreffriction are multiples of B.
std::string friction_words(const JointMjcf& mjcf, const StepPart& part, double inertia_kgm2) {
    if (mjcf.frictionloss_nm <= 0.0) return "";
    const double nm = to_digits(part.share * mjcf.frictionloss_nm, 10);
    const double slope = nm / (part.wider * mjcf.friction_width_rad_s);
    const std::string soft = shortest(softest);
    return fmt::format(" frictionloss=\"{}\" solimpfriction=\"{} {} 0.001 0.5 2\" solreffriction=\"0 {}\"",
                       shortest(nm), soft, soft, shortest(-(1.0 - softest) * slope / inertia_kgm2));
}

// A joint has one frictionloss; a tendon round it alone has the other part.
std::string tendon_text(const JointMjcf& mjcf, std::string_view joint, double inertia_kgm2) {
    if (mjcf.frictionloss_nm <= 0.0) return "";
    return fmt::format(
        "  <tendon>\n    <fixed name=\"friction\"{}>\n      <joint joint=\"{}\" coef=\"1\"/>\n    </fixed>\n"
        "  </tendon>\n",
        friction_words(mjcf, flat, inertia_kgm2), xml_words(joint));
}

// A simulation forward in time needs a step below twice inertia over slope.
double time_step_s(const JointMjcf& mjcf, double inertia_kgm2) {
    if (mjcf.frictionloss_nm <= 0.0) return longest_step_s;
    const double steady = inertia_kgm2 * mjcf.friction_width_rad_s / mjcf.frictionloss_nm;
    return to_digits(std::clamp(steady, shortest_step_s, longest_step_s), 2);
}

}  // namespace

std::string write_mjcf(const JointMjcf& mjcf, std::string_view joint, std::span<const std::string> heading) {
    const double inertia = std::max(mjcf.inertia_kgm2, next_to_no_inertia_kgm2);
    const PointMass point = point_mass(mjcf, inertia);
    const double armature = inertia - point.inertia_kgm2() - own_inertia_kgm2;
    std::string words = fmt::format("armature=\"{}\"", shortest(armature));
    if (mjcf.damping != 0.0 || mjcf.quadratic_damping != 0.0)
        words += fmt::format(" damping=\"{}\"", damping_words(mjcf));
    words += friction_words(mjcf, steep, inertia);
    std::string text = mjcf_comment(mjcf, heading);
    text += fmt::format(
        "<mujoco>\n  <compiler angle=\"radian\"/>\n  <option timestep=\"{}\" gravity=\"0 0 -{}\"/>\n"
        "  <worldbody>\n    <body name=\"link\">\n"
        "      <inertial mass=\"{}\" pos=\"{} 0 {}\" diaginertia=\"{} {} {}\"/>\n"
        "      <joint name=\"{}\" type=\"hinge\" axis=\"0 -1 0\" {}/>\n    </body>\n  </worldbody>\n",
        shortest(time_step_s(mjcf, inertia)), shortest(gravity_m_s2), shortest(point.mass_kg),
        shortest(point.distance_m * portable::cos(mjcf.weight_rad)),
        shortest(point.distance_m * portable::sin(mjcf.weight_rad)), shortest(own_inertia_kgm2),
        shortest(own_inertia_kgm2), shortest(own_inertia_kgm2), xml_words(joint), words);
    text += tendon_text(mjcf, joint, inertia);
    const std::string motors = mjcf_motors(mjcf, joint, "");
    if (!motors.empty()) text += "  <actuator>\n" + motors + "  </actuator>\n";
    return text + "</mujoco>\n";
}

}  // namespace ripplenotch
