// SPDX-License-Identifier: MIT
// ripplenotch diagnose: which effect a model of a joint misses, and how far the gap shrinks with it.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/diagnose/joint_diagnosis.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/simulation_json.hpp"
#include "ripplenotch/verdict/drive.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

namespace {

// The diagnoses of all joints in one table.

std::string nm(const std::optional<double>& value) { return value ? fmt::format("{:.4g}", *value) : "-"; }

// A row a joint: rms before and after, on the validation log where there is one, and what is named.
std::string joints_table(const std::vector<JointDiagnosis>& joints) {
    const bool validated = std::any_of(joints.begin(), joints.end(), [](const JointDiagnosis& one) {
        return one.diagnosis.gap.validation_before_nm.has_value();
    });
    TextRows cells = {{"joint", "before, Nm", "after, Nm"}};
    if (validated) cells.front().insert(cells.front().end(), {"validation before", "validation after"});
    cells.front().insert(cells.front().end(), {"verdict", "named"});
    for (const JointDiagnosis& one : joints) {
        const Diagnosis& row = one.diagnosis;
        auto& line = cells.emplace_back(std::vector{one.joint, nm(row.gap.before_nm), nm(row.gap.after_nm)});
        if (validated)
            line.insert(line.end(), {nm(row.gap.validation_before_nm), nm(row.gap.validation_after_nm)});
        line.emplace_back(verdict_name(row.verdict));
        line.push_back(row.named.empty() ? "nothing" : fmt::format("{}", fmt::join(row.named, ", ")));
    }
    return text_table(cells, validated ? "lrrrrll" : "lrrll");
}

// The catalogue of effects.

std::string catalogue_text() {
    TextRows rows = {{"effect", "acts on", "summary"}};
    for (const Effect* effect : catalogue()) {
        rows.push_back(
            {std::string(effect->name), std::string(side_name(effect->side)), std::string(effect->summary)});
    }
    return text_table(rows, "l");
}

std::string parameters_text(const Effect& effect) {
    TextRows rows = {{"parameter", "unit", "neutral", "from", "to", "left out", "meaning"}};
    for (const Parameter& p : effect.parameters) {
        const std::string left_out = p.left_out == LeftOut::fitted    ? "is fitted"
                                     : p.left_out == LeftOut::refused ? "is refused"
                                                                      : "is " + shortest(p.start);
        rows.push_back({std::string(p.name), p.unit.empty() ? "-" : std::string(p.unit), shortest(p.neutral),
                        shortest(p.lower), shortest(p.upper), left_out, std::string(p.help)});
    }
    return text_table(rows, "llrrrll");
}

std::string effect_text(const Effect& effect) {
    std::string text = fmt::format("{}: {}\n\n  {}\n\n{}\nacts on: {}\nsymptom: {}\nlook-alikes:\n",
                                   effect.name, effect.summary, effect.equation, parameters_text(effect),
                                   side_name(effect.side), effect.symptom);
    for (const LookAlike& other : effect.look_alikes)
        text +=
            fmt::format("  {}, when: {}\n    to distinguish: {}\n", other.name, other.when, other.told_by);
    return text + fmt::format("source: {}\n", effect.source);
}

Answer print_effects(const DiagnoseRequest& request, const std::string& command_line) {
    const bool stands_alone = request.path.empty() && request.model.empty() && !request.improved;
    if (!stands_alone || (request.effects && request.effect))
        raise<UsageError>(
            "--effects and --effect NAME stand alone: they print the catalogue and read no LOG");
    const Effect* only = request.effect ? &find_effect(*request.effect) : nullptr;
    return {.text = only != nullptr ? effect_text(*only) : catalogue_text(), .document = [=] {
                const auto effects = only != nullptr ? std::span<const Effect* const>(&only, 1) : catalogue();
                return write_catalogue(effects, {.inputs = {}, .command = command_line});
            }};
}

std::string story(const DiagnoseRequest& request, const JointDiagnosis& one) {
    return (one.diagnosis.drive ? drive_words(one.diagnosis.drive->torque) + "\n" : "") +
           (one.given.account ? arm_text(*one.given.account) : "") +
           diagnosis_story(request.common, one.diagnosis, request.explain) +
           (one.diagnosis.drive ? position_words(*one.diagnosis.drive) + "\n" : "") +
           (one.diagnosis.model.has_gear_ratio() ? "" : gear_in_words(one.gear) + "\n") +
           (one.mjcf ? mjcf_text(*one.mjcf) : "");
}

void add_improved(const DiagnoseRequest& request, JointDiagnosis& one, Answer& answer) {
    if (!request.improved) return;
    const std::string path = with_joint(*request.improved, one.joint);
    if (names_mjcf(path)) {
        answer.files.push_back({path, improved_mjcf(request, one, path), ""});
        return;
    }
    answer.files.push_back({path, write_model(improved_model(one.given, one.diagnosis), one.provenance),
                            fmt::format("the improved model is in {}", path)});
}

Answer run_one(const DiagnoseRequest& request, GivenSource& given, const std::string& command_line) {
    const auto one =
        std::make_shared<JointDiagnosis>(diagnosed_joint(request, std::nullopt, given, command_line));
    if (!one->diagnosis.not_accepted.empty()) raise<UsageError>("{}", one->diagnosis.not_accepted.front());
    Answer answer;
    add_improved(request, *one, answer);
    answer.text = story(request, *one);
    answer.document = [one] { return write_diagnosis(one->facts(), one->provenance); };
    answer.figure = [one, path = request.path] {
        return diagnosis_figure(path, one->diagnosis, one->log.trace.view());
    };
    answer.provenance = one->provenance;
    if (request.require_conclusive && !one->is_conclusive()) answer.code = ExitCode::inconclusive;
    return answer;
}

// The columns of a joint are not held longer than they are needed.
void let_columns_go(JointDiagnosis& one) {
    one.log = {};
    one.given.log.clear();
    one.given.validation.clear();
    one.diagnosis.residual_before_nm = one.diagnosis.residual_after_nm = one.diagnosis.beside_given_nm = {};
}

std::string list_of(const std::vector<JointDiagnosis>& all, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    std::vector<DiagnosedJoint> joints;
    for (const JointDiagnosis& one : all) {
        joints.push_back(one.facts());
        for (const InputRecord& input : one.provenance.inputs) {
            const auto same = [&](const InputRecord& known) { return known.name == input.name; };
            if (std::none_of(provenance.inputs.begin(), provenance.inputs.end(), same))
                provenance.inputs.push_back(input);
        }
    }
    return write_diagnoses(joints, provenance);
}

Answer run_all(const DiagnoseRequest& request, GivenSource& given, const std::string& command_line) {
    const std::vector<std::string> joints = joints_of(request, given);
    std::vector<JointDiagnosis> all;
    Answer answer;
    for (const std::string& joint : joints) {
        JointDiagnosis& one = all.emplace_back(diagnosed_joint(request, joint, given, command_line));
        for (const std::string& why : one.diagnosis.not_accepted)
            warn(request.common, fmt::format("joint {}: {}", joint, why));
        add_improved(request, one, answer);
        answer.text += fmt::format("joint {}\n{}\n", joint, story(request, one));
        let_columns_go(one);
    }
    answer.text += joints_table(all);
    const bool conclusive =
        std::all_of(all.begin(), all.end(), [](const JointDiagnosis& one) { return one.is_conclusive(); });
    if (request.require_conclusive && !conclusive) answer.code = ExitCode::inconclusive;
    const auto kept = std::make_shared<const std::vector<JointDiagnosis>>(std::move(all));
    answer.document = [kept, command_line] { return list_of(*kept, command_line); };
    return answer;
}

Answer run_diagnose(const DiagnoseRequest& request, const std::string& command_line) {
    if (request.effects || request.effect) return print_effects(request, command_line);
    if (const auto table = friction_table_of(request))
        return run_friction_table(request, *table, command_line);
    check(request);
    GivenOptions options = request.given;
    options.finds_ripple = std::ranges::find(request.without, "ripple") == request.without.end();
    GivenSource given(std::move(options), true);
    return request.all_joints() ? run_all(request, given, command_line)
                                : run_one(request, given, command_line);
}

std::function<Answer()> attach_diagnose(Options& options) {
    const auto request = std::make_shared<DiagnoseRequest>();
    options.argument("LOG", request->path, false, "the measured log; - is standard input");
    options.text("--model", request->model, "FILE",
                 "model.json of the joint; values left out are fitted; auto: gear ratio and ripple orders as "
                 "identify finds them in LOG");
    attach_given(options, request->given);
    attach_drive(options, request->drive);
    attach_gear(options, request->gear,
                {.ratio = "motor turns per joint turn, instead of --model", .orders = "", .joint_file = ""});
    options.flag("--friction-table", request->friction_table,
                 "LOG is a table of speeds and torques, without time: its "
                 "Coulomb, viscous and Stribeck friction; needs no --model");
    options.text("--validate", request->validate, "OTHER",
                 "another log, on which the improved model is checked");
    options.texts("--without", request->without, "NAME",
                  "an effect that is not tried; may be given several times");
    options.texts("--accept", request->accept, "NAME",
                  "an uncertain finding to include in the model anyway; may be given several times");
    options.flag("--explain", request->explain,
                 "also print all findings in full, and in one line each why a candidate was not named");
    options.flag("--effects", request->effects,
                 "list the effects that models are made of, and end; needs no LOG");
    options.text("--effect", request->effect, "NAME",
                 "explain one effect (equation, parameters, symptom, look-alikes), and end; needs no LOG");
    options.number("--smoothing", request->smoothing, Dimension::time,
                   "window of the fit to the log's velocity, which gives speed and acceleration");
    attach_conclusive(options, request->require_conclusive);
    attach_plot(options, request->common);
    attach_log(options, request->log);
    {
        const Options::Group group(options, output_group);
        options.text("--improved-model", request->improved, "FILE",
                     "write the improved model here: .json, or .xml and .mjcf for MuJoCo");
        options.writes("--improved-model");
        options.was_output("--improved-model", request->improved_by_output);
    }
    attach_json(options, request->common);
    attach_manner(options, request->common);
    return [request, &options] { return run_diagnose(*request, options.command_line()); };
}

}  // namespace

const Command commands::diagnose{
    .name = "diagnose",
    .summary = "where model and log disagree, the effect that is missing, and how far the gap shrinks",
    .description =
        "Fits the model to the log, reports where they disagree, tries every effect of the catalogue, names\n"
        "and adds what is missing, and reports what no effect explains. --improved-model writes the model\n"
        "with it; named .xml or .mjcf, for MuJoCo, with a list of what MuJoCo cannot represent.\nExample: "
        "ripplenotch diagnose log.csv --model model.json --validate other.csv --improved-model improved.json",
    .attach = attach_diagnose,
};

}  // namespace ripplenotch
