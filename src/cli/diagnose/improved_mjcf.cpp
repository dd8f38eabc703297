// SPDX-License-Identifier: MIT
#include "cli/diagnose/improved_mjcf.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/diagnose/decided_text.hpp"
#include "cli/talk.hpp"
#include "core/rows/row_facts.hpp"
#include "core/text/lower_case.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

// The rms that is left when the model's torque is that of what MuJoCo holds. `left`: what the whole model
// leaves beside given terms; empty without any.
double held_gap(const JointDiagnosis& one, const Model& whole, const Motion& motion,
                const std::vector<double>& left) {
    const std::vector<double> held = predict_nm(joint_mjcf(whole).held, motion);
    std::vector<double> gap(held.size());
    if (left.empty()) {
        for (std::size_t k = 0; k < gap.size(); ++k) gap[k] = one.log.trace.torque_nm[k] - held[k];
        return rms(gap);
    }
    const std::vector<double> all = predict_nm(whole, motion);
    for (std::size_t k = 0; k < gap.size(); ++k) gap[k] = left[k] + all[k] - held[k];
    return rms(gap);
}

Motion motion_of(const DiagnoseRequest& request, const JointDiagnosis& one) {
    Motion motion = motion_along(one.log.trace.view(), request.smoothing);
    const std::vector<double>& beside = one.diagnosis.beside_given_nm;
    if (beside.empty()) return motion;
    motion.known_nm = one.log.trace.torque_nm;
    for (std::size_t k = 0; k < beside.size(); ++k) motion.known_nm[k] -= beside[k];
    return motion;
}

// The file of --arm mjcf,file=FILE.
std::optional<std::string> tree_of(const DiagnoseRequest& request, const JointDiagnosis& one) {
    if (!request.given.arm || parse_spec(*request.given.arm).name != "mjcf" || !one.given.fitted_arm)
        return std::nullopt;
    return one.given.fitted_arm->file();
}

void add_given(JointMjcf& parts, const JointDiagnosis& one, const std::optional<std::string>& tree) {
    if (one.given.arm && tree)
        parts.not_held.push_back({"arm", fmt::format("bodies and armature are those of {}; what the log told "
                                                     "are combinations of masses",
                                                     *tree)});
    if (one.given.arm && !tree)
        parts.not_held.push_back({"arm", "its bodies are not in this file; --arm mjcf,file=FILE has them"});
    if (one.given.simulated) parts.not_held.push_back({"simulated", "its torque is not in this file"});
}

std::vector<std::string> mjcf_heading(const JointDiagnosis& one, const MjcfAccount& account) {
    std::vector<std::string> lines = {fmt::format("Made by {} {}:", tool_name, version()),
                                      one.provenance.command};
    for (const InputRecord& input : one.provenance.inputs)
        lines.push_back(fmt::format("from {}, SHA-256 {}", input.name, input.sha256));
    lines.push_back(fmt::format("measured less predicted torque: {} -> {} Nm rms with what is held",
                                short_number(account.before_nm), short_number(account.after_nm)));
    return lines;
}

}  // namespace

bool names_mjcf(std::string_view path) {
    const std::string name = lower_case(path);
    return name.ends_with(".xml") || name.ends_with(".mjcf");
}

MjcfAccount write_improved_mjcf(const DiagnoseRequest& request, const JointDiagnosis& one,
                                const std::string& path) {
    const ModelWithGiven model = improved_model(one.given, one.diagnosis);
    const std::optional<std::string> tree = tree_of(request, one);
    JointMjcf parts = joint_mjcf(model.model);
    add_given(parts, one, tree);
    const Motion motion = motion_of(request, one);
    const Diagnosis& found = one.diagnosis;
    const MjcfAccount account{path, parts.holds, parts.not_held,
                              held_gap(one, found.baseline, motion, found.residual_before_nm),
                              held_gap(one, model.model, motion, found.residual_after_nm)};
    const std::vector<std::string> heading = mjcf_heading(one, account);
    write_text(path,
               tree ? write_into_mjcf(parts, read_chain_file(*tree), *tree, model.arm->joint, heading)
                    : write_mjcf(parts, one.joint.empty() ? "joint" : one.joint, heading),
               request.common.overwrite());
    return account;
}

std::string mjcf_text(const MjcfAccount& account) {
    std::string held;
    for (const MjcfPart& part : account.holds)
        held += fmt::format("{}{} ({})", held.empty() ? "" : ", ", part.effect, part.words);
    std::string text = fmt::format("{}: MuJoCo holds {}; gap {} -> {} Nm with that alone\n", account.file,
                                   held.empty() ? "nothing of it" : held, short_number(account.before_nm),
                                   short_number(account.after_nm));
    for (const MjcfPart& part : account.not_held)
        text += fmt::format("{}: not held: {}: {}\n", account.file, part.effect, part.words);
    return text;
}

}  // namespace ripplenotch
