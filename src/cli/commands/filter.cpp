// SPDX-License-Identifier: MIT
// ripplenotch filter: logs through a method, streaming.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>

#include "cli/chosen_method.hpp"
#include "cli/command.hpp"
#include "cli/filter_gear.hpp"
#include "cli/filter_summary.hpp"
#include "cli/gates.hpp"
#include "cli/joint_facts.hpp"
#include "cli/plot_request.hpp"
#include "ripplenotch/artifact/metrics.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spool.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {
namespace {

constexpr int most_threads = 64;

struct Request {
    CommonOptions common;
    PlotRequest plot;
    LogOptions log;
    std::vector<std::string> logs;
    std::string method, decimals = "shortest";
    std::optional<std::string> table, output_format, metrics, out_directory, joint_file;
    std::optional<double> gear_ratio;
    std::vector<double> orders;
    std::optional<Hertz> crossover;
    Gates gates;
    double gap_steps = default_gap_steps;
    int threads = 0;
    bool append = false, exact = false;
};

/// Where one log comes from and what is made of it.
struct Job {
    std::string log, output;
    std::optional<std::string> metrics;
};

// One number of digits for the whole column: a log's own cells may leave out trailing zeros.
WriteOptions write_options(const Request& request, std::optional<int> log_decimals) {
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

std::vector<Job> jobs_of(const Request& request) {
    const bool several = request.logs.size() > 1;
    if (!several && !request.out_directory)
        return {{request.logs.front(), request.common.output, request.metrics}};
    if (!request.out_directory) {
        raise<UsageError>("{} logs need --out-dir DIR, where each gets a file of its own name",
                          request.logs.size());
    }
    if (request.common.output != "-") raise<UsageError>("--out-dir and -o: give one of them");
    std::vector<Job> jobs;
    std::set<std::string> names;
    for (const std::string& log : request.logs) {
        const std::filesystem::path path(log);
        if (log == "-") raise<UsageError>("--out-dir: standard input has no name; use -o FILE");
        if (!names.insert(path.filename().string()).second) {
            raise<UsageError>("two logs are named {}; filter them into different folders",
                              path.filename().string());
        }
        Job job{log, (std::filesystem::path(*request.out_directory) / path.filename()).string(), {}};
        if (request.metrics) {
            job.metrics = (std::filesystem::path(*request.metrics) / path.stem()).string() + ".metrics.json";
        }
        jobs.push_back(std::move(job));
    }
    std::error_code failed;
    for (const auto& directory : {request.out_directory, request.metrics}) {
        if (directory) std::filesystem::create_directories(*directory, failed);
        if (failed) raise<FileError>("{}: cannot make the folder: {}", *directory, failed.message());
    }
    return jobs;
}

void check(const Request& request) {
    if (request.method.empty() && !request.table) {
        raise<UsageError>(
            "--method is missing, for example --method lowpass,cutoff=13rad/s or --table table.json");
    }
    if (request.log.joint == "all") {
        raise<UsageError>(
            "--joint all: filter takes one joint at a time; pipe one into the next: filter --joint j1 ... | "
            "ripplenotch filter --joint j2 ... -");
    }
    if (!(request.gap_steps > 1.0))
        raise<UsageError>("--gap: {} median steps is not above 1", shortest(request.gap_steps));
    const bool log_on_stdout =
        request.common.output == "-" && !request.out_directory && request.plot.path != "-";
    if (log_on_stdout && (request.common.json || request.metrics == "-")) {
        raise<UsageError>(
            "the filtered log and its metrics would both go to standard output; name a file with -o");
    }
    if (request.common.json && request.logs.size() > 1) {
        raise<UsageError>("--json prints the metrics of one log; for several use --metrics DIR");
    }
    check_plot(request.plot, request.common);
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

Provenance provenance_of(const Request& request, const Job& job, const ChosenMethod& method, std::size_t rows,
                         const std::string& command_line) {
    Provenance provenance;
    provenance.command = command_line;
    provenance.inputs.push_back(input_record(job.log));
    provenance.inputs.back().rows = rows;
    if (!method.table_path.empty()) provenance.inputs.push_back(input_record(method.table_path));
    if (!method.joint_path.empty()) provenance.inputs.push_back(input_record(method.joint_path));
    if (request.joint_file && *request.joint_file != method.joint_path)
        provenance.inputs.push_back(input_record(*request.joint_file));
    return provenance;
}

std::size_t threads_of(const Request& request) {
    constexpr unsigned enough = 4;  // reading, filtering and writing take one block at a time
    if (request.threads > 0) return static_cast<std::size_t>(request.threads);
    return std::clamp(std::thread::hardware_concurrency(), 1U, enough);
}

// The filter of a method that looks at the whole log first, from a pass of its own.
std::unique_ptr<CausalFilter> learn(const Request& request, const ChosenMethod& method, const Spool& spool) {
    LogStream stream(open_log(spool.open(), request.log.resolve()), request.gap_steps);
    const auto learner = method.learner(stream.design_rate());
    static_cast<void>(stream.run(*learner, nullptr, nullptr));
    auto filter = learner->learned();
    for (const std::string& note : learner->notes())
        say(request.common, fmt::format("{}: {}", stream.reader().layout().source, note));
    return filter;
}

void say_way(const Request& request, CausalFilter& filter, const std::string& source) {
    if (const std::string way = filter.hurry(); !way.empty())
        say(request.common, fmt::format("{}: {}", source, way));
}

/// True when everything is within the limits.
bool run_job(const Request& request, const Job& job, const ChosenMethod& method, const Gear& gear,
             const std::string& command_line) {
    std::optional<Spool> spool;
    if (method.method->learner != nullptr) spool.emplace(job.log);
    LogStream stream(
        spool ? open_log(spool->open(), request.log.resolve()) : open_log(job.log, request.log.resolve()),
        request.gap_steps);
    const Layout& layout = stream.reader().layout();
    say_layout(request.common, layout);
    if (method.table != nullptr) {
        refuse_table_rate(method.table->spec().sample_rate, stream.design_rate(), layout.source);
    }
    FilterMetrics metrics;
    metrics.source = layout.source;
    metrics.joint = layout.chosen.joint;
    metrics.method = method.text;
    metrics.sample_rate = stream.design_rate();
    if (method.table != nullptr) metrics.table_rate = method.table->spec().sample_rate;
    metrics.gear_ratio = gear.ratio;

    const bool told = job.metrics || request.common.json || request.common.verbose || request.crossover;
    const bool wanted = told || request.gates.min_attenuation_db;
    std::optional<RippleMeter> meter;
    if (wanted && gear.ratio) {
        meter.emplace(*gear.ratio, gear.orders, stream.design_rate(), 2);
        if (predictable(method)) meter->expect(gains_of(method, gear, stream.design_rate()));
    }
    if (told) {
        metrics.crossover = request.crossover;
        metrics.amplitude_nm = gear.amplitude_nm;
        metrics.delays = delay_ledger(method.contender(), stream.design_rate(), {request.crossover, true});
    }
    const auto filter = spool ? learn(request, method, *spool) : method.start(stream.design_rate());
    if (!request.exact) say_way(request, *filter, layout.source);
    // Both outputs are opened before the work, so that a name that is taken costs nobody an hour.
    std::optional<ByteSink> metrics_sink;
    const std::optional<std::string> metrics_path = request.common.json ? "-" : job.metrics;
    if (metrics_path) metrics_sink.emplace(*metrics_path, request.common.overwrite());
    std::unique_ptr<LogWriter> writer;
    if (!request.plot.instead_of(job.output)) {
        writer = rewrite_log(job.output, stream.reader(), output_format(job.output, request.output_format),
                             write_options(request, stream.torque_decimals()), request.common.overwrite());
    }
    const WatchedWriter* watched = nullptr;
    if (request.plot.wanted()) {
        auto watching = std::make_unique<WatchedWriter>(std::move(writer));
        watched = watching.get();
        writer = std::move(watching);
    }
    metrics.stream = stream.run(*filter, writer.get(), meter ? &*meter : nullptr, threads_of(request));

    if (meter) metrics.levels = meter->levels();
    say_warnings(request.common, filter_warnings(metrics));
    if (wanted && !gear.ratio) {
        const std::string no_gear =
            "no gear ratio is known, so no ripple was measured; give --gear-ratio or --joint-file";
        say_warnings(request.common, {&no_gear, 1});
    }
    for (const std::string& line : filter_summary(metrics)) say(request.common, line);
    if (metrics_sink) {
        metrics_sink->write(
            metrics_to_json(metrics, provenance_of(request, job, method, metrics.stream.rows, command_line)));
        metrics_sink->finish();
    }
    if (watched != nullptr) {
        draw_plot(request.plot, request.common,
                  provenance_of(request, job, method, metrics.stream.rows, command_line),
                  [&] { return watched->course().figure(metrics.source, method.text, metrics.stream); });
    }
    const auto broken = filter_violations(request.gates, method.contender(), metrics);
    say_warnings(request.common, broken);
    return broken.empty();
}

ExitCode run(const Request& request, const std::string& command_line) {
    check(request);
    const ChosenMethod method =
        choose_method(request.method.empty() ? "switching" : request.method, request.table,
                      {request.gear_ratio, request.orders, request.joint_file});
    const Gear gear = gear_of(request.joint_file, request.gear_ratio, request.orders, method);
    if (request.gates.min_attenuation_db && !gear.ratio) {
        raise<UsageError>(
            "--min-attenuation-db needs to know where the ripple is; give --gear-ratio and --orders, or "
            "--joint-file");
    }
    bool within = true;
    for (const Job& job : jobs_of(request)) {
        if (!run_job(request, job, method, gear, command_line)) within = false;
    }
    return within ? ExitCode::done : ExitCode::limit_violated;
}

std::function<ExitCode()> attach(Options& options) {
    auto request = std::make_shared<Request>();
    options.arguments("LOG", request->logs, true, "logs to filter; - is standard input");
    options.text("--method", request->method, "SPEC",
                 "name,key=value,...: switching, tracking, oscillator, subtract, fixed, lowpass, none; see "
                 "docs/methods");
    options.text("--table", request->table, "FILE",
                 "table.json of method switching, which is then the default");
    options.text("--out-dir", request->out_directory, "DIR", "folder for the outputs of several logs");
    options.text("--output-format", request->output_format, "NAME",
                 "format of the output: csv, npy (default: by the name of -o, else csv)");
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
    options.number("--gear-ratio", request->gear_ratio, Dimension::none,
                   "for methods that follow the gear, and the metrics; switching has it from its table");
    options.numbers("--orders", request->orders, Dimension::none,
                    "the same (default for the metrics: the method's, else 1,2)");
    options.text("--joint-file", request->joint_file, "FILE",
                 "joint.json with gear ratio and orders, for the same");
    options.quantity("--crossover", request->crossover, Dimension::frequency,
                     "the control loop's: phase lag and gain there, for -v and the metrics, e.g. 12Hz");
    attach_gates(options, request->gates);
    options.number("--gap", request->gap_steps, Dimension::none,
                   "a step in time of more than this many median steps starts a new run");
    options.count("--threads", request->threads, 0, most_threads,
                  "threads for long logs; the output is the same for any number; 0 is one a core, at most 4");
    attach_plot(options, request->plot);
    attach_log(options, request->log);
    attach_common(options, request->common);
    return [request, &options] { return run(*request, options.command_line()); };
}

}  // namespace

const Command commands::filter = {
    .name = "filter",
    .summary = "takes the ripple out of logs, streaming",
    .description =
        "Replaces the torque column by the filtered torque and leaves every other byte of the log as it is.\n"
        "ripplenotch filter log.csv --table table.json -o filtered.csv --metrics metrics.json\n"
        "cat log.csv | ripplenotch filter --method lowpass,cutoff=13rad/s,order=1 - | ripplenotch spectrum -",
    .attach = attach,
};

}  // namespace ripplenotch
