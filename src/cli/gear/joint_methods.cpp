// SPDX-License-Identifier: MIT
#include "cli/gear/joint_methods.hpp"

#include <algorithm>
#include <utility>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

bool names_joint(std::string_view text) { return text.find(joint_mark) != std::string_view::npos; }

std::string with_joint(std::string text, const std::string& joint) {
    if (joint.empty() && names_joint(text)) {
        raise<UsageError>("{} stands for a joint's name, and the joint of this log has none; name the file",
                          joint_mark);
    }
    std::string name = joint;
    std::replace(name.begin(), name.end(), '/', '_');
    for (std::size_t at = text.find(joint_mark); at != std::string::npos;
         at = text.find(joint_mark, at + name.size()))
        text.replace(at, joint_mark.size(), name);
    return text;
}

JointMethods::JointMethods(MethodRequest request) : request_(std::move(request)) {
    const bool each = names_joint(request_.method) || names_joint(request_.table.value_or("")) ||
                      names_joint(request_.gear.joint_file.value_or(""));
    if (!each) common_ = choose("");
}

std::shared_ptr<const Contender> JointMethods::of(const std::string& joint) const {
    if (common_) return common_;
    return choose(joint);
}

std::shared_ptr<const Contender> JointMethods::choose(const std::string& joint) const {
    const auto named = [&joint](const std::optional<std::string>& text) {
        return text ? std::optional(with_joint(*text, joint)) : std::nullopt;
    };
    GearOptions gear = request_.gear;
    gear.joint_file = named(gear.joint_file);
    Contender method =
        choose_method(with_joint(request_.method, joint), named(request_.table), GearChoice(gear));
    if (!method.gear && request_.needs_gear) raise_no_gear("--min-attenuation");
    if (!method.gear && !gear.orders.empty()) raise_no_gear("--orders");
    return std::make_shared<const Contender>(std::move(method));
}

std::optional<GearAccount> JointMethods::common_gear() const {
    return common_ ? common_->gear : std::nullopt;
}

const Method& JointMethods::method() const {
    return find_method(std::string_view(request_.method).substr(0, request_.method.find(',')));
}

bool JointMethods::learns() const { return method().learner != nullptr; }

bool JointMethods::follows_motion() const {
    return method().steady == nullptr && method().part != MethodPart::control;
}

}  // namespace ripplenotch
