// SPDX-License-Identifier: MIT
// The joints of a URDF robot description; masses, shapes and all else are ignored.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "arm/chain/chain.hpp"
#include "arm/readers/xml_tree.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;
constexpr std::array known_types = {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};

struct UrdfJoint {
    const XmlElement* element;
    std::string name, type;
    [[nodiscard]] bool moves() const { return type != "fixed"; }
};

const XmlElement* find_macro(const XmlElement& element) {
    if (element.name.starts_with("xacro:")) return &element;
    for (const XmlElement& child : element.children) {
        if (const XmlElement* const found = find_macro(child)) return found;
    }
    return nullptr;
}

void refuse_macros(const std::string& source, const XmlElement& robot) {
    const XmlElement* const macro = find_macro(robot);
    if (macro == nullptr) return;
    const bool named = source.ends_with(".xacro");
    const std::string target = named ? source.substr(0, source.size() - 6) : source + ".urdf";
    raise<UsageError>("arm: {} holds macros ({}, line {}); expand it first: xacro {} > {}", source,
                      macro->name, macro->line, source, target);
}

class Urdf {
  public:
    Urdf(const std::string& source, const XmlElement& robot) : source_(source) {
        for (const XmlElement& element : robot.children)
            if (element.name == "joint") add(element);
    }

    [[nodiscard]] Chain chain(const std::optional<std::string>& tip) const {
        Chain chain{.source = source_, .joints = {}};
        space::Frame fixed;
        for (const std::size_t link : way_to_tip(source_, tree_, tip, "link")) {
            if (!joints_[link]) continue;
            const UrdfJoint& joint = *joints_[link];
            fixed = space::times(fixed, origin(*joint.element));
            if (!joint.moves()) continue;
            chain.joints.push_back(moving(joint, fixed));
            fixed = {};
        }
        return chain;
    }

  private:
    std::size_t link(const std::string& name) {
        const auto [found, is_new] = places_.emplace(name, tree_.names.size());
        if (is_new) {
            tree_.names.push_back(name);
            tree_.parent.emplace_back();
            tree_.moves.push_back(false);
            joints_.emplace_back();
        }
        return found->second;
    }

    std::string end_of(const XmlElement& joint, const std::string& name, const char* which) const {
        const XmlElement* const element = joint.child(which);
        if (element == nullptr)
            raise<DataError>("{}:{}: joint '{}' has no {}", source_, joint.line, name, which);
        return name_of(source_, *element, "link");
    }

    void add(const XmlElement& element) {
        UrdfJoint joint{&element, name_of(source_, element, "name"), name_of(source_, element, "type")};
        if (std::find(known_types.begin(), known_types.end(), joint.type) == known_types.end()) {
            raise<DataError>(
                "{}:{}: joint '{}' is of type '{}', expected revolute, continuous, prismatic or fixed",
                source_, element.line, joint.name, joint.type);
        }
        const std::size_t parent = link(end_of(element, joint.name, "parent"));
        const std::size_t child = link(end_of(element, joint.name, "child"));
        if (joints_[child]) {
            raise<DataError>("{}:{}: link '{}' hangs on two joints, '{}' and '{}'", source_, element.line,
                             tree_.names[child], joints_[child]->name, joint.name);
        }
        tree_.parent[child] = parent;
        tree_.moves[child] = joint.moves();
        joints_[child] = std::move(joint);
    }

    [[nodiscard]] space::Frame origin(const XmlElement& joint) const {
        const XmlElement* const element = joint.child("origin");
        if (element == nullptr) return {};
        Vector3 rpy = vector_of(source_, *element, "rpy", {});
        for (double& angle : rpy) angle *= degrees;
        return {vector_of(source_, *element, "xyz", {}), rotation_of_rpy(rpy)};
    }

    [[nodiscard]] ChainJoint moving(const UrdfJoint& joint, const space::Frame& fixed) const {
        const XmlElement& element = *joint.element;
        if (joint.type == "floating" || joint.type == "planar") {
            raise<UsageError>(
                "arm: {}:{}: joint '{}' is {}; only revolute, continuous and prismatic joints are understood "
                "on the way to the tip",
                source_, element.line, joint.name, joint.type);
        }
        if (const XmlElement* const mimic = element.child("mimic")) {
            raise<UsageError>(
                "arm: {}:{}: joint '{}' follows another one (mimic {}), which is not understood; end the "
                "chain before it with tip={}",
                source_, element.line, joint.name, mimic->attribute("joint").value_or(""),
                end_of(element, joint.name, "parent"));
        }
        ChainJoint found{joint.name, JointKind::revolute, fixed.origin_m, fixed.rotation, {1, 0, 0}};
        if (const XmlElement* const axis = element.child("axis"))
            found.axis = vector_of(source_, *axis, "xyz", {1, 0, 0});
        const bool slides = joint.type == "prismatic";
        if (slides) found.kind = JointKind::prismatic;
        const XmlElement* const limit = element.child("limit");
        if (limit == nullptr || joint.type == "continuous") return found;
        const auto lower = numbers_of(source_, *limit, "lower", 1),
                   upper = numbers_of(source_, *limit, "upper", 1);
        const double unit = slides ? 1.0 : degrees;
        found.limits.emplace(unit * (lower ? lower->front() : 0.0), unit * (upper ? upper->front() : 0.0));
        return found;
    }

    const std::string& source_;
    std::map<std::string, std::size_t> places_;
    LinkTree tree_;
    std::vector<std::optional<UrdfJoint>> joints_;  ///< above each link
};

}  // namespace

Chain chain_of_urdf(const std::string& source, std::string_view text, const std::optional<std::string>& tip) {
    const XmlElement robot = parse_xml(source, text);
    if (robot.name != "robot") {
        raise<DataError>("{}:{}: the document is a '{}', expected a 'robot'{}", source, robot.line,
                         robot.name, robot.name == "mujoco" ? "; that is --arm mjcf,file=..." : "");
    }
    refuse_macros(source, robot);
    Chain chain = Urdf(source, robot).chain(tip);
    settle_chain(chain);
    return chain;
}

}  // namespace ripplenotch
