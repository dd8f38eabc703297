// SPDX-License-Identifier: MIT
// ripplenotch filter: a log through a method, streaming.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/comparison_json.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/other_motors.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

std::string ripple_line(const FilterMetrics& metrics, std::size_t order) {
    const OrderLevel& level = metrics.lines()->orders[order];
    const std::string name = order_in_words(Order(level.order), metrics.gear->ratio);
    if (level.windows == 0) return name + ": not measured, nowhere four periods in one direction";
    const auto attenuation = attenuation_db(level), predicted = predicted_nm(metrics, order);
    return fmt::format("{} (mean {:.4g} Hz): {:.3g} Nm before, {:.3g} Nm after{}{}", name, level.mean_hz,
                       level.amplitude_nm[0], level.amplitude_nm[1],
                       attenuation ? fmt::format(", {:.1f} dB", *attenuation) : "",
                       predicted ? fmt::format("; predicted {:.3g} Nm", *predicted) : "");
}

std::string where(const LedgerEntry& entry) {
    return entry.band > 0 ? fmt::format("band {}", entry.band)
                          : fmt::format("at {:g} deg/s", entry.from.value());
}

std::string crossover_line(const std::vector<LedgerEntry>& entries, Hertz crossover) {
    const auto by_lag = [](const LedgerEntry& a, const LedgerEntry& b) {
        return a.phase_lag_deg.value_or(0.0) < b.phase_lag_deg.value_or(0.0);
    };
    const auto [least, most] = std::minmax_element(entries.begin(), entries.end(), by_lag);
    const std::string at = fmt::format("phase lag at {:g} Hz: ", crossover.value());
    const auto degrees = [](const LedgerEntry& entry) {
        return rounded(entry.phase_lag_deg.value_or(0.0), 1);
    };
    if (entries.size() == 1) return fmt::format("{}{} deg", at, degrees(*least));
    return fmt::format("{}{} deg ({}) to {} deg ({})", at, degrees(*least), where(*least), degrees(*most),
                       where(*most));
}

// A joint that crosses a band's edge back and forth on the noise of its speed switches for nothing; two
// changes a second is more than a motion through the bands makes.
constexpr double many_switches_a_second = 2.0;

std::string switches_line(const StreamReport& stream) {
    std::string text = how_many(stream.switch_count, "change of filter", "changes of filter");
    std::size_t back = 0;
    for (std::size_t i = 1; i < stream.switches.size(); ++i)
        back += stream.switches[i].change.to_band == stream.switches[i - 1].change.from_band ? 1 : 0;
    const double rate = stream.recording.clock.mean_rate.value();
    const double seconds = rate > 0.0 ? static_cast<double>(stream.recording.rows()) / rate : 0.0;
    if (2 * back > stream.switches.size() &&
        static_cast<double>(stream.switch_count) > many_switches_a_second * seconds) {
        text += fmt::format(
            ", {:.3g} a second, {:.0f} % of them straight back: the speed is noisy at a band's edge; try "
            "hysteresis=1deg/s",
            static_cast<double>(stream.switch_count) / seconds,
            100.0 * static_cast<double>(back) / static_cast<double>(stream.switches.size() - 1));
    }
    return text;
}

std::string delay_line(const std::vector<LedgerEntry>& delays) {
    const auto by_delay = [](const LedgerEntry& a, const LedgerEntry& b) { return a.dc_delay < b.dc_delay; };
    const auto [least, most] = std::minmax_element(delays.begin(), delays.end(), by_delay);
    const auto milliseconds = [](const LedgerEntry& delay) {
        return rounded(1e3 * delay.dc_delay.value(), 1);
    };
    if (delays.size() == 1) return fmt::format("delay at 0 Hz: {} ms", milliseconds(*least));
    return fmt::format("delay at 0 Hz: {} ms ({}) to {} ms ({})", milliseconds(*least), where(*least),
                       milliseconds(*most), where(*most));
}

// Sentences worth a warning: gaps, a clock that changed, ripple that could not be measured.
std::vector<std::string> filter_warnings(const FilterMetrics& metrics) {
    std::vector<std::string> warnings;
    for (const LogWarning& warning : metrics.stream.recording.warnings)
        warnings.push_back(fmt::format("{}: {}", metrics.source, warning.text));
    if (metrics.table_rate) {
        const auto warning =
            table_rate_warning({.table = *metrics.table_rate, .log = metrics.sample_rate}, metrics.source);
        if (warning) warnings.push_back(*warning);
    }
    for (const auto& sentences : {harm_done(metrics), short_of_prediction(metrics)})
        for (const std::string& sentence : sentences)
            warnings.push_back(fmt::format("{}: {}", metrics.source, sentence));
    if (metrics.measured && metrics.lines() == nullptr) {
        warnings.push_back(fmt::format(
            "{}: ripple could not be measured: no four periods of an order in one direction, slow enough for "
            "two samples a period ({} too few samples)",
            metrics.source,
            how_many(metrics.measured->lines.windows_too_few_samples, "window with", "windows with")));
    }
    return warnings;
}

// The metrics in a few lines, for -v.
std::vector<std::string> filter_summary(const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    std::vector<std::string> lines;
    const Recording& recording = stream.recording;
    lines.push_back(
        fmt::format("{}: {}, {} at {:.5g} Hz (measured {:.5g} Hz), {}, {}, angle from {}", metrics.source,
                    metrics.method, how_many(recording.rows(), "row"), metrics.sample_rate.value(),
                    recording.clock.mean_rate.value(), how_many(recording.clock.gap_count, "gap"),
                    how_many(recording.held.count, "held sample"), source_name(recording.angle.source())));
    if (recording.outside) {
        lines.push_back(fmt::format("{}: {} rows before and {} after are left out, by --from and --to",
                                    metrics.source, recording.outside->before, recording.outside->after));
    }
    if (metrics.lines() != nullptr) {
        const RippleLevels& levels = *metrics.lines();
        for (std::size_t i = 0; i < levels.orders.size(); ++i) lines.push_back(ripple_line(metrics, i));
        lines.push_back(fmt::format(
            "ripple at most {:.3g} Nm peak to peak before, {:.3g} Nm after; residual {:.3g} Nm rms before, "
            "{:.3g} Nm "
            "after ({}, {:.0f} % of the log)",
            levels.ripple_peak_to_peak_nm[0], levels.ripple_peak_to_peak_nm[1], levels.residual_rms_nm[0],
            levels.residual_rms_nm[1], how_many(levels.windows, "window"), 100.0 * levels.measured_share));
    }
    if (const MethodFigures* const figures = metrics.measured ? &metrics.measured->methods.front() : nullptr;
        figures != nullptr && figures->error_nm) {
        lines.push_back(fmt::format(
            "the torque itself is moved by {:.3g} Nm rms, {:.3g} Nm rms is added to it; the output's error "
            "is "
            "{:.3g} Nm rms, in the first {:g} s of motion up to {:.2g} times that of the raw torque",
            figures->moved_nm.value_or(0.0), figures->added_nm.value_or(0.0), *figures->error_nm,
            start_seconds, figures->start_ratio.value_or(0.0)));
    }
    if (!metrics.delays.empty()) lines.push_back(delay_line(metrics.delays));
    if (metrics.crossover && !metrics.delays.empty())
        lines.push_back(crossover_line(metrics.delays, *metrics.crossover));
    if (metrics.table_rate) lines.push_back(switches_line(stream));
    return lines;
}

/// What the command line asks of filter.
struct FilterRequest {
    CommonOptions common;
    std::string path;
    ReadOptions log;
    MethodRequest how;
    std::string decimals = "shortest";
    std::optional<std::string> output_format, metrics;
    std::optional<Hertz> crossover;
    Gates gates;
    int threads = 0;
    bool append = false;

    /// With the gear of the methods, where they have one in common.
    [[nodiscard]] ReadOptions read_options(const JointMethods& methods) const;
};

ReadOptions FilterRequest::read_options(const JointMethods& methods) const {
    ReadOptions options = ripplenotch::read_options(log, methods.common_gear());
    options.gear_ratio_of = [&methods](const std::string& joint) -> std::optional<double> {
        const std::optional<GearAccount> own = methods.of(joint)->gear;
        return own && own->has_ratio() ? std::optional(own->ratio.value()) : std::nullopt;
    };
    if (!options.gear_ratio) options.gear_ratio = how.gear.ratio;
    options.needs_velocity = methods.follows_motion();
    options.every_joint = options.joint.has_value();
    options.check_joint = [&methods](const std::string& joint) { static_cast<void>(methods.of(joint)); };
    return options;
}

/// One joint of a log on its way through its filter.
struct JointWork {
    CommonOptions common;  ///< with the joint that messages are about
    std::shared_ptr<const Contender> method;
    std::unique_ptr<CausalFilter> filter;
    std::unique_ptr<OtherRipple> other_ripple;  ///< null where the method has no map of other motors
    std::optional<KeptRows> kept;
    FilterMetrics metrics;
};

constexpr double faster_than_seen = 1.2;  ///< than any window of a map's logs, to be worth a word

/// Whether something about the ripple is reported.
bool tells(const FilterRequest& request) {
    return request.metrics || request.common.json || request.common.verbose || request.crossover;
}
/// Whether a result or an exit code depends on how large the ripple is; else it is measured for warnings
/// alone.
bool must_measure(const FilterRequest& request) { return tells(request) || request.gates.min_attenuation_db; }
/// Where a gear is known the warnings are worth it, too.
bool measures(const FilterRequest& request) { return must_measure(request) || !request.common.quiet; }

/// All but the filter.
JointWork start_work(const FilterRequest& request, const LogStream& stream, const std::string& joint,
                     JointMethods& methods, const std::shared_ptr<JointMessages>& messages) {
    JointWork work;
    work.common = request.common;
    work.common.joint = joint;
    work.common.messages = messages;
    work.method = methods.of(joint);
    const Contender& method = *work.method;
    const auto& gear = method.gear;
    FilterMetrics& metrics = work.metrics;
    metrics.source = stream.reader().layout().source;
    if (method.table != nullptr) {
        metrics.table_rate = method.table->spec().sample_rate;
        static_cast<void>(
            table_rate_warning({.table = *metrics.table_rate, .log = stream.design_rate()}, metrics.source));
    }
    refuse_other_joint(method, joint);
    metrics.joint = joint;
    metrics.method = method.text;
    metrics.sample_rate = stream.design_rate();
    metrics.gear = gear;
    if (gear) say(work.common, gear_in_words(*gear));
    if (measures(request) && gear) {
        work.kept.emplace();
        work.kept->sparsely = !must_measure(request);
        work.kept->trace.sample_rate = stream.design_rate();
    }
    if (tells(request)) {
        metrics.crossover = request.crossover;
        metrics.delays = delay_ledger(method, stream.design_rate(), {request.crossover, true});
    }
    return work;
}

// Looks at the first rows of a log that is a file.
std::string against_gear_of(const FilterRequest& request, const JointWork& work, const ReadOptions& read) {
    if (!tells(request) || request.path == "-" || !work.method->gear || !work.method->gear->has_ratio())
        return "";
    ReadOptions one = read;
    if (!work.metrics.joint.empty()) one.joint = work.metrics.joint;
    one.every_joint = false;
    const Log log = read_log_in_part(request.path, one);
    return against_gear({&log, 1}, *work.method->gear);
}

// A map says nothing of speeds that it never saw.
std::string beyond_map(const JointWork& work) {
    const RippleMap* map = work.method->map.get();
    const double fastest = work.metrics.stream.fastest_deg_s;
    if (map == nullptr || map->orders.empty() || !(fastest > faster_than_seen * map->speeds_deg_s.to))
        return "";
    return fmt::format(
        "the log moves at up to {:.3g} deg/s, and its map was made at {:.3g} to {:.3g} deg/s: "
        "beyond, the map's edge holds",
        fastest, map->speeds_deg_s.from, map->speeds_deg_s.to);
}

/// The log, the method's files and the command, for the result of this joint.
Provenance provenance_of(const FilterRequest& request, const JointWork& work,
                         const std::string& command_line) {
    Provenance provenance;
    provenance.command = command_line;
    provenance.inputs.push_back(input_record(request.path));
    provenance.inputs.back().rows = work.metrics.stream.recording.rows();
    provenance.recordings.push_back({work.metrics.stream.recording});
    for (const std::string& file : work.method->files) provenance.inputs.push_back(input_record(file));
    return provenance;
}

// Limits that a filtered log breaks: delays at the speeds that it moved at, attenuation as it was measured
// there.
std::vector<std::string> filter_violations(const Gates& gates, const Contender& contender,
                                           const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    auto found = delay_violations(gates, contender, metrics.sample_rate, DegPerSec(stream.slowest_deg_s),
                                  DegPerSec(stream.fastest_deg_s));
    if (!metrics.measured) return found;
    std::vector<OrderAttenuation> orders;
    for (const OrderLevel& level : metrics.measured->lines.orders) {
        OrderAttenuation entry{level.order, level.mean_hz, std::nullopt, metrics.gear->ratio};
        if (level.windows > 0) entry.db = attenuation_db(level).value_or(most_attenuation_db);
        orders.push_back(entry);
    }
    for (std::string& sentence : attenuation_violations(gates, metrics.method, orders))
        found.push_back(std::move(sentence));
    for (std::string& sentence : found) sentence.insert(0, metrics.source + ": ");
    return found;
}

/// Reports the result of a joint; true when everything is within the limits.
bool tell(const FilterRequest& request, JointWork& work) {
    FilterMetrics& metrics = work.metrics;
    if (work.kept) metrics.measured = measure_kept(*work.method, *work.kept, *metrics.gear);
    work.kept.reset();
    std::vector<std::string> warnings = filter_warnings(metrics);
    if (std::string beyond = beyond_map(work); !beyond.empty()) warnings.push_back(std::move(beyond));
    if (must_measure(request) && !metrics.gear) {
        warnings.emplace_back(
            "no line is known, so no ripple was measured; give --gear-ratio, --orders 200/turn (lines per "
            "turn of "
            "the joint) or --joint-file");
    }
    const auto broken = filter_violations(request.gates, *work.method, metrics);
    const std::string& unit = metrics.stream.recording.torque_unit;
    for (std::string& warning : warnings) warning = in_torque_unit(std::move(warning), unit);
    say_warnings(work.common, warnings);
    for (const std::string& line : filter_summary(metrics)) say(work.common, in_torque_unit(line, unit));
    say_warnings(work.common, broken);
    return broken.empty();
}

/// The work of each joint that `stream` reads, with its filter ready and its outputs open. `spool`: holds the
/// log where it is read twice.
std::vector<JointWork> start_works(const FilterRequest& request, const LogStream& stream,
                                   JointMethods& methods, const std::optional<Spool>& spool) {
    std::vector<JointWork> works;
    const auto joints = stream.reader().layout().all_chosen();
    const auto messages = joints.size() > 1 ? std::make_shared<JointMessages>() : nullptr;
    for (const JointColumns& joint : joints)
        works.push_back(start_work(request, stream, joint.joint, methods, messages));
    for (JointWork& work : works) {
        if (work.method->others.empty()) continue;
        if (!spool && request.path == "-")
            raise<UsageError>(
                "the map also holds ripple of the motors of other joints, for which the log is read twice, "
                "and "
                "standard input can be read once; give a file");
        std::optional<Spool> again;
        if (!spool) again.emplace(request.path);
        work.other_ripple = std::make_unique<OtherRipple>(work.method->others, spool ? *spool : *again,
                                                          request.read_options(methods));
        say(work.common,
            fmt::format("{}: less the ripple of the {} of {}, by the map", work.metrics.source,
                        work.method->others.size() == 1 ? "motor" : "motors",
                        joined(work.method->others, ", ", [](const RippleMap& map) { return map.joint; })));
    }
    for (JointWork& work : works) work.filter = work.method->start(work.metrics.sample_rate);
    return works;
}

constexpr int most_threads = 64;

// One number of digits for the whole column: a log's own cells may leave out trailing zeros.
WriteOptions write_options(const FilterRequest& request, std::optional<int> log_decimals) {
    WriteOptions options;
    options.append = request.append;
    if (request.decimals == "input") {
        if (!log_decimals) return options;
        options.decimals = WriteOptions::Decimals::fixed;
        options.fixed_decimals = *log_decimals;
    } else if (request.decimals != "shortest") {
        const auto number = parse_number(request.decimals);
        if (!number || *number < 0.0 || *number > 17.0 || *number != static_cast<int>(*number)) {
            raise<UsageError>("--decimals: '{}' is none of shortest, input, 0 ... 17", request.decimals);
        }
        options.decimals = WriteOptions::Decimals::fixed;
        options.fixed_decimals = static_cast<int>(*number);
    }
    return options;
}

void check_several(const FilterRequest& request) {
    if (request.common.json)
        raise<UsageError>(
            "--json prints the metrics of one joint; for all of them use --metrics 'NAME-{}.json'",
            joint_mark);
    if (request.common.plot || request.common.in_memory)
        raise<UsageError>("{} one joint; select one with --joint",
                          request.common.in_memory ? "a torque in memory is of" : "--plot draws");
    if (request.metrics && !names_joint(*request.metrics)) {
        raise<UsageError>("--metrics {}: each joint has metrics of its own; put {} into the name",
                          *request.metrics, joint_mark);
    }
}

void check_filter(const FilterRequest& request) {
    if (request.how.method.empty()) {
        raise<UsageError>(
            "--method is missing, for example --method lowpass,cutoff=13rad/s or --method "
            "switching,table=table.json");
    }
    if (request.metrics)
        check_output_name(*request.metrics, "a record of metrics", ".json .txt", "--metrics");
    const bool log_on_stdout = request.common.output == "-" && !request.common.figure_for_rows();
    if (log_on_stdout && (request.common.json || request.metrics == "-")) {
        raise<UsageError>(
            "the filtered log and its metrics would both go to standard output; name a file with -o");
    }
    if (request.common.plot == "-" && request.metrics == "-")
        raise<UsageError>(
            "--plot - and --metrics - would both go to standard output; name a file for one of them");
    if (request.crossover && !(request.crossover->value() > 0.0))
        raise<UsageError>("--crossover {} Hz is not above 0", shortest(request.crossover->value()));
    if (request.common.json && request.metrics) raise<UsageError>("--json is --metrics -; give one of them");
}

std::size_t threads_of(const FilterRequest& request) {
    constexpr unsigned enough = 4;  // reading, filtering and writing take one block at a time
    if (request.threads > 0) return static_cast<std::size_t>(request.threads);
    return std::clamp(std::thread::hardware_concurrency(), 1U, enough);
}

/// Passes rows on to `writer` (which may be null) and keeps what a figure of them needs; of a log that is
/// filtered in memory, the torque.
class WatchedWriter : public LogWriter {
  public:
    WatchedWriter(std::unique_ptr<LogWriter> writer, bool keeps_torque)
        : writer_(std::move(writer)), keeps_torque_(keeps_torque) {}
    std::string_view prepare(RowBlock& block, Torques torque_nm, std::string& room) const override {
        return writer_ ? writer_->prepare(block, torque_nm, room) : std::string_view{};
    }
    void put(const RowBlock& block, Torques torque_nm, std::string_view bytes) override {
        const JointRows& joint = block.joints.front();
        const auto& after = torque_nm.front();
        for (std::size_t k = 0; k < block.size(); ++k)
            course_.add({.time_s = block.time_s[k],
                         .speed_deg_s = joint.velocity_deg_s[k],
                         .before_nm = joint.torque_nm[k],
                         .after_nm = after[k]});
        if (keeps_torque_)
            torque_nm_.insert(torque_nm_.end(), after.begin(),
                              after.begin() + static_cast<std::ptrdiff_t>(block.size()));
        if (writer_) writer_->put(block, torque_nm, bytes);
    }
    void finish() override {
        if (writer_) writer_->finish();
    }
    [[nodiscard]] const TorqueCourse& course() const { return course_; }
    [[nodiscard]] std::vector<double> take_torque() { return std::move(torque_nm_); }

  private:
    std::unique_ptr<LogWriter> writer_;
    TorqueCourse course_;
    bool keeps_torque_;
    std::vector<double> torque_nm_;
};

Answer run_filter(FilterRequest& request, const std::string& command_line) {
    check_filter(request);
    request.how.needs_gear = request.gates.min_attenuation_db.has_value();
    hash_inputs(request.metrics || request.common.json || request.common.plot);
    JointMethods methods(request.how);
    std::optional<Spool> spool;
    if (methods.needs_log_twice()) spool.emplace(request.path);
    const ReadOptions read = request.read_options(methods);
    LogStream stream(spool ? open_log(spool->open(), read) : open_log(request.path, read));
    const Layout& layout = stream.reader().layout();
    if (!layout.others.empty()) check_several(request);
    say_left_out(request.common, layout.left_out);
    say_layout(request.common, layout);
    std::vector<JointWork> works = start_works(request, stream, methods, spool);
    std::unique_ptr<LogWriter> writer;
    if (!request.common.figure_for_rows()) {
        const LogFormat& log_format = find_log_format(stream.reader().layout().format);
        writer = rewrite_log(request.common.output, stream.reader(),
                             output_format(request.common.output, request.output_format, log_format),
                             write_options(request, stream.torque_decimals()), request.common.overwrite());
    }
    std::shared_ptr<WatchedWriter> watched;
    if (request.common.plot || request.common.in_memory)
        watched = std::make_shared<WatchedWriter>(std::move(writer), request.common.in_memory);
    std::vector<JointRun> runs;
    for (JointWork& work : works) {
        runs.push_back({work.filter.get(), work.kept ? &*work.kept : nullptr, work.other_ripple.get()});
    }
    std::vector<StreamReport> reports =
        stream.run(runs, watched ? watched.get() : writer.get(), threads_of(request));
    Answer answer{.own_output = true};
    for (std::size_t j = 0; j < works.size(); ++j) {
        works[j].metrics.stream = std::move(reports[j]);
        if (const std::string against = against_gear_of(request, works[j], read); !against.empty())
            warn(works[j].common, against);
        if (!tell(request, works[j])) answer.code = ExitCode::limit_violated;
        const auto metrics = [&] {
            return metrics_to_json(works[j].metrics, provenance_of(request, works[j], command_line));
        };
        if (request.common.json) answer.document = [text = metrics()] { return text; };
        if (request.metrics)
            answer.files.push_back({with_joint(*request.metrics, works[j].metrics.joint), metrics(), ""});
    }
    if (const auto& messages = works.front().common.messages) messages->say_all(works.size());
    if (!watched) return answer;
    answer.provenance = provenance_of(request, works.front(), command_line);
    answer.columns = {{"torque_nm", watched->take_torque()}};
    answer.figure = [watched, metrics = std::move(works.front().metrics)] {
        return watched->course().figure(metrics.source, metrics.method, metrics.stream);
    };
    return answer;
}

std::function<Answer()> attach_filter(Options& options) {
    auto request = std::make_shared<FilterRequest>();
    options.argument("LOG", request->path, true, "the log to filter; - is standard input");
    options.text("--method", request->how.method, "SPEC",
                 fmt::format("name,key=value,...: {}; see docs/methods", name_list(methods())));
    options.text("--output-format", request->output_format, "NAME",
                 fmt::format("format of the output: {} (default: by the name of -o, else csv)",
                             written_log_formats()));
    options.flag("--append", request->append,
                 "add the filtered torque as a column instead of replacing the torque");
    options.text("--decimals", request->decimals, "HOW",
                 "digits of the filtered torque: shortest (reads back exactly), input (as many as the "
                 "log's), or a number");
    options.text("--metrics", request->metrics, "FILE",
                 "JSON about attenuation, residual, delays, switches, gaps");
    options.writes("--metrics");
    options.text("--other-motors", request->how.other_motors, "FILE",
                 "first subtracts the ripple of other joints' motors in this map.json; a method with "
                 "map= takes that of its map");
    attach_gear(options, request->how.gear);
    options.number("--crossover", request->crossover, Dimension::frequency,
                   "the control loop's: phase lag and gain there, for -v and the metrics, e.g. 12Hz");
    attach_gates(options, request->gates);
    options.count("--threads", request->threads, 0, most_threads,
                  "threads for long logs; the output is the same for any number; 0 is one a core, at most 4");
    attach_plot(options, request->common);
    attach_log(options, request->log);
    attach_common(options, request->common, {});
    return [request, &options] { return run_filter(*request, options.command_line()); };
}

}  // namespace

const Command commands::filter = {
    .name = "filter",
    .summary = "removes the ripple from a log, streaming",
    .description =
        "Replaces the torque column by the filtered torque and leaves every other byte of the log as it is.\n"
        "With --from or --to the rows outside are not written.\n"
        "ripplenotch filter log.csv --method switching,table=table.json -o filtered.csv --metrics "
        "metrics.json\n"
        "cat log.csv | ripplenotch filter --method lowpass,cutoff=13rad/s,order=1 - | ripplenotch spectrum -",
    .attach = attach_filter,
};

}  // namespace ripplenotch
