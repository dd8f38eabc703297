// SPDX-License-Identifier: MIT
#include "cli/diagnose/joint_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/diagnose/model_from_log.hpp"
#include "cli/gear/joint_facts.hpp"
#include "cli/gear/joint_methods.hpp"
#include "cli/readings/readings.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_rows_diagnosed = std::size_t{1} << 17;  // with all that is made of them, 256 MiB

std::string source_of(const std::string& model) { return model == "-" ? "standard input" : model; }

ModelWithGiven model_of(const DiagnoseRequest& request, const std::string& path, const LogOptions& words,
                        Provenance& provenance) {
    if (path == model_from_log) {
        ModelWithGiven model{identified_model(request, words)};
        say(request.common, fmt::format("the model is made of the log: {}; its values are fitted",
                                        model_in_words(model.model)));
        return model;
    }
    if (path.empty()) return {{GearRatio(*request.gear.ratio), {}}};
    ModelWithGiven model = read_model_with_given(read_all(path), source_of(path));
    if (path != "-") provenance.inputs.push_back(input_record(path));
    return model;
}

// What is given beside the log stands row by row against all of it.
Log read(const DiagnoseRequest& request, bool given, const ReadOptions& reading, const std::string& path,
         Provenance& provenance) {
    Log log = given ? read_log(path, reading) : read_log_in_part(path, reading, most_rows_diagnosed);
    say_layout(request.common, log.layout);
    say_warnings(request.common, log.recording.warnings);
    provenance.recordings.push_back({log.recording});
    if (path == "-") return log;
    provenance.inputs.push_back(input_record(path));
    provenance.inputs.back().rows = log.recording.rows();
    return log;
}

void say_arm(const CommonOptions& common, const ArmAccount& arm) {
    for (const JointTravel& joint : arm.joints)
        say(common, fmt::format("arm: {} is {} of the log, and goes {:.3g} deg", joint.name,
                                joint.log.empty() ? "the joint" : joint.log, joint.travel_deg));
    say(common, fmt::format("arm: as if with {}", arm.option));
    for (const std::string& note : arm.notes) say(common, note);
    say_warnings(common, arm.warnings);
}

Diagnosis diagnosed(const DiagnoseRequest& request, const Model& model, const JointDiagnosis& one,
                    const std::optional<Log>& other) {
    try {
        return diagnose_readings(model, one.log, other ? &*other : nullptr,
                                 {.smoothing = request.smoothing,
                                  .without = request.without,
                                  .accept = request.accept,
                                  .given = one.given.log,
                                  .validation_given = one.given.validation,
                                  .rules = rules_of(request)});
    } catch (const DataError& error) {  // the library knows no file
        raise<DataError>("{}: {}", request.path, error.what());
    }
}

// What is given of the log, and rows that it does not span told.
GivenTerms given_of(const DiagnoseRequest& request, const ModelWithGiven& model, const ReadOptions& reading,
                    GivenSource& source, JointDiagnosis& one, std::optional<Log>& other) {
    const GivenLog log{request.path, one.log};
    std::optional<GivenLog> validation;
    if (other) validation.emplace(GivenLog{*request.validate, *other});
    const std::size_t said = one.log.recording.warnings.size();
    GivenTerms given = source.read(model, reading, log, validation ? &*validation : nullptr);
    const auto& warnings = one.log.recording.warnings;
    say_warnings(request.common, {warnings.begin() + static_cast<std::ptrdiff_t>(said), warnings.end()});
    if (given.account) say_arm(request.common, *given.account);
    return given;
}

}  // namespace

bool JointDiagnosis::is_conclusive() const {
    return diagnosis.verdict == DiagnosisVerdict::matches || diagnosis.verdict == DiagnosisVerdict::explained;
}

JointDiagnosis diagnosed_joint(const DiagnoseRequest& request, const std::optional<std::string>& joint,
                               GivenSource& source, const std::string& command_line) {
    JointDiagnosis one;
    one.provenance.command = command_line;
    LogOptions words = request.log;
    if (joint) words.joint = *joint;
    const std::string path = joint ? with_joint(request.model, *joint) : request.model;
    const ModelWithGiven model = model_of(request, path, words, one.provenance);
    take_joint_of(model, words.joint);
    one.gear = gear_of(model.model, path.empty()             ? "--gear-ratio"
                                    : path == model_from_log ? "identify"
                                                             : source_of(path));
    say(request.common, gear_in_words(one.gear));
    const ReadOptions reading = read_options(words, one.gear);
    const bool given = request.given.any() || model.any_given();
    one.log = read(request, given, reading, request.path, one.provenance);
    one.joint = one.log.trace.joint;
    std::optional<Log> other;
    if (request.validate) other = read(request, given, reading, *request.validate, one.provenance);
    one.given = given_of(request, model, reading, source, one, other);
    for (const std::string& file : one.given.files) one.provenance.inputs.push_back(input_record(file));
    Progress::current().begin("looking for what is missing", "", 0);
    one.diagnosis = diagnosed(request, model.model, one, other);
    add_stated_nuisance(one.given, one.diagnosis);
    return one;
}

std::vector<std::string> joints_of(const DiagnoseRequest& request, GivenSource& given) {
    LogOptions words = request.log;
    words.joint.reset();
    ReadOptions reading = words.resolve(), survey = reading;
    survey.needs_torque = false;
    survey.takes_motor_units = true;
    std::vector<std::string> joints = open_log(request.path, survey)->layout().joints;
    if (!request.given.arm) return joints;
    // As each joint alone would read it.
    reading.gear_ratio = request.gear.ratio;
    const auto arm = given.arm(reading, request.path);
    const auto& known = arm->reading().names;
    std::erase_if(joints, [&](const std::string& joint) {
        const bool strange = std::find(known.begin(), known.end(), joint) == known.end();
        if (strange) say(request.common, fmt::format("{} is no joint of the arm and is left out", joint));
        return strange;
    });
    return joints;
}

}  // namespace ripplenotch
