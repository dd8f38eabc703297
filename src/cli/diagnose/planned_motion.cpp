// SPDX-License-Identifier: MIT
#include "cli/diagnose/planned_motion.hpp"

#include <fmt/format.h>

#include <array>

#include "cli/diagnose/decided_text.hpp"
#include "cli/gear/chosen_method.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
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
