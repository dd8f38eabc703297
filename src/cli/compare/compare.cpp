// SPDX-License-Identifier: MIT
// ripplenotch compare: several methods side by side on a log, a step or a ramp.

#include "cli/compare/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/compare/comparison_view.hpp"
#include "cli/gear/chosen_method.hpp"
#include "cli/gear/gear_choice.hpp"
#include "cli/options/lists.hpp"
#include "cli/options/options.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/readings/side_column.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/chart/comparison_figure.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/design/guarantee.hpp"
#include "ripplenotch/document/comparison_json.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/match_low_pass.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

namespace {

// The nearer to what the user typed outside the methods, the better.
int rank_of(const Contender& contender) {
    if (!contender.gear) return 3;
    if (contender.table) return 2;
    return contender.made_for() ? 1 : 0;
}

const Method& control_method() {
    const auto all = ripplenotch::methods();
    return **std::find_if(all.begin(), all.end(),
                          [](const Method* method) { return method->part == MethodPart::control; });
}

std::optional<GearAccount> common_gear(const std::vector<Contender>& contenders) {
    const auto best =
        std::min_element(contenders.begin(), contenders.end(),
                         [](const Contender& a, const Contender& b) { return rank_of(a) < rank_of(b); });
    if (!best->gear) return std::nullopt;
    for (const Contender& contender : contenders) refuse_other_gear(contender, *best->gear);
    return best->gear;
}

// The methods as they are on this log: at its temperature, where a map asks for one. The same without a log.
std::vector<std::string> methods_at(const std::string& log, std::vector<std::string> methods,
                                    const LogOptions& options) {
    if (log.empty()) return methods;
    ReadOptions read = read_options(options, std::nullopt);
    read.takes_motor_units = true;
    for (std::string& method : methods) method = at_log_temperature(method, log, read);
    return methods;
}

// By contender, the temperature that it follows at the rows that read_log_in_part gives; empty for others.
// Says how many cells were none.
std::vector<std::vector<double>> temperatures_for(std::span<const Contender> contenders,
                                                  const std::string& log, const ReadOptions& read,
                                                  const CommonOptions& common) {
    std::vector<std::vector<double>> all;
    std::vector<std::string> notes;
    for (const Contender& contender : contenders) all.push_back(followed_values(contender, log, read, notes));
    notes.erase(std::unique(notes.begin(), notes.end()), notes.end());
    say_warnings(common, notes);
    return all;
}

// Throws UsageError when `methods` is empty, and what choose_method and refuse_other_gear throw.
Field load_contenders(const std::vector<std::string>& methods, const GearOptions& gear,
                      Provenance& provenance) {
    if (methods.empty()) {
        raise<UsageError>(
            "nothing to compare; give --method, for example --method fixed,centers=25Hz:50Hz,q=0.25 "
            "--method lowpass,cutoff=13rad/s");
    }
    const GearChoice choice(gear);
    Field field;
    std::set<std::string> recorded;
    const auto add = [&](const std::string& text) {
        const Contender& added = field.contenders.emplace_back(choose_method(text, std::nullopt, choice));
        if (!field.table) field.table = added.table;
        for (const std::string& file : added.files)
            if (recorded.insert(file).second) provenance.inputs.push_back(input_record(file));
    };
    const auto is_control = [](const std::string& text) {
        return find_method(parse_spec(text).name).part == MethodPart::control;
    };
    if (std::none_of(methods.begin(), methods.end(), is_control)) add(std::string(control_method().name));
    for (const std::string& text : methods) add(text);
    field.gear = common_gear(field.contenders);
    if (!field.gear && !gear.orders.empty()) raise_no_gear("--orders");
    return field;
}

// Warns when a method's table is for a slightly different rate, and throws DataError when it is for another.
void check_table_rates(const Field& field, Hertz sample_rate, const std::string& source,
                       const CommonOptions& common) {
    for (const Contender& contender : field.contenders) {
        if (!contender.table) continue;
        const auto warning =
            compare_table_rate({.table = contender.table->spec().sample_rate, .log = sample_rate}, source);
        if (warning) say_warnings(common, {&*warning, 1});
    }
}

void attach_costs(Options& options, CostRequest& request) {
    options.quantity("--crossover", request.crossover, Dimension::frequency,
                     "the control loop's: phase lag and gain there, e.g. 12Hz");
    options.flag("--ledger", request.ledger,
                 "delay, settling and phase lag of every band of every method; on a log every switch");
    attach_gates(options, request.gates);
}

// Phase lag and gain at the crossover, the ledger, and from which speed on a delay limit is kept, as asked.
void add_costs(Comparison& comparison, const CostRequest& request, const Field& field) {
    comparison.crossover = request.crossover;
    if (request.gates.max_delay && comparison.lines) {
        TableSpec notches;
        notches.gear_ratio = comparison.lines->ratio;
        notches.orders = comparison.lines->orders;
        notches.sample_rate = comparison.sample_rate;
        comparison.max_delay = *request.gates.max_delay;
        comparison.no_notch_below = slowest_within(notches, *comparison.max_delay);
    }
    for (std::size_t i = 0; i < field.contenders.size(); ++i) {
        const Contender& contender = field.contenders[i];
        MethodFigures& figures = comparison.methods[i];
        const auto frozen = contender.frozen(comparison.sample_rate, comparison.speed);
        if (request.crossover && frozen) {
            const auto at =
                at_crossover(frozen->cascade, *request.crossover, SampledAt(comparison.sample_rate));
            figures.phase_lag_deg = at.phase_lag_deg;
            figures.crossover_db = at.gain_db;
        }
        if (request.ledger)
            figures.ledger = delay_ledger(contender, comparison.sample_rate, {request.crossover, true});
        if (!request.ledger) figures.switch_ledger.clear();
        if (request.gates.max_delay && contender.made_for()) {
            figures.within_from = within_from(contender, comparison.sample_rate, *request.gates.max_delay);
        }
    }
}

}  // namespace

// The control is there to be compared with, not to be held to anything.
std::vector<std::string> violations(const Comparison& comparison, const CostRequest& request,
                                    const Field& field) {
    std::vector<std::string> found;
    const auto add = [&found](std::vector<std::string> more) {
        for (std::string& sentence : more) found.push_back(std::move(sentence));
    };
    for (std::size_t i = 0; i < field.contenders.size(); ++i) {
        const Contender& contender = field.contenders[i];
        if (contender.method->part == MethodPart::control) continue;
        const DegPerSec slowest = comparison.on_log ? comparison.slowest : comparison.speed;
        const DegPerSec fastest = comparison.on_log ? comparison.fastest : comparison.speed;
        add(delay_violations(request.gates, contender, comparison.sample_rate, slowest, fastest));
        add(attenuation_violations(request.gates, contender.text, comparison.methods[i].attenuation));
    }
    return found;
}

namespace {

constexpr double default_step_nm = 10.0,
                 default_ramp_nm_s = 20.0;  // the paper's; on a log nobody need say them

struct CompareRequest {
    CommonOptions common;
    PlotRequest plot;
    LogOptions log_options;
    std::string log, truth;
    std::vector<std::string> methods;
    GearOptions gear;
    std::optional<double> step_nm, ramp_nm_s, match_attenuation_db;
    std::optional<DegPerSec> speed;
    CostRequest costs;
    bool match_low_pass = false;
    int match_order = 1;
};

const MethodFigures& match_subject(const Comparison& comparison) {
    const MethodFigures* const subject = comparison.subject();
    if (subject == nullptr || part_of(*subject) == MethodPart::rival) {
        raise<UsageError>(
            "--match-lowpass needs a method to match that is neither none nor a low-pass; or give "
            "--match-attenuation, for example 22dB");
    }
    return *subject;
}

bool wants_match(const CompareRequest& asked) { return asked.match_low_pass || asked.match_attenuation_db; }

std::optional<double> asked_gain(const CompareRequest& request) {
    if (!request.match_attenuation_db) return std::nullopt;
    if (!(*request.match_attenuation_db > 0.0)) {
        raise<UsageError>("--match-attenuation {} dB is not above 0 dB",
                          shortest(*request.match_attenuation_db));
    }
    return portable::pow(10.0, -*request.match_attenuation_db / 20.0);
}

std::string asked_text(const CompareRequest& request) {
    return fmt::format("{} dB", shortest(*request.match_attenuation_db));
}

void add_match_at_speed(Comparison& comparison, const CompareRequest& request) {
    if (!comparison.lines) raise_no_gear("--match-lowpass");
    auto gain = asked_gain(request);
    const std::string subject = gain ? asked_text(request) : match_subject(comparison).method;
    if (!gain) gain = combined_gain(match_subject(comparison), *comparison.lines);
    if (!gain) {
        raise<UsageError>(
            "--match-lowpass: at {:.6g} deg/s no ripple line is between 0 and half the sample rate; give "
            "another --speed",
            comparison.speed.value());
    }
    comparison.match = match_at_speed(subject, *gain, request.match_order, *comparison.lines,
                                      comparison.sample_rate, comparison.speed);
    if (!comparison.match->low_pass) return;
    const Contender low_pass = make_contender(parse_spec(*comparison.match->low_pass));
    comparison.methods.push_back(measure_on_signals(low_pass, comparison.sample_rate, comparison.speed,
                                                    comparison.step_nm, comparison.ramp_nm_s,
                                                    &*comparison.lines));
}

Comparison compare_on_signals(const CompareRequest& request, const Field& field) {
    if (!request.truth.empty()) raise<UsageError>("--truth goes with a LOG");
    if (!request.step_nm && !request.ramp_nm_s) {
        raise<UsageError>("nothing to compare on; give a LOG, or --step 10Nm, or --ramp 20Nm/s");
    }
    Comparison comparison;
    if (request.log_options.sample_rate) {
        comparison.sample_rate = *request.log_options.sample_rate;
    } else if (field.table) {
        comparison.sample_rate = field.table->spec().sample_rate;
    } else {
        raise<UsageError>("the sample rate is missing; give --sample-rate, for example 1kHz");
    }
    (void)request.log_options.resolve();  // refuses a rate that makes no sense
    if (!request.speed && (field.gear || field.table)) {
        raise<UsageError>(
            "attenuation and switching depend on the joint speed; give --speed, for example 90deg/s");
    }
    check_table_rates(field, comparison.sample_rate, "the signal", request.common);
    comparison.speed = request.speed.value_or(DegPerSec(0.0));
    comparison.step_nm = request.step_nm;
    comparison.ramp_nm_s = request.ramp_nm_s;
    comparison.lines = field.gear;
    Progress::current().begin("measuring", "methods", field.contenders.size());
    for (const Contender& contender : field.contenders) {
        comparison.methods.push_back(measure_on_signals(contender, comparison.sample_rate, comparison.speed,
                                                        comparison.step_nm, comparison.ramp_nm_s,
                                                        comparison.lines ? &*comparison.lines : nullptr));
        Progress::current().add(1);
    }
    if (wants_match(request)) add_match_at_speed(comparison, request);
    return comparison;
}

// Delays at the log's speed, and what the method leaves of the log's ripple, in one row.
void add_methods(Comparison& comparison, const std::vector<Contender>& contenders, const ComparedLog& log,
                 const CommonOptions& common) {
    std::optional<LogLevels> levels;
    Progress::current().begin("measuring on the log", "", 0);
    if (comparison.lines) levels = measure_on_log(contenders, log, *comparison.lines);
    Progress::current().begin("measuring", "methods", contenders.size());
    for (std::size_t i = 0; i < contenders.size(); ++i, Progress::current().add(1)) {
        MethodFigures figures = measure_on_signals(contenders[i], comparison.sample_rate, comparison.speed,
                                                   comparison.step_nm, comparison.ramp_nm_s, nullptr);
        if (levels) {
            MethodFigures& on_log = levels->methods[i];
            on_log.settle_ms = figures.settle_ms;
            on_log.overshoot_percent = figures.overshoot_percent;
            on_log.ramp_delay_ms = figures.ramp_delay_ms;
            on_log.dc_delay_ms = figures.dc_delay_ms;
            on_log.note = figures.note;
            figures = std::move(on_log);
        }
        comparison.methods.push_back(std::move(figures));
    }
    if (!levels) return;
    if (levels->windows == 0 && comparison.windows == 0) {
        say_warnings(common, std::vector{fmt::format("the ripple cannot be measured on this log: {}",
                                                     levels->why_none)});
    }
    comparison.windows = levels->windows;
    comparison.measured_share = levels->measured_share;
}

void add_match_on_log(Comparison& comparison, const CompareRequest& request, const ComparedLog& log) {
    if (!comparison.lines) raise_no_gear("--match-lowpass");
    if (comparison.windows == 0) {
        raise<DataError>("--match-lowpass: the log has no window in which its ripple can be measured");
    }
    const auto gain = asked_gain(request);
    const auto& raw = comparison.methods.front();  // the control
    const std::string subject = gain ? asked_text(request) : match_subject(comparison).method;
    const double target = gain ? *gain * *raw.ripple_rms_nm : *match_subject(comparison).ripple_rms_nm;
    comparison.match = match_on_log(subject, target, request.match_order, log, *comparison.lines);
    if (!comparison.match->low_pass) return;
    add_methods(comparison, {make_contender(parse_spec(*comparison.match->low_pass))}, log, request.common);
}

// The torque that a perfect sensor would have given, row by row: another log of the same motion.
std::vector<double> true_torque(const CompareRequest& request, const ReadOptions& read, std::size_t rows,
                                Provenance& provenance) {
    if (request.truth.empty()) return {};
    Log truth = read_log_in_part(request.truth, read);
    provenance.inputs.push_back(input_record(request.truth));
    provenance.inputs.back().rows = truth.trace.size();
    if (truth.trace.size() != rows) {
        raise<DataError>("--truth {} has {} rows, {} has {}; they have to be of the same motion, row by row",
                         request.truth, truth.trace.size(), request.log, rows);
    }
    return std::move(truth.trace.torque_nm);
}

Comparison compare_on_log(const CompareRequest& request, const Field& field, Provenance& provenance,
                          ComparedCourse& course) {
    if (request.log_options.joint == "all")
        raise<UsageError>("--joint all: compare looks at one joint; name it");
    const ReadOptions read = read_options(request.log_options, field.gear);
    const Log log = read_log_in_part(request.log, read);
    say_layout(request.common, log.layout);
    say_warnings(request.common, log.recording.warnings);
    provenance.inputs.push_back(input_record(request.log));
    provenance.inputs.back().rows = log.recording.rows();
    provenance.recordings.push_back({log.recording});
    for (const Contender& contender : field.contenders) refuse_other_joint(contender, log.trace.joint);
    ComparedLog compared{log.trace.view()};
    if (!request.truth.empty() && !field.gear) raise_no_gear("--truth");
    const std::vector<double> truth = true_torque(request, read, log.trace.size(), provenance);
    compared.truth_nm = truth;
    if (request.plot.wanted() && !truth.empty())
        compared.watch = [&course](auto&&... all) { course.add(all...); };
    const auto warmth = temperatures_for(field.contenders, request.log, read, request.common);
    compared.temperatures_degc.assign(warmth.begin(), warmth.end());
    // The filters are those that the filter command would run.
    compared.trace.sample_rate = log.recording.clock.nominal_rate;
    Comparison comparison;
    comparison.on_log = true;
    comparison.rows = log.trace.size();
    comparison.sample_rate = compared.trace.sample_rate;
    check_table_rates(field, comparison.sample_rate, log.layout.source, request.common);
    comparison.speed = request.speed ? *request.speed : median_moving_speed(compared.trace);
    for (const double velocity : compared.trace.velocity_deg_s) {
        const DegPerSec speed(std::abs(velocity));
        comparison.slowest =
            comparison.fastest == DegPerSec(0.0) ? speed : std::min(comparison.slowest, speed);
        comparison.fastest = std::max(comparison.fastest, speed);
    }
    comparison.step_nm = request.step_nm.value_or(default_step_nm);
    comparison.ramp_nm_s = request.ramp_nm_s.value_or(default_ramp_nm_s);
    comparison.lines = field.gear;
    if (!comparison.lines)
        say_warnings(request.common,
                     std::vector<std::string>{"no gear ratio is known, so no ripple was measured; "
                                              "give --gear-ratio or --joint-file"});
    add_methods(comparison, field.contenders, compared, request.common);
    compared.watch = {};  // what is matched is measured more than once
    if (wants_match(request)) add_match_on_log(comparison, request, compared);
    return comparison;
}

ExitCode run_compare(const CompareRequest& request, const std::string& command_line) {
    check_plot(request.plot, request.common);
    if (request.log.empty() && (request.log_options.from || request.log_options.to))
        raise<UsageError>("--from and --to: there is no LOG to take rows of");
    Provenance provenance{{}, command_line};
    const Field field = load_contenders(methods_at(request.log, request.methods, request.log_options),
                                        request.gear, provenance);
    if (request.costs.gates.min_attenuation_db && !field.gear) raise_no_gear("--min-attenuation");
    if (field.gear) say(request.common, gear_in_words(*field.gear));
    ComparedCourse course;
    Comparison comparison = request.log.empty() ? compare_on_signals(request, field)
                                                : compare_on_log(request, field, provenance, course);
    add_costs(comparison, request.costs, field);
    const std::string text =
        request.common.json ? comparison_text(comparison, provenance) : comparison_view(comparison);
    write_text(request.common.output, text, request.common.overwrite());
    draw_plot(request.plot, request.common, provenance, [&] {
        if (!course.empty()) return course.figure(request.log, comparison);
        std::vector<Contender> shown = field.contenders;
        if (comparison.match && comparison.match->low_pass)
            shown.push_back(make_contender(parse_spec(*comparison.match->low_pass)));
        return comparison_figure(comparison, shown);
    });
    const auto broken = violations(comparison, request.costs, field);
    say_warnings(request.common, broken);
    return broken.empty() ? ExitCode::done : ExitCode::limit_violated;
}

std::function<ExitCode()> attach_compare(Options& options) {
    auto request = std::make_shared<CompareRequest>();
    options.argument("LOG", request->log, false, "a log; - is standard input. Without one, --step or --ramp");
    options.texts(
        "--method", request->methods, "NAME,KEY=VALUE,...",
        fmt::format("a method to compare; repeatable; methods: {}; see docs/methods", name_list(methods())));
    attach_gear(options, request->gear);
    options.quantity("--speed", request->speed, Dimension::speed,
                     "joint speed for attenuation and delays; on a log its median moving speed");
    options.number("--step", request->step_nm, Dimension::torque, "torque step to settle from");
    options.number("--ramp", request->ramp_nm_s, Dimension::torque_rate,
                   "torque ramp to measure the delay on");
    options.text("--truth", request->truth, "LOG",
                 "the same log without ripple and noise: each method's error against its torque");
    options.flag(
        "--match-lowpass", request->match_low_pass,
        "find the low-pass that takes out as much ripple as the first other method, and compare it too");
    options.count("--match-order", request->match_order, 1, 20, "order of that low-pass");
    options.number("--match-attenuation", request->match_attenuation_db, Dimension::decibel,
                   "find the low-pass of this ripple attenuation instead");
    attach_costs(options, request->costs);
    attach_plot(options, request->plot);
    attach_log(options, request->log_options);
    attach_common(options, request->common, {"a comparison", ".txt .json", true});
    return [request, &options] { return run_compare(*request, options.command_line()); };
}

}  // namespace

const Command commands::compare = {
    .name = "compare",
    .summary = "several methods side by side on a log, a step or a ramp",
    .description =
        "What each method takes out, and what it costs in delay and settling. The control, none, is always "
        "shown.\nThe paper's figures: ripplenotch compare --step 10Nm --ramp 20Nm/s --speed 90deg/s "
        "--sample-rate 1kHz\n--gear-ratio 100 --orders 1,2 --method fixed,centers=25Hz:50Hz,q=0.25 --method "
        "lowpass,cutoff=13rad/s",
    .attach = attach_compare,
};

}  // namespace ripplenotch
