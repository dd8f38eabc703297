// SPDX-License-Identifier: MIT
// ripplenotch diagnose: which effect a model of a joint misses, and how far the gap shrinks with it.

#include <fmt/format.h>

#include <memory>

#include "cli/arm/given_arm.hpp"
#include "cli/command.hpp"
#include "cli/diagnose/diagnosis_text.hpp"
#include "cli/diagnose/given_terms.hpp"
#include "cli/gear/gear_choice.hpp"
#include "cli/gear/joint_facts.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/readings/readings.hpp"
#include "cli/talk.hpp"
#include "cli/text_table.hpp"
#include "ripplenotch/chart/diagnosis_figure.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/document/diagnosis_json.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {
namespace {

struct Request {
    CommonOptions common;
    PlotRequest plot;
    LogOptions log;
    std::string path, model;
    GearOptions gear;  ///< a ratio alone, in place of a model
    GivenOptions given;
    std::optional<std::string> validate;
    std::vector<std::string> without, rules;
    bool list_rules = false, explain = false;
    Seconds smoothing = default_smoothing;
    bool require_conclusive = false;
};

/// Every rule with its value, those of --rule included.
std::string rules_text(const DiagnosisRules& rules) {
    std::vector<std::vector<std::string>> rows = {{"rule", "is", "from", "to", "kind", "unit", "why"}};
    for (const DiagnosisRule& rule : diagnosis_rules()) {
        rows.push_back({rule.name, shortest(rule.get(rules)), shortest(rule.lowest), shortest(rule.highest),
                        rule.whole ? "whole" : "number", std::string(rule.unit), std::string(rule.why)});
    }
    return text_table(rows, "lrrrl");
}

DiagnosisRules rules_of(const Request& request) {
    DiagnosisRules rules;
    for (const std::string& assignment : request.rules) set_rule(rules, assignment);
    return rules;
}

std::string source_of(const Request& request) {
    return request.model == "-" ? "standard input" : request.model;
}

void check(const Request& request) {
    if (request.path.empty()) raise<UsageError>("LOG is missing: the measured log; - is standard input");
    if (request.model.empty() && !request.given.any())
        raise<UsageError>("--model is missing: the model.json whose gap to the log is to be explained");
    if (request.model.empty() && !request.gear.ratio)
        raise<UsageError>("--gear-ratio is missing; give it, or --model FILE, which states it");
    if (!request.model.empty() && request.gear.ratio)
        raise<UsageError>("--gear-ratio: the model of {} states the gear ratio; change it there",
                          request.model);
    check_gear(request.gear);
    if (request.given.arm && request.common.output != "-")
        raise<UsageError>("-o {}: model.json holds no arm; leave -o out", request.common.output);
    if (request.path == "-" && request.model == "-")
        raise<UsageError>("--model - and LOG -: standard input holds one of them");
    if (request.validate && *request.validate == "-") raise<UsageError>("--validate -: give a file");
    if (request.smoothing.value() < 0.0)
        raise<UsageError>("--smoothing: {} s is below 0", shortest(request.smoothing.value()));
    for (const std::string& name : request.without) (void)find_effect(name);
    check_plot(request.plot, request.common);
    if (request.plot.path == "-" && request.common.json)
        raise<UsageError>("--plot - and --json would both go to standard output; name a file with --plot");
}

Log read(const Request& request, bool given_in_model, const ReadOptions& reading, const std::string& path,
         Provenance& provenance) {
    // What is given beside the log stands row by row against all of it.
    const bool whole = request.given.any() || given_in_model;
    Log log = whole ? read_log(path, reading) : read_log_in_part(path, reading);
    say_layout(request.common, log.layout);
    say_warnings(request.common, log.recording.warnings);
    provenance.recordings.push_back({log.recording});
    if (path == "-") return log;
    provenance.inputs.push_back(input_record(path));
    provenance.inputs.back().rows = log.recording.rows();
    return log;
}

ModelWithGiven model_of(const Request& request, Provenance& provenance) {
    if (request.model.empty()) return {{GearRatio(*request.gear.ratio), {}}, std::nullopt};
    const ModelWithGiven model = read_model_with_given(read_all(request.model), source_of(request));
    if (request.model != "-") provenance.inputs.push_back(input_record(request.model));
    return model;
}

/// The simulation with the values that were fitted, as part of the improved model.
std::optional<SimulatedTerm> fitted(std::optional<SimulatedTerm> simulated, const Diagnosis& diagnosis) {
    if (!simulated) return simulated;
    const auto value = [&](std::string_view name, std::size_t number) {
        for (const GivenValue& given : diagnosis.given) {
            if (given.name == name && number-- == 0) return to_digits(given.value);
        }
        return 0.0;
    };
    simulated->scale = value("simulated", 0);
    if (simulated->fit_delay && *simulated->scale != 0.0)
        simulated->delay_s += to_digits(value("simulated", 1) / *simulated->scale);
    simulated->fit_delay = false;
    simulated->offset_nm = value("offset_nm", 0);
    simulated->inertia_kgm2 = value("inertia_kgm2", 0);
    simulated->gravity_cosine_nm = value("gravity_cosine_nm", 0);
    simulated->gravity_sine_nm = value("gravity_sine_nm", 0);
    return simulated;
}

/// What was fitted has no more digits in the model than in the story and its JSON.
Model with_fitted_digits(Model model) {
    for (Term& term : model.terms) {
        for (std::optional<double>& value : term.values) {
            if (value) value = to_digits(*value);
        }
    }
    return model;
}

/// What is diagnosed: the log, and what is given of it.
struct Recorded {
    Log log;
    std::optional<Log> other;
    GivenTerms given;
};

Recorded read(const Request& request, const ModelWithGiven& model, Provenance& provenance) {
    const ReadOptions reading = read_options(request.log, gear_of(model.model, ""));
    const bool given = model.simulated.has_value();
    Recorded recorded{read(request, given, reading, request.path, provenance), std::nullopt, {}};
    if (request.validate) recorded.other = read(request, given, reading, *request.validate, provenance);
    const GivenLog log{request.path, recorded.log};
    std::optional<GivenLog> other;
    if (recorded.other) other.emplace(GivenLog{*request.validate, *recorded.other});
    const std::size_t said = recorded.log.recording.warnings.size();
    recorded.given = read_given(request.given, model.simulated, reading, log, other ? &*other : nullptr);
    const auto& warnings = recorded.log.recording.warnings;
    say_warnings(request.common, {warnings.begin() + static_cast<std::ptrdiff_t>(said), warnings.end()});
    return recorded;
}

void say_arm(const CommonOptions& common, const ArmAccount& arm) {
    for (const JointTravel& joint : arm.joints)
        say(common, fmt::format("arm: {} is {} of the log, and goes {:.3g} deg", joint.name,
                                joint.log.empty() ? "the joint" : joint.log, joint.travel_deg));
    say(common, fmt::format("arm: as if with {}", arm.option));
    for (const std::string& note : arm.notes) say(common, note);
    say_warnings(common, arm.warnings);
}

Diagnosis diagnosed(const Request& request, const Model& model, const Recorded& recorded) {
    Progress::current().begin("looking for what is missing", "", 0);
    try {
        return diagnose_readings(model, recorded.log, recorded.other ? &*recorded.other : nullptr,
                                 {.smoothing = request.smoothing,
                                  .without = request.without,
                                  .given = recorded.given.log,
                                  .validation_given = recorded.given.validation,
                                  .rules = rules_of(request)});
    } catch (const DataError& error) {  // the library knows no file
        raise<DataError>("{}: {}", request.path, error.what());
    }
}

ExitCode run(const Request& request, const std::string& command_line) {
    const DiagnosisRules rules = rules_of(request);  // refused before anything is read
    if (request.list_rules) {
        write_text("-", rules_text(rules), ByteSink::Overwrite::no);
        return ExitCode::done;
    }
    check(request);
    Provenance provenance{{}, command_line};
    const ModelWithGiven model = model_of(request, provenance);
    const GearAccount gear =
        gear_of(model.model, request.model.empty() ? "--gear-ratio" : source_of(request));
    say(request.common, gear_in_words(gear));
    const bool keep = request.common.output != "-";
    const Recorded recorded = read(request, model, provenance);
    const Log& log = recorded.log;
    if (recorded.given.arm) say_arm(request.common, *recorded.given.arm);
    const Diagnosis diagnosis = diagnosed(request, model.model, recorded);
    if (keep) {
        write_text(request.common.output,
                   write_model(with_fitted_digits(diagnosis.model), provenance,
                               fitted(recorded.given.simulated, diagnosis)),
                   request.common.overwrite());
        say(request.common, fmt::format("the improved model is in {}", request.common.output));
    }
    write_text("-",
               request.common.json ? write_diagnosis(diagnosis, gear, provenance,
                                                     recorded.given.arm ? &*recorded.given.arm : nullptr)
                                   : (recorded.given.arm ? arm_text(*recorded.given.arm) : "") +
                                         diagnosis_story(diagnosis, request.explain),
               ByteSink::Overwrite::no);
    draw_plot(request.plot, request.common, provenance,
              [&] { return diagnosis_figure(request.path, diagnosis, log.trace.view(), request.smoothing); });
    const bool conclusive =
        diagnosis.verdict == DiagnosisVerdict::matches || diagnosis.verdict == DiagnosisVerdict::explained;
    return request.require_conclusive && !conclusive ? ExitCode::inconclusive : ExitCode::done;
}

std::function<ExitCode()> attach(Options& options) {
    const auto request = std::make_shared<Request>();
    options.argument("LOG", request->path, false, "the measured log; - is standard input");
    options.text("--model", request->model, "FILE", "model.json of the joint; values left out are fitted");
    attach_given(options, request->given);
    attach_gear(options, request->gear,
                {.ratio = "motor turns per joint turn, in place of --model", .orders = "", .joint_file = ""});
    options.text("--validate", request->validate, "OTHER",
                 "another log, on which the improved model is checked");
    options.texts("--without", request->without, "NAME",
                  "an effect that is not tried; may be given several times");
    options.flag("--explain", request->explain,
                 "in the story, which rules were asked about each finding, with their numbers and limits");
    options.texts("--rule", request->rules, "NAME=VALUE",
                  "for studies: a limit that a diagnosis decides by; may be given several times");
    options.flag("--rules", request->list_rules,
                 "list these limits, their bounds, units and reasons, and end; needs no LOG");
    options.quantity("--smoothing", request->smoothing, Dimension::time,
                     "window in which the log's velocity is fitted to give speed and acceleration");
    options.flag("--require-conclusive", request->require_conclusive,
                 "exit with 5 unless the log is explained in the end");
    attach_plot(options, request->plot);
    attach_log(options, request->log);
    attach_common(options, request->common, {"a model", ".json"});
    return [request, &options] { return run(*request, options.command_line()); };
}

}  // namespace

const Command commands::diagnose{
    .name = "diagnose",
    .summary = "where model and log disagree, the effect that is missing, and how far the gap shrinks",
    .description =
        "Fits the model to the log, says where they disagree, tries every effect of the catalogue, names and "
        "adds\n"
        "what is missing, and says what no effect explains. -o takes the improved model.json.\n"
        "Example: ripplenotch diagnose log.csv --model model.json --validate other.csv -o improved.json",
    .attach = attach,
};

}  // namespace ripplenotch
