// SPDX-License-Identifier: MIT
// The bodies and joints of a MuJoCo description; masses, shapes, actuators and all else are ignored.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "arm/chain/chain.hpp"
#include "arm/readers/xml_tree.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// The five ways in which MuJoCo's description writes an orientation.

/// The settings of <compiler> for the whole document.
struct MjcfAngles {
    double unit_deg = 1.0;         ///< unit of an angle in the file
    std::string sequence = "xyz";  ///< sequence of three Euler angles; capitals turn about axes that stay
};

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

// quat, euler, axisangle, xyaxes or zaxis of an element; unturned where there is none. Throws DataError.
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

using Attributes = std::vector<std::pair<std::string, std::string>>;

// The settings of <default> for joints, by class; each class inherits from its parent.
class JointDefaults {
  public:
    void read(const XmlElement& element, const Attributes& inherited) {
        Attributes own = inherited;
        if (const XmlElement* const joint = element.child("joint")) own = with(own, joint->attributes);
        const std::string name = element.attribute("class").value_or("main");
        classes_[name] = own;
        for (const XmlElement& child : element.children)
            if (child.name == "default") read(child, own);
    }

    // The joint with the settings of its class that it does not contain itself.
    [[nodiscard]] XmlElement completed(XmlElement joint, const std::string& class_around) const {
        const auto found = classes_.find(joint.attribute("class").value_or(class_around));
        if (found != classes_.end()) joint.attributes = with(found->second, joint.attributes);
        return joint;
    }

  private:
    static Attributes with(Attributes base, const Attributes& more) {
        for (const auto& one : more) {
            const auto same =
                std::find_if(base.begin(), base.end(), [&](const auto& a) { return a.first == one.first; });
            if (same == base.end())
                base.push_back(one);
            else
                same->second = one.second;
        }
        return base;
    }
    std::map<std::string, Attributes> classes_;
};

struct Body {
    const XmlElement* element;
    std::string class_around;
};

class Mjcf {
  public:
    Mjcf(const std::string& source, const XmlElement& root) : source_(source) {
        for (const XmlElement& element : root.children) {
            if (element.name == "compiler") read_compiler(element);
            if (element.name == "default") defaults_.read(element, {});
            if (element.name == "option") gravity_ = vector_of(source, element, "gravity", gravity_);
            refuse_what_brings_bodies(element);
        }
        for (const XmlElement& element : root.children)
            if (element.name == "worldbody") add_bodies(element, std::nullopt, "main");
        if (bodies_.empty()) raise<DataError>("{}: no body in the worldbody", source);
    }

    [[nodiscard]] Chain chain(const std::optional<std::string>& tip) const {
        Chain chain{.source = source_, .joints = {}, .gravity_m_s2 = gravity_};
        space::Frame fixed;
        for (const std::size_t place : way_to_tip(source_, tree_, tip, "body")) {
            const Body& body = bodies_[place];
            fixed = space::times(fixed, {vector_of(source_, *body.element, "pos", {}),
                                         mjcf_turn(source_, *body.element, angles_)});
            for (const XmlElement& element : body.element->children) {
                if (element.name == "freejoint") refuse(element, "free");
                if (element.name != "joint") continue;
                add_joint(defaults_.completed(element, body.class_around), tree_.names[place], fixed, chain);
            }
        }
        return chain;
    }

  private:
    void read_compiler(const XmlElement& element) {
        if (const auto angle = element.attribute("angle"))
            angles_.unit_deg = *angle == "radian" ? 180.0 / std::numbers::pi : 1.0;
        if (const auto sequence = element.attribute("eulerseq")) angles_.sequence = *sequence;
        if (angles_.sequence.size() == 3 && angles_.sequence.find_first_not_of("xyzXYZ") == std::string::npos)
            return;
        raise<DataError>("{}:{}: eulerseq is '{}', expected three of x y z X Y Z", source_, element.line,
                         angles_.sequence.substr(0, 20));
    }

    void refuse_what_brings_bodies(const XmlElement& element) const {
        for (const char* const name : {"include", "frame", "replicate", "attach"}) {
            if (element.name != name) continue;
            raise<UsageError>(
                "arm: {}:{}: '{}' is not understood; let MuJoCo write the model as one file first "
                "(mj_saveLastXML)",
                source_, element.line, name);
        }
    }

    void add_bodies(const XmlElement& around, std::optional<std::size_t> parent,
                    const std::string& class_around) {
        for (const XmlElement& element : around.children) {
            refuse_what_brings_bodies(element);
            if (element.name != "body") continue;
            const std::string own = element.attribute("childclass").value_or(class_around);
            const std::size_t place = bodies_.size();
            bodies_.push_back({&element, own});
            tree_.names.push_back(element.attribute("name").value_or(fmt::format("body {}", place + 1)));
            tree_.parent.push_back(parent);
            tree_.moves.push_back(element.child("joint") != nullptr || element.child("freejoint") != nullptr);
            add_bodies(element, place, own);
        }
    }

    [[noreturn]] void refuse(const XmlElement& joint, const std::string& type) const {
        raise<UsageError>(
            "arm: {}:{}: joint '{}' is {}; only hinge and slide joints are understood on the way to the tip",
            source_, joint.line, joint.attribute("name").value_or(""), type);
    }

    // `fixed` is the body in the link before; afterwards, in this joint's own link.
    void add_joint(const XmlElement& element, const std::string& body, space::Frame& fixed,
                   Chain& chain) const {
        const std::string type = element.attribute("type").value_or("hinge");
        if (type != "hinge" && type != "slide") refuse(element, type);
        const bool slides = type == "slide";
        const auto number = [&](const char* attribute) {
            const auto numbers = numbers_of(source_, element, attribute, 1);
            return numbers ? numbers->front() : 0.0;
        };
        const double unit = slides ? 1.0 : angles_.unit_deg;
        const Vector3 anchor_m = vector_of(source_, element, "pos", {});
        ChainJoint joint{element.attribute("name").value_or(body),
                         slides ? JointKind::prismatic : JointKind::revolute};
        joint.axis = vector_of(source_, element, "axis", {0, 0, 1});
        const space::Frame at = space::times(fixed, space::Frame{anchor_m, space::unturned});
        joint.origin_m = at.origin_m;
        joint.rotation = at.rotation;
        // The file shows the body where the joint stands at `ref`.
        Chain alone{.source = source_, .joints = {joint}};
        settle_chain(alone);
        joint.axis = alone.joints.front().axis;
        const double ref = unit * number("ref");
        if (slides)
            joint.origin_m = space::operator+(
                joint.origin_m, space::outward(joint.rotation, space::operator*(-ref, joint.axis)));
        else
            joint.rotation = space::times(joint.rotation, space::about(joint.axis, -ref));
        if (const auto range = numbers_of(source_, element, "range", 2))
            joint.limits.emplace(unit * (*range)[0], unit * (*range)[1]);
        chain.joints.push_back(joint);
        fixed = {space::operator*(-1.0, anchor_m), space::unturned};
    }

    const std::string& source_;
    MjcfAngles angles_;
    JointDefaults defaults_;
    Vector3 gravity_{0, 0, -9.81};
    std::vector<Body> bodies_;
    LinkTree tree_;
};

}  // namespace

Chain chain_of_mjcf(const std::string& source, std::string_view text, const std::optional<std::string>& tip) {
    const XmlElement root = parse_xml(source, text);
    if (root.name != "mujoco") {
        raise<DataError>("{}:{}: the document is a '{}', expected 'mujoco'{}", source, root.line, root.name,
                         root.name == "robot" ? "; that is --arm urdf,file=..." : "");
    }
    Chain chain = Mjcf(source, root).chain(tip);
    settle_chain(chain);
    return chain;
}

}  // namespace ripplenotch
