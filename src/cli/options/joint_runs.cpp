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

std::vector<double> read_column(const std::string& path, std::string column, const std::string& joint,
                                ReadOptions read, std::size_t most_rows) {
    if (const std::size_t at = column.find(joint_mark); at != std::string::npos)
        column.replace(at, joint_mark.size(), joint);
    // The column is read in the place of the torque.
    std::erase_if(read.columns, [](const std::string& entry) { return entry.starts_with("torque="); });
    read.columns.push_back("torque=" + column);
    read.units["torque"] = "Nm";
    read.scales.erase("torque");
    read.joint = joint.empty() ? std::nullopt : std::optional(joint);
    return read_log_in_part(path, read, most_rows).trace.torque_nm;
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
    if (plot.path) plot.path = with_joint(*plot.path, *joint);
    if (gear.joint_file) gear.joint_file = with_joint(*gear.joint_file, *joint);
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

/// What the joints that were gone over gave, and those that gave nothing.
struct JointResults {
    std::vector<std::string> joints;
    std::vector<JointResult> results;
    std::vector<LeftOutJoint> left_out;
    std::exception_ptr first_error;
    std::shared_ptr<JointMessages> messages;  ///< for what is said afterwards
};

void check_several(const LogRequest& request, const std::vector<std::string>& joints) {
    const auto& columns = request.log.columns;
    const auto is_of_joint = [](const std::string& entry) { return !entry.starts_with("time"); };
    if (std::any_of(columns.begin(), columns.end(), is_of_joint))
        raise<UsageError>(
            "--columns names columns of one joint, and {} are asked for ({}); select one with --joint",
            joints.size(), fmt::join(joints, ", "));
    if (request.plot.path && !names_joint(*request.plot.path))
        raise<UsageError>(
            "--plot {}: a picture shows one joint, and {} are asked for ({}); select one with --joint, or "
            "put {} into the name",
            *request.plot.path, joints.size(), fmt::join(joints, ", "), joint_mark);
}

template <class One>
JointResults go_over(const CommonOptions& asked, const std::vector<std::string>& joints, const One& one) {
    JointResults all;
    CommonOptions common = asked;
    common.messages = std::make_shared<JointMessages>();
    for (const std::string& joint : joints) {
        common.joint = joint;
        common.output = with_joint(asked.output, joint);
        try {
            all.results.push_back(one(joint, common));
            all.joints.push_back(joint);
        } catch (const Error& error) {
            if (!all.first_error) all.first_error = std::current_exception();
            all.left_out.push_back({joint, error.what()});
        }
    }
    common.messages->say_all(joints.size());
    all.messages = common.messages;
    return all;
}

/// "wide.csv" and "a,b" with quotes where CSV needs them.
std::string csv_cell(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string cell = "\"";
    for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
    return cell + '"';
}

std::string with_joint_column(const JointResults& all) {
    std::string whole;
    for (std::size_t j = 0; j < all.joints.size(); ++j) {
        std::string_view text = all.results[j].text;
        const std::string cell = csv_cell(all.joints[j]);
        for (bool header = true; !text.empty(); header = false) {
            const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
            if (!header || j == 0) {
                whole += header ? "joint" : cell;
                whole += ',';
                whole += text.substr(0, end);
            }
            text.remove_prefix(end);
        }
    }
    return whole;
}

std::string as_one(const JointResults& all, bool json, std::string_view kind, bool csv) {
    if (json) {
        std::vector<JointDocument> documents;
        for (std::size_t j = 0; j < all.joints.size(); ++j)
            documents.push_back({all.joints[j], all.results[j].text});
        return joint_documents_text(kind, documents);
    }
    if (csv) return with_joint_column(all);
    std::string whole;
    for (std::size_t j = 0; j < all.joints.size(); ++j)
        whole += (j > 0 ? "\n" : "") + all.joints[j] + ": " + all.results[j].text;
    return whole;
}

void write_own(const JointResult& result, const std::string& path, const CommonOptions& common) {
    if (result.write)
        result.write();
    else
        write_text(path, result.text, common.overwrite());
}

}  // namespace

ExitCode run_each_joint(const LogRequest& request, std::string_view documents, bool csv,
                        const std::function<JointResult(const std::optional<std::string>& joint,
                                                        const CommonOptions& common)>& one) {
    const CommonOptions& common = request.common;
    if (!can_be_read_again(request.path) && asks_for_several(request.path, request.log))
        raise<UsageError>("--joint {}: standard input can be read once only; give a file",
                          *request.log.joint);
    const AskedJoints asked = joints_asked_for(request.path, request.log);
    const bool several = asked.names.size() + asked.left_out.size() > 1 && request.log.joint;
    if (several || asked.names.size() > 1) say_left_out(common, asked.left_out);
    if (asked.names.size() < 2) {
        // Where others are left out, the name says which is meant.
        const auto only = several ? std::optional(asked.names.front()) : std::nullopt;
        const JointResult result = one(only, common);
        write_own(result, common.output, common);
        if (result.afterwards) result.afterwards();
        return result.code;
    }
    check_several(request, asked.names);
    const JointResults all = go_over(common, asked.names, one);
    if (all.results.empty()) std::rethrow_exception(all.first_error);
    say_left_out(common, all.left_out);
    if (names_joint(common.output)) {
        for (std::size_t j = 0; j < all.joints.size(); ++j)
            write_own(all.results[j], with_joint(common.output, all.joints[j]), common);
    } else {
        write_text(common.output, as_one(all, common.json, documents, csv), common.overwrite());
    }
    ExitCode code = ExitCode::done;
    for (const JointResult& result : all.results) {
        if (result.afterwards) result.afterwards();
        if (result.code != ExitCode::done)
            code = code == ExitCode::done ? result.code : std::min(code, result.code);
    }
    all.messages->say_all(asked.names.size());
    return code;
}

}  // namespace ripplenotch
