// SPDX-License-Identifier: MIT
#include "cli/diagnose/diagnose_request.hpp"

#include "cli/diagnose/model_from_log.hpp"
#include "cli/diagnose/planned_motion.hpp"
#include "cli/gear/chosen_method.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

void check_model(const DiagnoseRequest& request) {
    if (request.model.empty() && !request.given.any())
        raise<UsageError>(
            "--model is missing: the model.json whose gap to the log is to be explained; --model auto makes "
            "one "
            "of the log itself, from what identify finds in it, and -o FILE writes it with what was added");
    if (request.model.empty() && !request.gear.ratio)
        raise<UsageError>("--gear-ratio is missing; give it, or --model FILE, which states it");
    if (!request.model.empty() && request.model != model_from_log && request.gear.ratio)
        raise<UsageError>("--gear-ratio: the model of {} states the gear ratio; change it there",
                          request.model == "-" ? "standard input" : request.model);
    check_gear(request.gear);
    if (request.path == "-" && request.model == model_from_log)
        raise<UsageError>(
            "--model auto reads the log twice, and standard input can be read once; give a file");
    if (request.path == "-" && request.model == "-")
        raise<UsageError>("--model - and LOG -: standard input holds one of them");
}

void check_joints(const DiagnoseRequest& request) {
    if (!request.all_joints()) return;
    if (request.path == "-" || request.model == "-")
        raise<UsageError>("--joint all: standard input can be read once only; give a file");
    if (request.plot.wanted()) raise<UsageError>("--plot draws one joint, and --joint all asks for each");
    if (request.common.output != "-" && !names_joint(request.common.output))
        raise<UsageError>("-o {}: each joint has a model of its own; put {{joint}} into the name",
                          request.common.output);
}

}  // namespace

void check(const DiagnoseRequest& request) {
    if (request.path.empty()) raise<UsageError>("LOG is missing: the measured log; - is standard input");
    check_model(request);
    if (request.validate && *request.validate == "-") raise<UsageError>("--validate -: give a file");
    if (request.smoothing.value() < 0.0)
        raise<UsageError>("--smoothing: {} s is below 0", shortest(request.smoothing.value()));
    for (const std::string& name : request.without) (void)find_effect(name);
    for (const std::string& name : request.accept) (void)find_effect(name);
    check_output_name(request.common.output, "a model", ".json .xml .mjcf");
    check_joints(request);
    check_plan(request);
    check_plot(request.plot, request.common);
    if (request.plot.path == "-" && request.common.json)
        raise<UsageError>("--plot - and --json would both go to standard output; name a file with --plot");
}

DiagnosisRules rules_of(const DiagnoseRequest& request) {
    DiagnosisRules rules;
    for (const std::string& assignment : request.rules) set_rule(rules, assignment);
    return rules;
}

}  // namespace ripplenotch
