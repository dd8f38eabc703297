// SPDX-License-Identifier: MIT
// The bodies and joints of MuJoCo's description; masses, shapes, actuators and all else are not looked at.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "arm/readers/branches.hpp"
#include "arm/readers/mjcf_turns.hpp"
#include "ripplenotch/arm/chain_files.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

using Attributes = std::vector<std::pair<std::string, std::string>>;

// What <default> says of joints, by class; each class begins with what its parent says.
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

    // The joint with what its class says of it and it does not say itself.
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
