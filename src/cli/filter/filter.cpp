// SPDX-License-Identifier: MIT
// ripplenotch filter: logs through a method, streaming.

#include "cli/filter/filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "cli/command.hpp"
#include "cli/filter/filter_work.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/options/lists.hpp"
#include "cli/options/verdict_options.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/side_column.hpp"

namespace ripplenotch {

namespace {

std::string ripple_line(const FilterMetrics& metrics, std::size_t order) {
    const OrderLevel& level = metrics.levels->orders[order];
    if (level.windows == 0)
        return fmt::format("order {:g}: not measured, nowhere four periods in one direction", level.order);
    const auto attenuation = attenuation_db(level), predicted = predicted_nm(metrics, order);
    return fmt::format("order {:g} (mean {:.4g} Hz): {:.3g} Nm before, {:.3g} Nm after{}{}", level.order,
                       level.mean_hz, level.amplitude_nm[0], level.amplitude_nm[1],
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

}  // namespace

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
    if (metrics.levels && metrics.levels->windows == 0) {
        warnings.push_back(fmt::format(
            "{}: ripple could not be measured: no four periods of an order in one direction, slow enough for "
            "two samples a period ({} too few samples)",
            metrics.source,
            how_many(metrics.levels->windows_too_few_samples, "window with", "windows with")));
    }
    return warnings;
}

std::vector<std::string> filter_summary(const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    std::vector<std::string> lines;
    const Recording& recording = stream.recording;
    lines.push_back(
        fmt::format("{}: {}, {} at {:.6g} Hz (measured {:.6g} Hz), {}, {}, angle from {}", metrics.source,
                    metrics.method, how_many(recording.rows(), "row"), metrics.sample_rate.value(),
                    recording.clock.mean_rate.value(), how_many(recording.clock.gap_count, "gap"),
                    how_many(recording.held.count, "held sample"), source_name(recording.angle.source())));
    if (recording.outside) {
        lines.push_back(fmt::format("{}: {} rows before and {} after are left out, by --from and --to",
                                    metrics.source, recording.outside->before, recording.outside->after));
    }
    if (metrics.levels && metrics.levels->windows > 0) {
        const RippleLevels& levels = *metrics.levels;
        for (std::size_t i = 0; i < levels.orders.size(); ++i) lines.push_back(ripple_line(metrics, i));
        lines.push_back(fmt::format(
            "ripple at most {:.3g} Nm peak to peak before, {:.3g} Nm after; residual {:.3g} Nm rms before, "
            "{:.3g} Nm "
            "after ({}, {:.0f} % of the log)",
            levels.ripple_peak_to_peak_nm[0], levels.ripple_peak_to_peak_nm[1], levels.residual_rms_nm[0],
            levels.residual_rms_nm[1], how_many(levels.windows, "window"), 100.0 * levels.measured_share));
    }
    if (metrics.levels && metrics.levels->windows > 0)
        lines.push_back(
            fmt::format("the torque itself is moved by {:.3g} Nm rms", metrics.levels->distortion_rms_nm[1]));
    if (!metrics.delays.empty()) lines.push_back(delay_line(metrics.delays));
    if (metrics.crossover && !metrics.delays.empty())
        lines.push_back(crossover_line(metrics.delays, *metrics.crossover));
    if (metrics.table_rate) lines.push_back(switches_line(stream));
    return lines;
}

namespace {

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

// Several logs have each a file of metrics in the folder.
bool metrics_in_folder(const FilterRequest& request) {
    return request.metrics && (request.out_directory || request.logs.size() > 1);
}

FilterJob job_of(const FilterRequest& request, const std::filesystem::path& log) {
    FilterJob job{log.string(), request.common.output, request.metrics};
    if (request.in_place) job.output = job.log;
    if (request.out_directory)
        job.output = (std::filesystem::path(*request.out_directory) / log.filename()).string();
    if (metrics_in_folder(request)) {
        job.metrics =
            (std::filesystem::path(*request.metrics) / log.stem()).string() + std::string(metrics_ending);
        job.metrics_in_folder = true;
    }
    return job;
}

void check_jobs(const FilterRequest& request, const std::vector<FilterJob>& jobs) {
    const bool own_names = request.in_place || request.out_directory;
    if (request.in_place + request.out_directory.has_value() + (request.common.output != "-") > 1)
        raise<UsageError>("-o, --out-dir and --in-place: give one of them");
    if (jobs.size() > 1 && !own_names)
        raise<UsageError>("{} logs need --out-dir DIR, where each gets a file of its own name", jobs.size());
    FileClaims claims;
    if (request.how.method != "switching") claims.reads(request.how.method, "--method");
    if (request.how.table) claims.reads(*request.how.table, "--table");
    if (request.how.other_motors) claims.reads(*request.how.other_motors, "--other-motors");
    if (request.how.gear.joint_file) claims.reads(*request.how.gear.joint_file, "--joint-file");
    for (const FilterJob& job : jobs) {
        if (own_names && job.log == "-")
            raise<UsageError>("--out-dir and --in-place: standard input has no name; use -o FILE");
        if (!request.in_place) claims.reads(job.log, "LOG");
        claims.writes(job.output, own_names ? "the filtered " + job.log + ":" : "-o");
        if (job.metrics) claims.writes(*job.metrics, "--metrics");
    }
    claims.check(", or use --in-place; filter logs of one name into different folders");
}

std::vector<FilterJob> jobs_of(const FilterRequest& request) {
    std::vector<FilterJob> jobs;
    for (const std::string& log : request.logs) jobs.push_back(job_of(request, log));
    check_jobs(request, jobs);
    std::error_code failed;
    for (const auto& folder :
         {request.out_directory, metrics_in_folder(request) ? request.metrics : std::nullopt}) {
        if (folder) std::filesystem::create_directories(*folder, failed);
        if (failed) raise<FileError>("{}: cannot make the folder: {}", *folder, failed.message());
    }
    return jobs;
}

void check_several(const FilterRequest& request) {
    if (request.common.json)
        raise<UsageError>(
            "--json prints the metrics of one joint; for all of them use --metrics 'NAME-{}.json'",
            joint_mark);
    if (request.plot.wanted()) raise<UsageError>("--plot draws one joint; select one with --joint");
    if (request.metrics && !metrics_in_folder(request) && !names_joint(*request.metrics)) {
        raise<UsageError>("--metrics {}: each joint has metrics of its own; put {} into the name",
                          *request.metrics, joint_mark);
    }
}

void check_filter(const FilterRequest& request) {
    if (request.how.method.empty() && !request.how.table) {
        raise<UsageError>(
            "--method is missing, for example --method lowpass,cutoff=13rad/s or --table table.json");
    }
    if (request.metrics && !metrics_in_folder(request))
        check_output_name(*request.metrics, "a record of metrics", ".json .txt", "--metrics");
    if (!(request.gap_steps > 1.0))
        raise<UsageError>("--gap: {} median steps is not above 1", shortest(request.gap_steps));
    const bool log_on_stdout = request.common.output == "-" && !request.out_directory && !request.in_place &&
                               request.plot.path != "-";
    if (log_on_stdout && (request.common.json || request.metrics == "-")) {
        raise<UsageError>(
            "the filtered log and its metrics would both go to standard output; name a file with -o");
    }
    if (request.common.json && request.logs.size() > 1) {
        raise<UsageError>("--json prints the metrics of one log; for several use --metrics DIR");
    }
    if (request.in_place && request.log.range.given())
        raise<UsageError>("--in-place with --from or --to: the rows outside would be lost; use -o FILE");
    if (request.plot.path == "-" && request.metrics == "-")
        raise<UsageError>(
            "--plot - and --metrics - would both go to standard output; name a file for one of them");
    if (request.plot.wanted() && request.logs.size() > 1)
        raise<UsageError>("--plot draws one log, and {} are given; filter them one by one",
                          request.logs.size());
    if (request.crossover && !(request.crossover->value() > 0.0))
        raise<UsageError>("--crossover {} Hz is not above 0", shortest(request.crossover->value()));
    if (request.common.json && request.metrics) raise<UsageError>("--json is --metrics -; give one of them");
}

std::size_t threads_of(const FilterRequest& request) {
    constexpr unsigned enough = 4;  // reading, filtering and writing take one block at a time
    if (request.threads > 0) return static_cast<std::size_t>(request.threads);
    return std::clamp(std::thread::hardware_concurrency(), 1U, enough);
}

/// The methods of one log: those of all of them, unless a map has to be looked up at this log's temperature.
std::optional<JointMethods> methods_at_temperature(const FilterRequest& request, const FilterJob& job,
                                                   const JointMethods& methods) {
    MethodRequest own = request.how;
    own.method = at_log_temperature(own.method, job.log, request.read_options(methods));
    return own.method == request.how.method ? std::nullopt : std::optional<JointMethods>(JointMethods(own));
}

/// True when everything is within the limits.
bool run_job(const FilterRequest& request, const FilterJob& job, JointMethods& methods,
             const std::string& command_line) {
    std::optional<Spool> spool;
    if (methods.needs_log_twice()) spool.emplace(job.log);
    const ReadOptions read = request.read_options(methods);
    LogStream stream(spool ? open_log(spool->open(), read) : open_log(job.log, read), request.gap_steps);
    const Layout& layout = stream.reader().layout();
    if (request.in_place && layout.reshaped)
        raise<UsageError>(
            "--in-place: {} has one value a row, and would have a column for each signal; use -o",
            layout.source);
    if (!layout.others.empty()) check_several(request);
    say_left_out(request.common, layout.left_out);
    say_layout(request.common, layout);
    std::vector<JointWork> works = start_works(request, job, stream, methods, spool);
    std::unique_ptr<LogWriter> writer;
    if (!request.plot.instead_of(job.output)) {
        const LogFormat& log_format = find_log_format(stream.reader().layout().format);
        writer = rewrite_log(job.output, stream.reader(),
                             output_format(job.output, request.output_format, log_format),
                             write_options(request, stream.torque_decimals()),
                             ByteSink::Overwrite{request.in_place || request.common.force});
    }
    const WatchedWriter* watched = nullptr;
    if (request.plot.wanted()) {
        auto watching = std::make_unique<WatchedWriter>(std::move(writer));
        watched = watching.get();
        writer = std::move(watching);
    }
    std::vector<JointRun> runs;
    std::vector<std::unique_ptr<FollowedRows>> followed;
    for (JointWork& work : works) {
        followed.push_back(followed_rows(*work.method, job.log, read));
        runs.push_back({work.filter.get(), work.meter ? &*work.meter : nullptr, !must_measure(request, job),
                        followed.back().get(), work.other_ripple.get()});
    }
    std::vector<StreamReport> reports = stream.run(runs, writer.get(), threads_of(request));
    for (std::size_t j = 0; j < works.size(); ++j)
        if (followed[j]) say_warnings(works[j].common, followed[j]->notes());
    bool within = true;
    for (std::size_t j = 0; j < works.size(); ++j) {
        works[j].metrics.stream = std::move(reports[j]);
        if (!tell(request, job, works[j], command_line)) within = false;
    }
    if (const auto& messages = works.front().common.messages) messages->say_all(works.size());
    if (watched != nullptr) {
        const FilterMetrics& metrics = works.front().metrics;
        draw_plot(request.plot, request.common, provenance_of(job, works.front(), command_line),
                  [&] { return watched->course().figure(metrics.source, metrics.method, metrics.stream); });
    }
    return within;
}

ExitCode run_filter(FilterRequest& request, const std::string& command_line) {
    check_filter(request);
    if (request.how.method.empty()) request.how.method = "switching";
    request.how.needs_gear = request.gates.min_attenuation_db.has_value();
    hash_inputs(request.metrics || request.common.json || request.plot.wanted());
    JointMethods methods(request.how);
    bool within = true;
    for (const FilterJob& job : jobs_of(request)) {
        auto own = methods_at_temperature(request, job, methods);
        if (!run_job(request, job, own ? *own : methods, command_line)) within = false;
    }
    return within ? ExitCode::done : ExitCode::limit_violated;
}

std::function<ExitCode()> attach_filter(Options& options) {
    auto request = std::make_shared<FilterRequest>();
    options.arguments("LOG", request->logs, true, "logs to filter; - is standard input");
    options.text("--method", request->how.method, "SPEC",
                 fmt::format("name,key=value,...: {}; see docs/methods", name_list(methods())));
    options.text("--table", request->how.table, "FILE",
                 "table.json of method switching, which is then the default");
    options.text("--out-dir", request->out_directory, "DIR", "folder for the outputs of several logs");
    options.text("--output-format", request->output_format, "NAME",
                 fmt::format("format of the output: {} (default: by the name of -o, else csv)",
                             written_log_formats()));
    options.flag("--in-place", request->in_place, "the filtered log replaces the raw one");
    options.flag("--append", request->append,
                 "add the filtered torque as a column instead of replacing the torque");
    options.flag("--exact", request->exact,
                 "filter sample by sample where fixed and lowpass would go in blocks of eight, whose output "
                 "may differ "
                 "by 1e-12 of the largest torque");
    options.text("--decimals", request->decimals, "HOW",
                 "digits of the filtered torque: shortest (reads back exactly), input (as many as the "
                 "log's), or a number");
    options.text("--metrics", request->metrics, "FILE",
                 "JSON about attenuation, residual, delays, switches, gaps; with --out-dir a folder");
    options.writes("--metrics");
    options.text(
        "--other-motors", request->how.other_motors, "FILE",
        "map.json: the ripple of other joints' motors that it holds is subtracted first; a method with "
        "map= takes that of its map");
    attach_gear(options, request->how.gear);
    options.number("--crossover", request->crossover, Dimension::frequency,
                   "the control loop's: phase lag and gain there, for -v and the metrics, e.g. 12Hz");
    attach_gates(options, request->gates);
    options.flag("--require-improvement", request->require_improvement,
                 "exit code 1 when the filter makes the torque worse: an order grows, its delay moves the "
                 "torque by more than the ripple that it removes, or a switch makes a jump larger than it");
    options.number("--gap", request->gap_steps, Dimension::none,
                   "a step in time of more than this many median steps starts a new run");
    options.count("--threads", request->threads, 0, most_threads,
                  "threads for long logs; the output is the same for any number; 0 is one a core, at most 4");
    attach_plot(options, request->plot, request->common);
    attach_log(options, request->log);
    attach_common(options, request->common, {});
    return [request, &options] { return run_filter(*request, options.command_line()); };
}

}  // namespace

const Command commands::filter = {
    .name = "filter",
    .summary = "removes the ripple from logs, streaming",
    .description =
        "Replaces the torque column by the filtered torque and leaves every other byte of the log as it is.\n"
        "With --from or --to the rows outside are not written.\n"
        "ripplenotch filter log.csv --table table.json -o filtered.csv --metrics metrics.json\n"
        "cat log.csv | ripplenotch filter --method lowpass,cutoff=13rad/s,order=1 - | ripplenotch spectrum -",
    .attach = attach_filter,
};

}  // namespace ripplenotch
