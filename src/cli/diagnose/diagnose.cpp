// SPDX-License-Identifier: MIT
// ripplenotch diagnose: which effect a model of a joint misses, and how far the gap shrinks with it.

#include <fmt/format.h>

#include <memory>

#include "cli/command.hpp"
#include "cli/diagnose/diagnosis_text.hpp"
#include "cli/gear/gear_choice.hpp"
#include "cli/gear/joint_facts.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/readings/readings.hpp"
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

void check(const Request& request) {
    if (request.path.empty()) raise<UsageError>("LOG is missing: the measured log; - is standard input");
    if (request.model.empty())
        raise<UsageError>("--model is missing: the model.json whose gap to the log is to be explained");
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

Log read(const Request& request, const Model& model, const std::string& path, Provenance& provenance) {
    Log log = read_log(path, read_options(request.log, gear_of(model, "")));
    say_layout(request.common, log.layout);
    say_warnings(request.common, log.recording.warnings);
    provenance.recordings.push_back({log.recording});
    if (path == "-") return log;
    provenance.inputs.push_back(input_record(path));
    provenance.inputs.back().rows = log.recording.rows();
    return log;
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

Diagnosis diagnosed(const Request& request, const Model& model, const Log& log, Provenance& provenance) {
    std::optional<Log> other;
    if (request.validate) other = read(request, model, *request.validate, provenance);
    Progress::current().begin("looking for what is missing", "", 0);
    try {
        return diagnose_readings(
            model, log, other ? &*other : nullptr,
            {.smoothing = request.smoothing, .without = request.without, .rules = rules_of(request)});
    } catch (const DataError& error) {  // the library knows no file
        raise<DataError>("{}: {}", request.path, error.what());
    }
}

ExitCode run(const Request& request, const std::string& command_line) {
    const DiagnosisRules rules = rules_of(request);  // refused before anything is read
    if (request.list_rules) {
        write_all("-", rules_text(rules), ByteSink::Overwrite::no);
        return ExitCode::done;
    }
    check(request);
    Provenance provenance{{}, command_line};
    const std::string source = request.model == "-" ? "standard input" : request.model;
    const Model model = read_model(read_all(request.model), source);
    if (request.model != "-") provenance.inputs.push_back(input_record(request.model));
    const GearAccount gear = gear_of(model, source);
    say(request.common, gear_in_words(gear));
    const bool keep = request.common.output != "-";
    const Log log = read(request, model, request.path, provenance);
    const Diagnosis diagnosis = diagnosed(request, model, log, provenance);
    if (keep) {
        write_all(request.common.output, write_model(with_fitted_digits(diagnosis.model), provenance),
                  request.common.overwrite());
        say(request.common, fmt::format("the improved model is in {}", request.common.output));
    }
    write_all("-",
              request.common.json ? write_diagnosis(diagnosis, gear, provenance)
                                  : diagnosis_story(diagnosis, request.explain),
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
