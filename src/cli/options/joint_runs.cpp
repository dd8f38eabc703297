// SPDX-License-Identifier: MIT
#include "cli/options/joint_runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <utility>
#include <vector>

#include "cli/talk.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

namespace {

// A named pipe and a device are emptied by whoever reads them first.
bool can_be_read_again(const std::string& path) {
    std::error_code unknown;
    const auto status = std::filesystem::status(path, unknown);
    return !path.empty() && path != "-" && !is_fifo(status) && !is_character_file(status) &&
           !is_socket(status);
}

}  // namespace

AskedJoints joints_asked_for(const std::string& path, const ReadOptions& log) {
    if (!can_be_read_again(path)) return {};
    ReadOptions options = log;
    options.takes_motor_units = true;
    return asked_joints(Spool(path), options);
}

bool asks_for_several(const std::string& path, const ReadOptions& log) {
    if (!log.joint) return false;
    if (*log.joint == "all") return true;
    if (log.joint->find_first_of(",-") == std::string::npos) return false;
    if (!can_be_read_again(path)) return log.joint->find(',') != std::string::npos;
    return joints_asked_for(path, log).names.size() > 1;
}

void LogRequest::take_joint(const std::optional<std::string>& name, const CommonOptions& of_joint) {
    common = of_joint;
    if (!name) return;
    joint = log.joint = name;
    if (gear.joint_file) gear.joint_file = with_joint(*gear.joint_file, *joint);
}

std::string joint_in_words(const std::string& path, const std::string& joint) {
    return joint.empty() ? path : path + ", joint " + joint;
}

void say_left_out(const CommonOptions& common, const std::vector<LeftOutJoint>& joints) {
    std::vector<std::pair<std::string, std::vector<std::string>>> by_reason;
    for (const LeftOutJoint& one : joints) {
        auto same = std::find_if(by_reason.begin(), by_reason.end(),
                                 [&](const auto& known) { return known.first == one.why; });
        if (same == by_reason.end()) same = by_reason.insert(same, {one.why, {}});
        same->second.push_back(one.joint);
    }
    for (const auto& [why, names] : by_reason)
        warn(common, fmt::format("{} {} left out: {}", joints_in_words(names),
                                 names.size() == 1 ? "is" : "are", why));
}

std::string in_torque_unit(std::string text, const std::string& unit) {
    constexpr std::string_view written = "Nm", verdict = "\"verdict\": ";
    if (unit == written) return text;
    const bool is_document = text.starts_with('{');
    for (std::size_t at = text.find(written); at != std::string::npos; at = text.find(written, at + 1)) {
        // Of a document the other texts are names of fields and options.
        const std::size_t line = text.rfind('\n', at) + 1;
        const bool is_said =
            !is_document || text.compare(text.find_first_not_of(' ', line), verdict.size(), verdict) == 0;
        const char before = at > 0 ? text[at - 1] : ' ';
        const std::string_view after = std::string_view(text).substr(at + written.size());
        const bool is_unit = std::string_view(" \n(").find(before) != std::string_view::npos &&
                             !after.starts_with("/A") &&
                             (after.empty() || std::isalnum(static_cast<unsigned char>(after.front())) == 0);
        if (!is_said || !is_unit) continue;
        text.replace(at, written.size(), unit);
        // Columns of a table keep their places.
        const std::size_t gap = text.rfind("  ", at);
        if (!is_document && gap != std::string::npos && gap >= line)
            text.insert(gap, written.size() - std::min(unit.size(), written.size()), ' ');
    }
    return text;
}

namespace {

void check_several(const LogRequest& request, const std::vector<std::string>& joints) {
    const auto& columns = request.log.columns;
    const auto is_of_joint = [](const std::string& entry) { return !entry.starts_with("time"); };
    if (std::any_of(columns.begin(), columns.end(), is_of_joint))
        raise<UsageError>(
            "--columns names columns of one joint, and {} are asked for ({}); select one with --joint",
            joints.size(), fmt::join(joints, ", "));
    if (request.common.plot && !names_joint(*request.common.plot))
        raise<UsageError>(
            "--plot {}: a picture shows one joint, and {} are asked for ({}); select one with --joint, or "
            "put {} into the name",
            *request.common.plot, joints.size(), fmt::join(joints, ", "), joint_mark);
}

/// "wide.csv" and "a,b" with quotes where CSV needs them.
std::string csv_cell(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string cell = "\"";
    for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
    return cell + '"';
}

std::string with_joint_column(const std::vector<Answer>& joints) {
    std::string whole;
    for (const Answer& one : joints) {
        std::string_view text = one.text;
        const std::string cell = csv_cell(one.joint);
        for (bool header = true; !text.empty(); header = false) {
            const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
            if (!header || &one == joints.data()) {
                whole += header ? "joint" : cell;
                whole += ',';
                whole += text.substr(0, end);
            }
            text.remove_prefix(end);
        }
    }
    return whole;
}

Answer of_all(std::vector<Answer> joints, std::string_view documents) {
    Answer all;
    all.kind = joints.front().kind;
    if (all.kind == Answer::Text::rows)
        all.text = with_joint_column(joints);
    else
        all.text = joined(joints, "\n", [](const Answer& one) { return one.joint + ": " + one.text; });
    for (const Answer& one : joints)
        if (one.code != ExitCode::done)
            all.code = all.code == ExitCode::done ? one.code : std::min(all.code, one.code);
    all.joints = std::move(joints);
    std::vector<std::pair<std::string, std::function<std::string()>>> each;
    for (Answer& one : all.joints) {
        const auto shared = std::make_shared<const std::function<std::string()>>(std::move(one.document));
        one.document = [shared] { return (*shared)(); };
        each.emplace_back(one.joint, one.document);
    }
    all.document = [each, documents] {
        std::vector<JointDocument> texts;
        for (const auto& [joint, document] : each) texts.push_back({joint, document()});
        return joint_documents_text(documents, texts);
    };
    return all;
}

}  // namespace

Answer ask_each_joint(
    const LogRequest& request, std::string_view documents,
    const std::function<Answer(const std::optional<std::string>& joint, const CommonOptions& common)>& one) {
    CommonOptions common = request.common;
    if (!can_be_read_again(request.path) && asks_for_several(request.path, request.log))
        raise<UsageError>("--joint {}: standard input can be read once only; give a file",
                          *request.log.joint);
    const AskedJoints asked = joints_asked_for(request.path, request.log);
    const bool several = asked.names.size() + asked.left_out.size() > 1 && request.log.joint;
    if (several || asked.names.size() > 1) say_left_out(common, asked.left_out);
    // Where others are left out, the name says which is meant.
    if (asked.names.size() < 2) {
        Answer answer = one(several ? std::optional(asked.names.front()) : std::nullopt, common);
        if (!asked.names.empty()) answer.joint = asked.names.front();
        return answer;
    }
    check_several(request, asked.names);
    std::vector<Answer> joints;
    std::vector<LeftOutJoint> left_out;
    std::exception_ptr first_error;
    common.messages = std::make_shared<JointMessages>();
    for (const std::string& joint : asked.names) {
        common.joint = joint;
        try {
            joints.push_back(one(joint, common));
            joints.back().joint = joint;
        } catch (const Error& error) {
            if (!first_error) first_error = std::current_exception();
            left_out.push_back({joint, error.what()});
        }
    }
    common.messages->say_all(asked.names.size());
    if (joints.empty()) std::rethrow_exception(first_error);
    say_left_out(request.common, left_out);
    return of_all(std::move(joints), documents);
}

}  // namespace ripplenotch
