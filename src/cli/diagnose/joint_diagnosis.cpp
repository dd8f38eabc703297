// SPDX-License-Identifier: MIT
#include "cli/diagnose/joint_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>

#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "core/rows/row_facts.hpp"
#include "core/text/lower_case.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/verdict/drive.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// The rms that is left when the model's torque is that of what MuJoCo holds. `left`: what the whole model
// leaves.
double held_gap(const Model& whole, const Motion& motion, const std::vector<double>& left) {
    const std::vector<double> held = predict_nm(joint_mjcf(whole).held, motion);
    const std::vector<double> all = predict_nm(whole, motion);
    std::vector<double> gap(held.size());
    for (std::size_t k = 0; k < gap.size(); ++k) gap[k] = left[k] + all[k] - held[k];
    return rms(gap);
}

Motion motion_of(const DiagnoseRequest& request, const JointDiagnosis& one) {
    Motion motion = motion_along(one.log.trace.view(), request.smoothing);
    const std::vector<double>& beside = one.diagnosis.beside_given_nm;
    if (beside.empty()) return motion;
    motion.others_deg_s = one.given.others_deg_s;
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
        parts.not_held.push_back(
            {"arm", fmt::format(
                        "bodies and armature are those of {}; the log determines only combinations of masses",
                        *tree)});
    if (one.given.arm && !tree)
        parts.not_held.push_back({"arm", "its bodies are not in this file; --arm mjcf,file=FILE has them"});
    if (one.given.ripple) parts.not_held.push_back({"ripple", "its map is not in this file"});
    if (one.given.simulated) parts.not_held.push_back({"simulated", "its torque is not in this file"});
}

std::vector<std::string> mjcf_heading(const JointDiagnosis& one, const MjcfAccount& account) {
    std::vector<std::string> lines = heading_of(one.provenance);
    lines.push_back(fmt::format("measured less predicted torque: {} -> {} Nm rms with what is held",
                                short_number(account.before_nm), short_number(account.after_nm)));
    return lines;
}

}  // namespace

bool names_mjcf(std::string_view path) {
    const std::string name = lower_case(path);
    return name.ends_with(".xml") || name.ends_with(".mjcf");
}

std::string improved_mjcf(const DiagnoseRequest& request, JointDiagnosis& one, const std::string& path) {
    const ModelWithGiven model = improved_model(one.given, one.diagnosis);
    const std::optional<std::string> tree = tree_of(request, one);
    JointMjcf parts = joint_mjcf(model.model);
    add_given(parts, one, tree);
    const Motion motion = motion_of(request, one);
    const Diagnosis& found = one.diagnosis;
    one.mjcf = MjcfAccount{path, parts.holds, parts.not_held,
                           held_gap(found.baseline, motion, found.residual_before_nm),
                           held_gap(model.model, motion, found.residual_after_nm)};
    const std::vector<std::string> heading = mjcf_heading(one, *one.mjcf);
    return tree ? write_into_mjcf(parts, read_chain_file(*tree), *tree, model.arm->joint, heading)
                : write_mjcf(parts, one.joint.empty() ? "joint" : one.joint, heading);
}

std::string mjcf_text(const MjcfAccount& account) {
    const std::string held = joined(account.holds, ", ", [](const MjcfPart& part) {
        return fmt::format("{} ({})", part.effect, part.words);
    });
    std::string text = fmt::format("{}: MuJoCo holds {}; gap {} -> {} Nm with that alone\n", account.file,
                                   held.empty() ? "nothing of it" : held, short_number(account.before_nm),
                                   short_number(account.after_nm));
    for (const MjcfPart& part : account.not_held)
        text += fmt::format("{}: not held: {}: {}\n", account.file, part.effect, part.words);
    return text;
}

namespace {

// --model auto: the model that identify gives of the log itself.

/// What --model says for it.
constexpr std::string_view model_from_log = "auto";

// At one speed nothing tells an inertia from an offset.
bool speed_changes(const Trace& trace) {
    constexpr double enough = 0.1;  // of the fastest
    double slowest = std::numeric_limits<double>::infinity(), fastest = 0.0;
    for (const double speed : trace.velocity_deg_s) {
        if (!std::isfinite(speed)) continue;
        slowest = std::min(slowest, std::abs(speed));
        fastest = std::max(fastest, std::abs(speed));
    }
    return fastest > 0.0 && fastest - slowest > enough * fastest;
}

// Faster than the noise of a speed at rest.
bool moves(const Trace& trace) {
    constexpr double clear_deg_s = 0.5;  // by hand, as of the direction that a friction holds
    return std::ranges::any_of(trace.velocity_deg_s, [](double v) { return std::abs(v) > clear_deg_s; });
}

// The torque of --drive in the place of the log's; nothing without it.
std::optional<DrivenTorque> driven(const DiagnoseRequest& request, const ReadOptions& reading,
                                   const std::string& path, Log& log, std::size_t most_rows) {
    if (!request.drive) return std::nullopt;
    return apply_drive(read_drive(with_joint(*request.drive, log.trace.joint)), reading, path, log,
                       most_rows);
}

struct ModelOfLog {
    Model model;
    std::string source;  ///< of its gear ratio
};

// Gear ratio and ripple orders as identify finds them in the log of the request (--gear-ratio goes before
// what it finds), and an inertia where the speed changes. All values are left out, to be fitted. Where the
// log tells no gear ratio, the model has none: lines that turn with the joint are then a part of it by their
// cycles per turn of the joint, whatever they are lines of, so that they get no name.
ModelOfLog identified_model(const DiagnoseRequest& request, ReadOptions reading) {
    reading.gear_ratio = request.gear.ratio;
    reading.takes_motor_units = true;
    std::vector<Log> logs;
    logs.push_back(read_log_in_part(request.path, reading, most_rows_held));
    (void)driven(request, reading, request.path, logs.back(), most_rows_held);
    IdentifyOptions options;
    std::optional<GearRatio> stated;
    if (request.gear.ratio) options.hint = stated = GearRatio(*request.gear.ratio);
    const JointFile joint{request.path, request.path, identify_readings(logs, options)};
    const GearStatement facts = joint.facts(stated);
    if (!facts.ratio && !moves(logs.front().trace))
        raise<DataError>(
            "{}: --model auto: identify finds no gear ratio in it ({}), and at rest a ripple is an offset; "
            "give --gear-ratio N, or --model FILE",
            request.path, joint.found.verdict);
    if (!facts.ratio && logs.front().layout.motor_units)
        raise<DataError>(
            "{}: --model auto: the motion seems to be measured before the gear (named so, or too fast for a "
            "joint), and no ratio is known to bring it to the joint; use --gear-ratio N, or --side joint if "
            "it is the joint's",
            request.path);
    Model model{facts.ratio.value_or(GearRatio()), {}};
    if (speed_changes(logs.front().trace)) model.terms.push_back(parse_term("inertia"));
    if (facts.ratio) {
        for (const StatedOrder& order : facts.orders)
            model.terms.push_back(parse_term(fmt::format("ripple,order={}", shortest(order.value))));
        return {std::move(model), "identify"};
    }
    // Below it a line is of no gear, and may be the joint's own: gravity has order 1.
    constexpr double min_order = 3.0;
    for (const Line& line : joint.found.lines) {
        if (line.kind != LineKind::order || line.order_output.value_or(0.0) < min_order) continue;
        model.terms.push_back(
            parse_term(fmt::format("output-ripple,order={}", shortest(*line.order_output))));
    }
    return {std::move(model), "identify: " + joint.found.verdict};
}

// "gear ratio 100, inertia, ripple of orders 1 and 2".
std::string model_in_words(const Model& model) {
    std::string text = model.has_gear_ratio() ? fmt::format("gear ratio {:.6g}", model.gear_ratio.value())
                                              : "gear ratio not known";
    std::vector<std::string> orders;
    for (const Term& term : model.terms) {
        if (term.effect->name == "output-ripple") {
            text += fmt::format(", {:.6g} cycles per turn of the joint", *term.values.front());
        } else if (term.effect->name == "ripple") {
            orders.push_back(shortest(term.values.front().value_or(0.0)));
        } else {
            text += fmt::format(", {}", term.effect->name);
        }
    }
    if (!orders.empty())
        text += fmt::format(", ripple of order{} {}", orders.size() == 1 ? "" : "s",
                            fmt::join(orders, orders.size() == 2 ? " and " : ", "));
    return text;
}

void check_model(const DiagnoseRequest& request) {
    if (request.model.empty() && !request.given.any())
        raise<UsageError>(
            "--model is missing: the model.json whose gap to the log is to be explained; --model auto makes "
            "one of the log itself, from what identify finds in it, and --improved-model FILE writes it with "
            "what was added");
    if (request.model.empty() && !request.gear.ratio)
        raise<UsageError>("--gear-ratio is missing; give it, or --model FILE, which states it");
    if (!request.model.empty() && request.model != model_from_log && request.gear.ratio)
        raise<UsageError>("--gear-ratio: the model of {} states the gear ratio; change it there",
                          input_name(request.model));
    check_gear(request.gear);
    if (request.drive && request.given.arm)
        raise<UsageError>("--drive and --arm: a control law of one joint makes no torque of the others");
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
    if (request.common.plot) raise<UsageError>("--plot draws one joint, and --joint all asks for each");
    if (request.improved && !names_joint(*request.improved))
        raise<UsageError>(
            "--improved-model {}: each joint has a model of its own; put {{joint}} into the name",
            *request.improved);
}

}  // namespace

void check_improved(const DiagnoseRequest& request, std::string_view endings) {
    if (request.improved_by_output)
        warn(request.common, "--output of diagnose will mean the result; write --improved-model FILE");
    if (!request.improved) return;
    check_output_name(*request.improved, "a model", endings, "--improved-model");
    if (*request.improved == "-")
        raise<UsageError>("--improved-model -: the result goes to standard output; give a file");
}

void check(const DiagnoseRequest& request) {
    if (request.path.empty()) raise<UsageError>("LOG is missing: the measured log; - is standard input");
    check_model(request);
    if (request.validate && *request.validate == "-") raise<UsageError>("--validate -: give a file");
    if (request.smoothing.value() < 0.0)
        raise<UsageError>("--smoothing: {} s is below 0", shortest(request.smoothing.value()));
    for (const std::string& name : request.without) (void)find_effect(name);
    for (const std::string& name : request.accept) (void)find_effect(name);
    check_improved(request, ".json .xml .mjcf");
    check_joints(request);
    if (request.common.plot == "-" && request.common.json)
        raise<UsageError>("--plot - and --json would both go to standard output; name a file with --plot");
}

namespace {

// With all that is made of them, 256 MiB, also with an arm of seven joints, most of which is its columns
// along the samples searched.
constexpr std::size_t max_rows_diagnosed = std::size_t{1} << 17, max_rows_with_arm = 40'960;

// `source`: who gave its gear ratio.
ModelWithGiven model_of(const DiagnoseRequest& request, const std::string& path, const ReadOptions& reading,
                        Provenance& provenance, std::string& source) {
    if (path == model_from_log) {
        ModelOfLog made = identified_model(request, reading);
        say(request.common, fmt::format("the model is made of the log: {}; its values are fitted",
                                        model_in_words(made.model)));
        source = std::move(made.source);
        return {std::move(made.model)};
    }
    source = path.empty() ? "--gear-ratio" : input_name(path);
    if (path.empty()) return {{GearRatio(*request.gear.ratio), {}}};
    ModelWithGiven model = read_model_with_given(read_all(path), input_name(path));
    if (path != "-") provenance.inputs.push_back(input_record(path));
    return model;
}

// What another program has simulated stands row by row against all of the log.
std::size_t most_rows(const GivenOptions& options, const ModelWithGiven& model) {
    if (options.simulated || model.simulated) return all_rows;
    return options.arm || model.arm ? max_rows_with_arm : max_rows_diagnosed;
}

Log read(const DiagnoseRequest& request, std::size_t most_rows, const ReadOptions& reading,
         const std::string& path, Provenance& provenance) {
    // A pipe that is held needs no second pass.
    Log log = most_rows == all_rows ? read_log(path, reading) : read_log_in_part(path, reading, most_rows);
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

// A log of an arm of which nothing is known but this joint.
bool others_move(const JointDiagnosis& one) {
    return one.log.layout.joints.size() > 1 && one.given.log.empty();
}

// One controller has one clock: the delay of an arm's torques is known from all its joints, and is not
// searched in one of them, unless that one contradicts the others. Names that are not tried then.
std::vector<std::string> take_lag(const DiagnoseRequest& request, const JointDiagnosis& one, Model& model) {
    std::vector<std::string> without = request.without;
    const std::optional<ArmAccount>& arm = one.given.account;
    const bool has_delay =
        std::ranges::any_of(model.terms, [](const Term& term) { return term.effect->name == "delay"; });
    if (!arm || !arm->lag || has_delay) return without;
    if (arm->lag_is_applied) model.terms.push_back({&find_effect("delay"), {to_digits(arm->lag->delay_s)}});
    if (!arm->lag->contradicted_by(one.given.fitted_arm->find(one.joint))) without.emplace_back("delay");
    return without;
}

// The ripple that was found with the arm, an effect an order: the rms of its amplitude, the mean of its
// phases.
std::vector<Term> found_ripple(const GivenTerms& given) {
    std::vector<Term> terms;
    if (!given.ripple || !given.fitted_arm) return terms;
    const RippleMap& map = given.ripple->map;
    for (std::size_t i = 0; i < map.orders.size(); ++i) {
        const auto score =
            std::ranges::find(given.ripple->scores, map.orders[i].value(), &MapOrderScore::order);
        const std::complex<double> sum =
            std::accumulate(map.values[i].begin(), map.values[i].end(), std::complex<double>());
        terms.push_back(parse_term(fmt::format("ripple,order={},amplitude_nm={},phase_deg={}",
                                               shortest(map.orders[i].value()), shortest(score->ripple_nm),
                                               shortest(-portable::arg(sum) * degrees_per_radian))));
    }
    return terms;
}

Diagnosis diagnosed(const DiagnoseRequest& request, Model model, const JointDiagnosis& one,
                    const std::optional<Log>& other) {
    std::vector<std::string> without = take_lag(request, one, model);
    if (request.drive) without.emplace_back("saturation");  // its limit is the law's own
    const std::vector<Term> ripple = found_ripple(one.given);
    try {
        return diagnose_readings(
            model, one.log, other ? &*other : nullptr,
            {.smoothing = request.smoothing,
             .without = without,
             .accept = request.accept,
             .given = one.given.log,
             .validation_given = one.given.validation,
             .others_deg_s = one.given.others_deg_s,
             .validation_others_deg_s = one.given.validation_others_deg_s,
             .found_ripple = ripple,
             .simulated_velocity_deg_s = one.given.simulated_velocity_deg_s,
             .simulated_position_deg = one.given.simulated_position_deg,
             .setup = one.given.setup ? std::span<const SetupFault>(one.given.setup->faults)
                                      : std::span<const SetupFault>()});
    } catch (const DataError& error) {  // the library knows no file
        raise<DataError>("{}: {}", request.path, error.what());
    }
}

// What is given of the log, and rows that it does not span told.
GivenTerms given_of(const DiagnoseRequest& request, const ModelWithGiven& model, const ReadOptions& reading,
                    std::size_t most_rows, GivenSource& source, JointDiagnosis& one,
                    std::optional<Log>& other) {
    const GivenLog log{request.path, one.log, most_rows};
    std::optional<GivenLog> validation;
    if (other) validation.emplace(GivenLog{*request.validate, *other, most_rows});
    const std::size_t said = one.log.recording.warnings.size();
    GivenTerms given = source.read(model, reading, log, validation ? &*validation : nullptr);
    const auto& warnings = one.log.recording.warnings;
    say_warnings(request.common, {warnings.begin() + static_cast<std::ptrdiff_t>(said), warnings.end()});
    if (given.account) say_arm(request.common, *given.account);
    return given;
}

// Of an arm the motion of its other joints is torque of this one, which the effects of a joint may imitate.
void advise_arm(JointDiagnosis& one) {
    const bool is_of_position = std::ranges::any_of(one.diagnosis.rounds, [](const Finding& finding) {
        return finding.term.effect->domain == Domain::position || finding.term.effect->name == "gravity";
    });
    const bool is_open = is_of_position || one.diagnosis.remaining;
    if (!others_move(one) || !is_open) return;
    one.diagnosis.next.insert(
        one.diagnosis.next.begin(),
        fmt::format("the log has {} joints, and where the others move, their weight and acceleration act on "
                    "this one: --arm takes their motion into account",
                    one.log.layout.joints.size()));
}

}  // namespace

// Whether a ripple is missing is not known without the gear ratio.
bool JointDiagnosis::is_conclusive() const {
    if (!diagnosis.model.has_gear_ratio()) return false;
    return diagnosis.verdict == DiagnosisVerdict::matches || diagnosis.verdict == DiagnosisVerdict::explained;
}

JointDiagnosis diagnosed_joint(const DiagnoseRequest& request, const std::optional<std::string>& joint,
                               GivenSource& source, const std::string& command_line) {
    JointDiagnosis one;
    one.provenance.command = command_line;
    ReadOptions reading = request.drive ? without_torque(request.log) : request.log;
    if (joint) reading.joint = *joint;
    const std::string path = joint ? with_joint(request.model, *joint) : request.model;
    std::string ratio_source;
    ModelWithGiven model = model_of(request, path, reading, one.provenance, ratio_source);
    take_joint_of(model, reading.joint);
    one.gear = gear_of(model.model, std::move(ratio_source));
    say(request.common, gear_in_words(one.gear));
    reading = read_options(reading, one.gear);
    const std::size_t most = most_rows(request.given, model);
    one.log = read(request, most, reading, request.path, one.provenance);
    one.joint = one.log.trace.joint;
    const auto drive = driven(request, reading, request.path, one.log, most);
    std::optional<Log> other;
    if (request.validate) {
        other = read(request, most, reading, *request.validate, one.provenance);
        (void)driven(request, reading, *request.validate, *other, most);
    }
    one.given = given_of(request, model, reading, most, source, one, other);
    for (const std::string& file : one.given.files) one.provenance.inputs.push_back(input_record(file));
    Progress::current().begin("looking for what is missing", "", 0);
    one.diagnosis = diagnosed(request, model.model, one, other);
    if (drive)
        one.diagnosis.drive = drive_answer(read_drive(with_joint(*request.drive, one.joint)), *drive,
                                           one.diagnosis, motion_of(request, one), one.log.trace.view());
    advise_arm(one);
    if (one.given.setup) one.diagnosis.alignment = one.given.setup->shift;
    return one;
}

std::vector<std::string> joints_of(const DiagnoseRequest& request, GivenSource& given) {
    ReadOptions reading = request.drive ? without_torque(request.log) : request.log;
    std::vector<std::string> joints = joints_asked_for(request.path, reading).names;
    reading.joint.reset();
    if (!request.given.arm) return joints;
    // As each joint alone would read it.
    reading.gear_ratio = request.gear.ratio;
    const auto arm = given.arm(reading, request.path, most_rows(request.given, {}));
    const auto& known = arm->reading().names;
    std::erase_if(joints, [&](const std::string& joint) {
        const bool strange = std::find(known.begin(), known.end(), joint) == known.end();
        if (strange) say(request.common, fmt::format("{} is no joint of the arm and is left out", joint));
        return strange;
    });
    return joints;
}

}  // namespace ripplenotch
