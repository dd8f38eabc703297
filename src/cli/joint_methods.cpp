// SPDX-License-Identifier: MIT
#include "cli/joint_methods.hpp"

#include <algorithm>
#include <utility>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

bool names_joint(std::string_view text) { return text.find(joint_mark) != std::string_view::npos; }

std::string with_joint(std::string text, const std::string& joint) {
    std::string name = joint;
    std::replace(name.begin(), name.end(), '/', '_');
    for (std::size_t at = text.find(joint_mark); at != std::string::npos;
         at = text.find(joint_mark, at + name.size()))
        text.replace(at, joint_mark.size(), name);
    return text;
}

JointMethods::JointMethods(MethodRequest request) : request_(std::move(request)) {
    const bool each = names_joint(request_.method) || names_joint(request_.table.value_or("")) ||
                      names_joint(request_.joint_file.value_or(""));
    if (!each) common_ = choose("");
}

std::shared_ptr<const JointMethod> JointMethods::of(const std::string& joint) {
    if (common_) return common_;
    if (joint.empty()) {
        raise<UsageError>("{} stands for a joint's name, and the joint of this log has none; name the file",
                          joint_mark);
    }
    return choose(joint);
}

std::shared_ptr<const JointMethod> JointMethods::choose(const std::string& joint) const {
    const auto named = [&joint](const std::optional<std::string>& text) {
        return text ? std::optional(with_joint(*text, joint)) : std::nullopt;
    };
    JointMethod method;
    method.joint_file = named(request_.joint_file);
    method.chosen = choose_method(with_joint(request_.method, joint), named(request_.table),
                                  {request_.gear_ratio, request_.orders, method.joint_file});
    method.gear = gear_of(method.joint_file, request_.gear_ratio, request_.orders, method.chosen);
    if (request_.needs_gear && !method.gear.ratio) {
        raise<UsageError>(
            "--min-attenuation-db needs to know where the ripple is; give --gear-ratio and --orders, or "
            "--joint-file");
    }
    return std::make_shared<const JointMethod>(std::move(method));
}

bool JointMethods::learns() const {
    return find_method(std::string_view(request_.method).substr(0, request_.method.find(','))).learner !=
           nullptr;
}

}  // namespace ripplenotch
