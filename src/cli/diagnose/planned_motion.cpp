// SPDX-License-Identifier: MIT
#include "cli/diagnose/planned_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "cli/diagnose/diagnosis_text.hpp"
#include "cli/gear/chosen_method.hpp"
#include "cli/talk.hpp"
#include "core/rows/row_facts.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
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
    std::string name(path);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
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

namespace {

constexpr std::array limit_keys = {
    Key{.name = "speed", .dimension = Dimension::speed, .required = true, .above = 0.0, .at_most = 1e5},
    Key{.name = "acceleration", .kind = KeyKind::text, .required = true},
    Key{.name = "range",
        .kind = KeyKind::list,
        .dimension = Dimension::angle,
        .required = true,
        .at_least = -1e6,
        .at_most = 1e6},
};

// "300deg/s2": a speed a second.
double acceleration_deg_s2(const std::string& text) {
    for (const std::string_view ending : {"/s2", "/s^2"}) {
        if (!text.ends_with(ending)) continue;
        const std::string speed = text.substr(0, text.size() - ending.size()) + "/s";
        return parse_quantity(speed, Dimension::speed, "--limits, acceleration");
    }
    raise<UsageError>(
        "--limits, acceleration: '{}' is not in deg/s2 or rad/s2, for example acceleration=300deg/s2", text);
}

MotionLimits limits_of(const std::string& words) {
    // The name is that of the option: only keys are typed.
    const Spec spec = parse_spec("limits," + words);
    const Settings settings("--limits", spec, limit_keys);
    const std::vector<double> range = settings.list("range");
    if (range.size() != 2)
        raise<UsageError>(
            "--limits, range: {} positions, expected the lowest and the highest, for example "
            "range=-90deg:90deg",
            range.size());
    const MotionLimits limits{settings.number("speed"), acceleration_deg_s2(settings.text("acceleration")),
                              range[0], range[1]};
    check(limits);
    return limits;
}

std::string csv_of(const Motion& motion) {
    std::string text = "time_s,position_deg,velocity_deg_s\n";
    for (std::size_t k = 0; k < motion.size(); ++k)
        text += fmt::format("{},{},{}\n", shortest(to_digits(motion.time_s[k], 9)),
                            shortest(to_digits(motion.position_deg[k], 9)),
                            shortest(to_digits(motion.velocity_deg_s[k], 9)));
    return text;
}

std::string gain_words(double gain) { return gain > 0.0 ? short_number(gain) : "none"; }

}  // namespace

void check_plan(const DiagnoseRequest& request) {
    if (request.plan.has_value() != request.limits.has_value())
        raise<UsageError>(
            "{} is missing: --plan FILE needs what the joint may do, --limits "
            "speed=90deg/s,acceleration=300deg/s2,range=-90deg:90deg",
            request.plan ? "--limits" : "--plan");
    if (!request.plan) return;
    (void)limits_of(*request.limits);
    check_output_name(*request.plan, "a motion", ".csv .txt", "--plan");
    if (*request.plan == "-") raise<UsageError>("--plan -: the story goes to standard output; give a file");
    if (request.given.any())
        raise<UsageError>(
            "--plan: beside --arm or --simulated a motion is not planned; the torque of what is given "
            "is not known along it");
    if (request.all_joints() && !names_joint(*request.plan))
        raise<UsageError>("--plan {}: each joint has a motion of its own; put {{joint}} into the name",
                          *request.plan);
}

PlannedMotion plan_for(const DiagnoseRequest& request, const JointDiagnosis& one) {
    PlannedMotion planned{with_joint(*request.plan, one.joint), {}};
    PlanOptions options;
    const TraceView log = one.log.trace.view();
    options.sample_rate = Hertz(to_digits(log.sample_rate.value(), 3));
    options.smoothing = request.smoothing;
    options.rules = rules_of(request);
    planned.plan = plan_motion(one.diagnosis, log, limits_of(*request.limits), options);
    if (planned.plan) write_text(planned.file, csv_of(planned.plan->motion), request.common.overwrite());
    return planned;
}

std::string plan_text(const PlannedMotion& planned) {
    if (!planned.plan)
        return "plan: this log leaves nothing open that a motion would decide; none is written\n";
    const MotionPlan& plan = *planned.plan;
    std::string text =
        fmt::format("plan: {} moves for {:g} s{}\n", planned.file, plan.duration().value(),
                    plan.decides ? "" : "; within these limits no motion of that length may decide all");
    for (const PlanQuestion& question : plan.questions) {
        if (!question.open) continue;
        text += fmt::format("plan: {} from {}: gain {}, in this log {}\n", question.effect,
                            question.rival.empty() ? "all else" : question.rival, short_number(question.gain),
                            gain_words(question.gain_before));
    }
    text += "plan: simulate";
    for (const std::string& words : plan.motions) text += " --motion " + words;
    return text + "\n";
}

}  // namespace ripplenotch
