// SPDX-License-Identifier: MIT
// ripplenotch simulate: a log from a joint model and a motion.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/document/simulation_json.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/noise.hpp"
#include "ripplenotch/verdict/drive.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/given_terms.hpp"

namespace ripplenotch {

namespace {

// The joint model that a command is given: a file, options, or a file with options on top.

// --model, --gear-ratio, --inertia, --ripple, --effect.
struct JointModelOptions {
    std::optional<std::string> model;
    GearOptions gear;  //< a ratio alone
    std::optional<double> inertia_kgm2;
    std::vector<std::string> ripples, effects;
};

// "1:0.8Nm:0deg" is order, amplitude, phase; the phase may be left out.
Term parse_ripple(const std::string& text) {
    const auto pieces = split(text, ':');
    if ((pieces.size() != 2 && pieces.size() != 3) || pieces[1].empty()) {
        raise<UsageError>(
            "--ripple: '{}' is not ORDER:AMPLITUDE or ORDER:AMPLITUDE:PHASE, for example 1:0.8Nm:0deg", text);
    }
    return parse_term(fmt::format("ripple,order={},amplitude_nm={},phase_deg={}", pieces[0], pieces[1],
                                  pieces.size() == 3 && !pieces[2].empty() ? pieces[2] : "0deg"));
}

// With what is given beside the effects; only a command that has a log knows what to do with that, and
// `takes_given` says so: otherwise it is refused. Throws UsageError, DataError, FileError.
ModelWithGiven assemble_model(const JointModelOptions& options, bool takes_given) {
    ModelWithGiven whole;
    Model& model = whole.model;
    check_gear(options.gear);
    if (options.model) {
        const std::string source = input_name(*options.model);
        if (options.gear.ratio) {
            raise<UsageError>("--gear-ratio: the model of {} states the gear ratio; change it there", source);
        }
        const std::string text = read_all(*options.model);
        if (takes_given)
            whole = read_model_with_given(text, source);
        else
            model = read_model(text, source);
    } else {
        if (!options.gear.ratio)
            raise<UsageError>("--gear-ratio is missing; give it, or --model FILE, which states it");
        model.gear_ratio = GearRatio(*options.gear.ratio);
    }
    if (options.inertia_kgm2) {
        model.terms.push_back(
            parse_term(fmt::format("inertia,inertia_kgm2={}", shortest(*options.inertia_kgm2))));
    }
    for (const std::string& ripple : options.ripples) model.terms.push_back(parse_ripple(ripple));
    for (const std::string& effect : options.effects) model.terms.push_back(parse_term(effect));
    return whole;
}

// The gear of the assembled model, with what was typed or read as its source.
GearAccount assembled_gear(const JointModelOptions& joint, const Model& model) {
    std::string source = joint.model ? input_name(*joint.model) : "--gear-ratio";
    if (!joint.ripples.empty()) source += ", --ripple";
    return gear_of(model, std::move(source));
}

void attach_joint_model(Options& options, JointModelOptions& joint) {
    options.text("--model", joint.model, "FILE", "model.json of the joint; - is standard input");
    attach_gear(options, joint.gear, {.orders = "", .joint_file = ""});
    options.number("--inertia", joint.inertia_kgm2, Dimension::inertia, "adds the effect inertia");
    options.texts("--ripple", joint.ripples, "ORDER:AMPLITUDE[:PHASE]",
                  "adds the effect ripple: 1:0.8Nm:0deg; repeatable");
    options.texts(
        "--effect", joint.effects, "NAME,KEY=VALUE,...",
        "adds any effect: offset,torque_nm=0.2; repeatable; 'ripplenotch diagnose --effects' lists them");
}

struct SimulateOptions {
    CommonOptions common;
    JointModelOptions joint;
    ReadOptions log_options;
    std::string log;  ///< empty: motions are given
    std::optional<std::string> simulated, drive;
    std::optional<std::string> format;
    std::vector<std::string> motions;
    Seconds smoothing = default_smoothing;
    NewtonMeters noise;
    double noise_correlation = 0.0;
    DegPerSec velocity_noise;
    int seed = 1;
    std::optional<double> decimals;
    bool no_position = false, faults = false;
    std::function<std::string()> command_line;

    [[nodiscard]] bool along_log() const { return !log.empty(); }
};

/// What the model is moved along, and what the log that is written shows of it.
struct Course {
    Motion motion;
    std::vector<double> velocity_deg_s;  ///< of a log: as logged, not smoothed
    std::vector<double> measured_nm;     ///< empty without a log
    bool has_position = true;
    std::vector<Recording> recordings = {};  ///< of a log
};

// Up to this, an angle of thousands of degrees times 10^decimals is still a whole number that a double holds.
constexpr double max_decimals = 12.0;

// The double nearest to the decimal, so that its shortest text has no more decimals than asked for. No
// negative zero.
void round_to(std::vector<double>& values, const std::optional<double>& decimals) {
    if (!decimals) return;
    double scale = 1.0;
    for (int i = 0; i < static_cast<int>(*decimals); ++i) scale *= 10.0;
    for (double& value : values) value = std::round(value * scale) / scale + 0.0;
}

Course course_of(const SimulateOptions& options, const ModelWithGiven& model) {
    if (!options.along_log()) {
        Motion motion = make_motion(options.motions, *options.log_options.sample_rate);
        std::vector<double> velocity_deg_s = motion.velocity_deg_s;
        return {std::move(motion), std::move(velocity_deg_s), {}, true};
    }
    ReadOptions reading = read_options(options.log_options, assembled_gear(options.joint, model.model));
    take_joint_of(model, reading.joint);
    if (options.drive) reading = without_torque(reading);
    Log log = read_log(options.log, reading);
    say_layout(options.common, log.layout);
    if (options.drive) {
        const DriveLaw law = read_drive(with_joint(*options.drive, log.trace.joint));
        say(options.common, drive_words(apply_drive(law, reading, options.log, log)));
    }
    KnownAlong known = stated_along({options.simulated, std::nullopt}, model, reading, {options.log, log});
    say_warnings(options.common, log.recording.warnings);
    Motion motion = motion_along(log.trace.view(), options.smoothing);
    motion.known_nm = std::move(known.known_nm);
    motion.others_deg_s = std::move(known.others_deg_s);
    return {std::move(motion),
            log.trace.velocity_deg_s,
            log.trace.torque_nm,
            log.trace.view().has_position(),
            {{log.recording}}};
}

// Along a log the result is a prediction, and which samples spikes and dropouts hit cannot be predicted.
Chance chance_of(const SimulateOptions& options) {
    return options.along_log() && !options.faults ? Chance::left_out : Chance::acts;
}

std::vector<NumberColumn> make_columns(const SimulateOptions& options, const Model& model, Course course) {
    const auto seed = static_cast<std::uint64_t>(options.seed);
    std::vector<double> noise_nm(course.motion.size(), 0.0);
    add_noise(noise_nm, {.rms = options.noise.value(), .correlation = options.noise_correlation}, seed,
              NoiseChannel::torque);
    std::vector<double> torque_nm = measure_nm(model, course.motion, noise_nm, chance_of(options));
    add_white_noise(course.velocity_deg_s, options.velocity_noise.value(), seed, NoiseChannel::velocity);
    std::vector<NumberColumn> columns;
    columns.push_back({"time_s", std::move(course.motion.time_s)});
    columns.push_back({"velocity_deg_s", std::move(course.velocity_deg_s)});
    columns.push_back({"torque_nm", std::move(torque_nm)});
    if (!options.no_position && course.has_position)
        columns.push_back({"position_deg", std::move(course.motion.position_deg)});
    for (std::size_t i = 1; i < columns.size(); ++i) round_to(columns[i].values, options.decimals);
    return columns;
}

std::optional<Followed> followed(const SimulateOptions& options, const Model& model, const Course& course) {
    if (!options.along_log()) return std::nullopt;
    std::vector<double> residual_nm = course.measured_nm;
    auto predicted_nm = predict_nm(model, course.motion);
    for (std::size_t k = 0; k < residual_nm.size(); ++k) residual_nm[k] -= predicted_nm[k];
    return Followed{options.smoothing, rms(course.measured_nm), rms(residual_nm)};
}

void check_course(const SimulateOptions& options) {
    if (options.along_log()) {
        if (!options.motions.empty())
            raise<UsageError>("--motion and a LOG: the motion is that of the log; give one of them");
        if (options.log == "-" && options.joint.model == "-")
            raise<UsageError>("--model - and LOG -: standard input holds one of them");
        if (options.smoothing.value() < 0.0)
            raise<UsageError>("--smoothing: {} s is below 0", shortest(options.smoothing.value()));
        if (options.log_options.sample_rate && !(options.log_options.sample_rate->value() > 0.0))
            raise<UsageError>("--sample-rate: must be above 0 Hz");
        return;
    }
    if (options.log_options.range.given())
        raise<UsageError>("--from and --to: there is no LOG to select rows from");
    if (options.simulated) raise<UsageError>("--simulated: needs a LOG, and there is none");
    if (options.drive) raise<UsageError>("--drive: needs a LOG, and there is none");
    if (options.motions.empty()) {
        raise<UsageError>(
            "--motion is missing, for example --motion constant,speed=60deg/s,duration=5s, or a LOG");
    }
    if (!options.log_options.sample_rate)
        raise<UsageError>("--sample-rate is missing, for example --sample-rate 1kHz");
}

void check_simulate(const SimulateOptions& options) {
    check_course(options);
    if (options.noise.value() < 0.0)
        raise<UsageError>("--noise: {} Nm is below 0", shortest(options.noise.value()));
    if (!(options.noise_correlation >= 0.0 && options.noise_correlation < 1.0)) {
        raise<UsageError>("--noise-correlation: {} is not from 0 to below 1",
                          shortest(options.noise_correlation));
    }
    if (options.velocity_noise.value() < 0.0) {
        raise<UsageError>("--velocity-noise: {} deg/s is below 0", shortest(options.velocity_noise.value()));
    }
    if (options.decimals && (*options.decimals < 0.0 || *options.decimals > max_decimals ||
                             *options.decimals != std::floor(*options.decimals))) {
        raise<UsageError>("--decimals: {} is not a whole number from 0 to {}", shortest(*options.decimals),
                          shortest(max_decimals));
    }
    if (options.common.json && options.common.output == "-") {
        raise<UsageError>("--json puts a summary on standard output; state where the log goes with -o FILE");
    }
}

// Of the file as it will be written.
std::function<std::string()> summary(const SimulateOptions& options, const Model& model, Hertz sample_rate,
                                     std::vector<Recording> recordings,
                                     const std::optional<Followed>& followed,
                                     const std::vector<NumberColumn>& columns) {
    Simulation made{.model = model,
                    .gear = assembled_gear(options.joint, model),
                    .motions = options.motions,
                    .sample_rate = sample_rate,
                    .seed = static_cast<std::uint64_t>(options.seed),
                    .followed = followed,
                    .noise_rms = options.noise,
                    .noise_correlation = options.noise_correlation,
                    .velocity_noise_rms = options.velocity_noise,
                    .rows = columns[0].values.size(),
                    .columns = {},
                    .output = options.common.output,
                    .output_sha256 = {}};
    for (const NumberColumn& column : columns) made.columns.push_back(column.name);
    const auto slower = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const auto [slow, fast] = std::minmax_element(columns[1].values.begin(), columns[1].values.end(), slower);
    const auto [low, high] = std::minmax_element(columns[2].values.begin(), columns[2].values.end());
    made.speed_min_deg_s = std::abs(*slow);
    made.speed_max_deg_s = std::abs(*fast);
    made.torque_min_nm = *low;
    made.torque_max_nm = *high;
    Provenance provenance{{}, options.command_line(), std::move(recordings)};
    if (options.joint.model && *options.joint.model != "-")
        provenance.inputs.push_back(input_record(*options.joint.model));
    if (options.along_log() && options.log != "-") {
        provenance.inputs.push_back(input_record(options.log));
        provenance.inputs.back().rows = made.rows;
    }
    return [made, provenance]() mutable {
        made.output_sha256 = sha256_of_file(made.output);
        return write_simulation(made, provenance);
    };
}

Answer simulate(const SimulateOptions& options) {
    check_simulate(options);
    const LogFormat& format = output_format(options.common.output, options.format);
    const ModelWithGiven whole = assemble_model(options.joint, options.along_log());
    const Model& model = whole.model;
    say(options.common, gear_in_words(assembled_gear(options.joint, model)));
    Course course = course_of(options, whole);
    std::vector<Recording> recordings = std::move(course.recordings);
    const Hertz sample_rate =
        recordings.empty() ? course.motion.sample_rate : recordings.front().clock.nominal_rate;
    Progress::current().begin("simulating", "", 0);
    const auto gap = followed(options, model, course);
    Answer answer{
        .columns = make_columns(options, model, std::move(course)), .format = &format, .own_output = true};
    const auto& columns = answer.columns;
    say(options.common, fmt::format("{} rows of {} columns at {} Hz as {}", columns[0].values.size(),
                                    columns.size(), shortest(sample_rate.value()), format.name));
    if (gap) {
        say(options.common, fmt::format("measured less modelled torque: {:.4g} Nm rms of {:.4g} Nm rms",
                                        gap->residual_rms_nm, gap->measured_rms_nm));
    }
    answer.document = summary(options, model, sample_rate, std::move(recordings), gap, columns);
    return answer;
}

std::function<Answer()> attach_simulate(Options& options) {
    auto o = std::make_shared<SimulateOptions>();
    options.argument("LOG", o->log, false, "log whose measured motion is used instead of --motion");
    attach_joint_model(options, o->joint);
    options.text("--simulated", o->simulated, "SPEC",
                 "with a LOG: torque of your own simulation as a part of the model, tau_model,scale=1 (a "
                 "column) or log,file=sim.csv,column=torque,scale=1");
    attach_drive(options, o->drive);
    options.texts("--motion", o->motions, "NAME,KEY=VALUE,...",
                  fmt::format("how the joint moves: constant,speed=60deg/s,duration=5s; repeated ones follow "
                              "one another; motions: {}",
                              name_list(motion_kinds())));
    options.number("--sample-rate", o->log_options.sample_rate, Dimension::frequency,
                   "samples per second; with a LOG, instead of its own time");
    options.number("--smoothing", o->smoothing, Dimension::time,
                   "window of the fit to a LOG's velocity, which gives speed and acceleration");
    options.number("--noise", o->noise, Dimension::torque, "rms of noise on the torque");
    options.number("--noise-correlation", o->noise_correlation, Dimension::none,
                   "--noise: its correlation with that of the sample before; 0 is white");
    options.number("--velocity-noise", o->velocity_noise, Dimension::speed,
                   "rms of white noise on the velocity");
    options.count("--seed", o->seed, 0, 2147483647, "which noise; the same seed gives the same bytes");
    options.number(
        "--decimals", o->decimals, Dimension::none,
        "decimals of every column but time (default: as many as needed to read the same number back)");
    options.flag("--faults", o->faults, "--model: let spikes and dropouts act along a LOG too");
    options.flag("--no-position", o->no_position, "--motion: leave the position column out");
    options.text("--format", o->format, "NAME",
                 fmt::format("format of what is written: {} (default: by the extension of -o, else csv)",
                             written_log_formats()));
    attach_log_columns(options, o->log_options);
    attach_common(options, o->common, {});
    o->command_line = [&options] { return options.command_line(); };
    return [o] { return simulate(*o); };
}

}  // namespace

const Command commands::simulate{
    .name = "simulate",
    .summary = "a log from a joint model and a motion",
    .description =
        "Writes a log with the columns time_s, velocity_deg_s, torque_nm, position_deg. The torque is the\n"
        "sum of the model's effects along a motion that is given, or that of a LOG, and noise.\n"
        "Example: ripplenotch simulate --gear-ratio 100 --ripple 1:0.8Nm --motion "
        "constant,speed=60deg/s,duration=5s \\\n"
        "           --sample-rate 1kHz --noise 0.05Nm --seed 1 -o log.csv",
    .attach = attach_simulate,
};

}  // namespace ripplenotch
