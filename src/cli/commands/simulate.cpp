// SPDX-License-Identifier: MIT
// ripplenotch simulate: a log from a joint model and a motion.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "cli/command.hpp"
#include "ripplenotch/artifact/model.hpp"
#include "ripplenotch/artifact/simulation.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/noise.hpp"

namespace ripplenotch {
namespace {

struct SimulateOptions {
    CommonOptions common;
    std::optional<std::string> model, format;
    std::optional<double> gear_ratio, inertia_kgm2;
    std::vector<std::string> ripples, effects, motions;
    std::optional<Hertz> sample_rate;
    NewtonMeters noise;
    DegPerSec velocity_noise;
    int seed = 1;
    std::optional<double> decimals;
    bool no_position = false;
    std::function<std::string()> command_line;
};

// Up to this, an angle of thousands of degrees times 10^decimals is still a whole number that a double holds.
constexpr double most_decimals = 12.0;

// "1:0.8Nm:0deg" is order, amplitude, phase; the phase may be left out.
Term parse_ripple(const std::string& text) {
    std::vector<std::string> pieces;
    std::istringstream stream(text);
    for (std::string piece; std::getline(stream, piece, ':');) pieces.push_back(piece);
    if (pieces.size() == 2) pieces.emplace_back("0deg");
    if (pieces.size() != 3) {
        raise<UsageError>(
            "--ripple: '{}' is not ORDER:AMPLITUDE or ORDER:AMPLITUDE:PHASE, for example 1:0.8Nm:0deg", text);
    }
    return parse_term(
        fmt::format("ripple,order={},amplitude_nm={},phase_deg={}", pieces[0], pieces[1], pieces[2]));
}

Model assemble_model(const SimulateOptions& options) {
    Model model;
    if (options.model) {
        const std::string source = *options.model == "-" ? "standard input" : *options.model;
        if (options.gear_ratio) {
            raise<UsageError>("--gear-ratio: the model of {} states the gear ratio; change it there", source);
        }
        model = read_model(read_all(*options.model), source);
    } else {
        if (!options.gear_ratio)
            raise<UsageError>("--gear-ratio is missing; give it, or --model FILE, which states it");
        model.gear_ratio = GearRatio(*options.gear_ratio);
        if (!(*options.gear_ratio > 0.0) || model.gear_ratio > largest_gear_ratio) {
            raise<UsageError>("--gear-ratio: {} is not above 0 and at most {}", shortest(*options.gear_ratio),
                              shortest(largest_gear_ratio.value()));
        }
    }
    if (options.inertia_kgm2) {
        model.terms.push_back(
            parse_term(fmt::format("inertia,inertia_kgm2={}", shortest(*options.inertia_kgm2))));
    }
    for (const std::string& ripple : options.ripples) model.terms.push_back(parse_ripple(ripple));
    for (const std::string& effect : options.effects) model.terms.push_back(parse_term(effect));
    return model;
}

// The double nearest to the decimal, so that its shortest text has no more decimals than asked for. No
// negative zero.
void round_to(std::vector<double>& values, const std::optional<double>& decimals) {
    if (!decimals) return;
    double scale = 1.0;
    for (int i = 0; i < static_cast<int>(*decimals); ++i) scale *= 10.0;
    for (double& value : values) value = std::round(value * scale) / scale + 0.0;
}

std::vector<NumberColumn> make_columns(const SimulateOptions& options, const Model& model, Motion motion) {
    const auto seed = static_cast<std::uint64_t>(options.seed);
    std::vector<double> noise_nm(motion.size(), 0.0);
    add_noise(noise_nm, options.noise.value(), 0.0, seed, NoiseChannel::torque);
    std::vector<double> torque_nm = measure_nm(model, motion, noise_nm);
    add_noise(motion.velocity_deg_s, options.velocity_noise.value(), 0.0, seed, NoiseChannel::velocity);
    std::vector<NumberColumn> columns;
    columns.push_back({"time_s", std::move(motion.time_s)});
    columns.push_back({"velocity_deg_s", std::move(motion.velocity_deg_s)});
    columns.push_back({"torque_nm", std::move(torque_nm)});
    if (!options.no_position) columns.push_back({"position_deg", std::move(motion.position_deg)});
    for (std::size_t i = 1; i < columns.size(); ++i) round_to(columns[i].values, options.decimals);
    return columns;
}

void check(const SimulateOptions& options) {
    if (options.motions.empty()) {
        raise<UsageError>("--motion is missing, for example --motion constant,speed=60deg/s,duration=5s");
    }
    if (!options.sample_rate) raise<UsageError>("--sample-rate is missing, for example --sample-rate 1kHz");
    if (options.noise.value() < 0.0)
        raise<UsageError>("--noise: {} Nm is below 0", shortest(options.noise.value()));
    if (options.velocity_noise.value() < 0.0) {
        raise<UsageError>("--velocity-noise: {} deg/s is below 0", shortest(options.velocity_noise.value()));
    }
    if (options.decimals && (*options.decimals < 0.0 || *options.decimals > most_decimals ||
                             *options.decimals != std::floor(*options.decimals))) {
        raise<UsageError>("--decimals: {} is not a whole number from 0 to {}", shortest(*options.decimals),
                          shortest(most_decimals));
    }
    if (options.common.json && options.common.output == "-") {
        raise<UsageError>("--json puts a summary on standard output; say where the log goes with -o FILE");
    }
}

std::string summary(const SimulateOptions& options, const Model& model,
                    const std::vector<NumberColumn>& columns) {
    Simulation made{.model = model,
                    .motions = options.motions,
                    .sample_rate = *options.sample_rate,
                    .seed = static_cast<std::uint64_t>(options.seed),
                    .noise_rms = options.noise,
                    .velocity_noise_rms = options.velocity_noise,
                    .rows = columns[0].values.size(),
                    .columns = {},
                    .output = options.common.output,
                    .output_sha256 = sha256_of_file(options.common.output)};
    for (const NumberColumn& column : columns) made.columns.push_back(column.name);
    const auto slower = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const auto [slow, fast] = std::minmax_element(columns[1].values.begin(), columns[1].values.end(), slower);
    const auto [low, high] = std::minmax_element(columns[2].values.begin(), columns[2].values.end());
    made.speed_min_deg_s = std::abs(*slow);
    made.speed_max_deg_s = std::abs(*fast);
    made.torque_min_nm = *low;
    made.torque_max_nm = *high;
    Provenance provenance{.inputs = {}, .command = options.command_line()};
    if (options.model && *options.model != "-") {
        provenance.inputs.push_back({*options.model, sha256_of_file(*options.model), std::nullopt});
    }
    return write_simulation(made, provenance);
}

ExitCode simulate(const SimulateOptions& options) {
    check(options);
    const LogFormat& format = output_format(options.common.output, options.format);
    const Model model = assemble_model(options);
    ByteSink sink(options.common.output, options.common.overwrite(), format.binary);
    const auto columns = make_columns(options, model, make_motion(options.motions, *options.sample_rate));
    format.write_columns(sink, columns);
    sink.finish();
    say(options.common, fmt::format("{} rows of {} columns at {} Hz as {}", columns[0].values.size(),
                                    columns.size(), shortest(options.sample_rate->value()), format.name));
    if (options.common.json) write_all("-", summary(options, model, columns), ByteSink::Overwrite::no);
    return ExitCode::done;
}

template <class Entry>
std::string names(std::span<const Entry* const> entries) {
    std::string joined;
    for (const Entry* entry : entries) joined += fmt::format("{}{}", joined.empty() ? "" : ", ", entry->name);
    return joined;
}

std::function<ExitCode()> attach(Options& options) {
    auto o = std::make_shared<SimulateOptions>();
    options.text("--model", o->model, "FILE", "model.json of the joint; - is standard input");
    options.number("--gear-ratio", o->gear_ratio, Dimension::none, "motor revolutions per output revolution");
    options.number("--inertia", o->inertia_kgm2, Dimension::inertia, "adds the effect inertia");
    options.texts("--ripple", o->ripples, "ORDER:AMPLITUDE[:PHASE]",
                  "adds the effect ripple: 1:0.8Nm:0deg; repeatable");
    options.texts("--effect", o->effects, "NAME,KEY=VALUE,...",
                  "adds any effect: offset,torque_nm=0.2; repeatable; 'ripplenotch effects' lists them");
    options.texts(
        "--motion", o->motions, "NAME,KEY=VALUE,...",
        fmt::format("how the joint moves: constant,speed=60deg/s,duration=5s; repeated ones follow one "
                    "another; motions: {}",
                    names(motion_kinds())));
    options.quantity("--sample-rate", o->sample_rate, Dimension::frequency, "samples per second");
    options.quantity("--noise", o->noise, Dimension::torque, "rms of white noise on the torque");
    options.quantity("--velocity-noise", o->velocity_noise, Dimension::speed,
                     "rms of white noise on the velocity");
    options.count("--seed", o->seed, 0, 2147483647, "which noise; the same seed gives the same bytes");
    options.number(
        "--decimals", o->decimals, Dimension::none,
        "decimals of every column but time (default: as many as needed to read the same number back)");
    options.flag("--no-position", o->no_position, "leave the position column out");
    options.text("--format", o->format, "NAME",
                 "format of the log: csv, npy (default: by the extension of -o, else csv)");
    attach_common(options, o->common);
    o->command_line = [&options] { return options.command_line(); };
    return [o] { return simulate(*o); };
}

}  // namespace

const Command commands::simulate{
    .name = "simulate",
    .summary = "a log from a joint model and a motion",
    .description =
        "Writes a log with the columns time_s, velocity_deg_s, torque_nm, position_deg. The torque is the "
        "sum of the\n"
        "model's effects along the motion, with white noise on top.\n"
        "Example: ripplenotch simulate --gear-ratio 100 --ripple 1:0.8Nm --motion "
        "constant,speed=60deg/s,duration=5s \\\n"
        "           --sample-rate 1kHz --noise 0.05Nm --seed 1 -o log.csv",
    .attach = attach,
};

}  // namespace ripplenotch
