// SPDX-License-Identifier: MIT
#pragma once
// Commands that read one joint at a time, on logs that hold several.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

/// The joints of the log that `log` asks for (--joint), all where it asks for none; empty for what can be
/// read once only, a pipe. Throws what open_log throws.
[[nodiscard]] AskedJoints joints_asked_for(const std::string& path, const ReadOptions& log);

/// Whether --joint says more than one joint: "all", a list or a range. Throws the same.
[[nodiscard]] bool asks_for_several(const std::string& path, const ReadOptions& log);

/// What a command on one log is asked, except its own options.
struct LogRequest {
    CommonOptions common;
    ReadOptions log;
    std::string path;
    GearOptions gear;
    std::optional<std::string> joint = {};  ///< the one of several that this is about

    /// What is asked of one joint: its name stands for {joint} in the names of files. `name` is empty for a
    /// log that is read as it is.
    void take_joint(const std::optional<std::string>& name, const CommonOptions& of_joint);
};

/// "wide.csv, joint j4": for the title of a figure.
[[nodiscard]] std::string joint_in_words(const std::string& path, const std::string& joint);

/// Asks `one` about each joint that is asked for, all where none is: one list as JSON, one CSV with a column
/// `joint`, or one text below the other. `one` takes the joint and the options that go with it, or none where
/// the log has one joint: then its answer is the answer. A joint of which it throws Error is left out with a
/// warning; where none is left, the error of the first is thrown. `documents`: kind of the document that
/// lists those of all joints, "spectra". The exit code is the lowest that is not ExitCode::done.
[[nodiscard]] Answer ask_each_joint(
    const LogRequest& request, std::string_view documents,
    const std::function<Answer(const std::optional<std::string>& joint, const CommonOptions& common)>& one);

/// The same with the request of each joint.
template <class Request, class One>
[[nodiscard]] Answer ask_joints(const Request& request, std::string_view documents, const One& one) {
    return ask_each_joint(request, documents, [&](const auto& joint, const CommonOptions& common) {
        Request of_joint = request;
        of_joint.take_joint(joint, common);
        return one(of_joint);
    });
}

/// A result about a torque in this unit (Recording::torque_unit), in which the library says "Nm": a report
/// with "A" in its place, where that is the unit, or the verdict of a document.
[[nodiscard]] std::string in_torque_unit(std::string text, const std::string& unit);

/// "joint j4 is left out: it has no torque", once for each reason.
void say_left_out(const CommonOptions& common, const std::vector<LeftOutJoint>& joints);

}  // namespace ripplenotch
