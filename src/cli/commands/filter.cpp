// SPDX-License-Identifier: MIT
// ripplenotch filter: logs through a method, streaming.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include "cli/command.hpp"
#include "cli/filter_summary.hpp"
#include "cli/gates.hpp"
#include "cli/joint_facts.hpp"
#include "cli/joint_methods.hpp"
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

bool every_joint(const Request& request) { return request.log.joint == "all"; }

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
            job.metrics = (std::filesystem::path(*request.metrics) / path.stem()).string() +
                          (every_joint(request) ? ".{joint}" : "") + ".metrics.json";
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

ReadOptions read_options(const Request& request) {
    ReadOptions options = request.log.resolve();
    options.every_joint = every_joint(request);
    if (options.every_joint) options.joint.reset();
    return options;
}

void check_joints(const Request& request) {
    if (request.common.json)
        raise<UsageError>(
            "--json prints the metrics of one joint; for all of them use --metrics 'NAME-{}.json'",
            joint_mark);
    if (request.plot.wanted()) raise<UsageError>("--plot draws one joint; say which with --joint");
    if (request.metrics && !request.out_directory && !names_joint(*request.metrics)) {
        raise<UsageError>("--metrics {}: each joint has metrics of its own; put {} into the name",
                          *request.metrics, joint_mark);
    }
}

void check(const Request& request) {
    if (request.method.empty() && !request.table) {
        raise<UsageError>(
            "--method is missing, for example --method lowpass,cutoff=13rad/s or --table table.json");
    }
    if (every_joint(request)) check_joints(request);
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

std::size_t threads_of(const Request& request) {
    constexpr unsigned enough = 4;  // reading, filtering and writing take one block at a time
    if (request.threads > 0) return static_cast<std::size_t>(request.threads);
    return std::clamp(std::thread::hardware_concurrency(), 1U, enough);
}

/// One joint of a log on its way through its filter.
struct JointWork {
    std::shared_ptr<const JointMethod> method;
    std::unique_ptr<CausalFilter> filter;
    std::optional<RippleMeter> meter;
    FilterMetrics metrics;
    std::string metrics_path;  ///< empty when none are wanted
    std::unique_ptr<ByteSink> metrics_sink;
};

/// Whether something about the ripple is told, and whether it is measured.
bool tells(const Request& request, const Job& job) {
    return job.metrics || request.common.json || request.common.verbose || request.crossover;
}
bool measures(const Request& request, const Job& job) {
    return tells(request, job) || request.gates.min_attenuation_db;
}

/// All but the filter, which may have to learn from the log first.
JointWork start_work(const Request& request, const Job& job, const LogStream& stream,
                     const std::string& joint, JointMethods& methods) {
    JointWork work;
    work.method = methods.of(joint);
    const ChosenMethod& method = work.method->chosen;
    const Gear& gear = work.method->gear;
    FilterMetrics& metrics = work.metrics;
    metrics.source = stream.reader().layout().source;
    if (method.table != nullptr) {
        metrics.table_rate = method.table->spec().sample_rate;
        refuse_table_rate(*metrics.table_rate, stream.design_rate(), metrics.source);
    }
    metrics.joint = joint;
    metrics.method = method.text;
    metrics.sample_rate = stream.design_rate();
    metrics.gear_ratio = gear.ratio;
    if (measures(request, job) && gear.ratio) {
        work.meter.emplace(*gear.ratio, gear.orders, stream.design_rate(), 2);
        if (predictable(method)) work.meter->expect(gains_of(method, gear, stream.design_rate()));
    }
    if (tells(request, job)) {
        metrics.crossover = request.crossover;
        metrics.amplitude_nm = gear.amplitude_nm;
        metrics.delays = delay_ledger(method.contender(), stream.design_rate(), {request.crossover, true});
    }
    if (request.common.json) work.metrics_path = "-";
    if (job.metrics) work.metrics_path = with_joint(*job.metrics, joint);
    return work;
}

/// Sentences about one joint among several say which.
std::string about(const JointWork& work, const std::string& sentence) {
    return work.metrics.joint.empty() ? sentence : fmt::format("joint {}: {}", work.metrics.joint, sentence);
}

// The filters of a method that looks at the whole log first, from a pass of its own.
void learn(const Request& request, const Spool& spool, std::vector<JointWork>& works) {
    LogStream stream(open_log(spool.open(), read_options(request)), request.gap_steps);
    std::vector<std::unique_ptr<Learner>> learners;
    std::vector<JointRun> runs;
    for (const JointWork& work : works) {
        learners.push_back(work.method->chosen.learner(stream.design_rate()));
        runs.push_back({learners.back().get()});
    }
    static_cast<void>(stream.run(runs, nullptr));
    for (std::size_t j = 0; j < works.size(); ++j) {
        works[j].filter = learners[j]->learned();
        for (const std::string& note : learners[j]->notes())
            say(request.common, fmt::format("{}: {}", works[j].metrics.source, about(works[j], note)));
    }
}

void start_filter(const Request& request, JointWork& work) {
    if (!work.filter) work.filter = work.method->chosen.start(work.metrics.sample_rate);
    if (request.exact) return;
    if (const std::string way = work.filter->hurry(); !way.empty())
        say(request.common, fmt::format("{}: {}", work.metrics.source, about(work, way)));
}

Provenance provenance_of(const Job& job, const JointWork& work, const std::string& command_line) {
    const ChosenMethod& method = work.method->chosen;
    Provenance provenance;
    provenance.command = command_line;
    provenance.inputs.push_back(input_record(job.log));
    provenance.inputs.back().rows = work.metrics.stream.rows;
    if (!method.table_path.empty()) provenance.inputs.push_back(input_record(method.table_path));
    if (!method.joint_path.empty()) provenance.inputs.push_back(input_record(method.joint_path));
    if (work.method->joint_file && *work.method->joint_file != method.joint_path)
        provenance.inputs.push_back(input_record(*work.method->joint_file));
    return provenance;
}

/// Says and writes what became of a joint; true when everything is within the limits.
bool tell(const Request& request, const Job& job, JointWork& work, const std::string& command_line) {
    FilterMetrics& metrics = work.metrics;
    if (work.meter) metrics.levels = work.meter->levels();
    std::vector<std::string> warnings = filter_warnings(metrics);
    if (measures(request, job) && !metrics.gear_ratio) {
        warnings.emplace_back(
            "no gear ratio is known, so no ripple was measured; give --gear-ratio or --joint-file");
    }
    const auto broken = filter_violations(request.gates, work.method->chosen.contender(), metrics);
    for (std::string& warning : warnings) warning = every_joint(request) ? about(work, warning) : warning;
    say_warnings(request.common, warnings);
    for (const std::string& line : filter_summary(metrics))
        say(request.common, every_joint(request) ? about(work, line) : line);
    if (work.metrics_sink) {
        work.metrics_sink->write(metrics_to_json(metrics, provenance_of(job, work, command_line)));
        work.metrics_sink->finish();
    }
    for (const std::string& one : broken) {
        const std::string sentence = every_joint(request) ? about(work, one) : one;
        say_warnings(request.common, {&sentence, 1});
    }
    return broken.empty();
}

std::vector<JointWork> start_works(const Request& request, const Job& job, const LogStream& stream,
                                   JointMethods& methods, const std::optional<Spool>& spool) {
    std::vector<JointWork> works;
    for (const JointColumns& joint : stream.reader().layout().all_chosen())
        works.push_back(start_work(request, job, stream, joint.joint, methods));
    if (spool) learn(request, *spool, works);
    for (JointWork& work : works) {
        start_filter(request, work);
        // Outputs are opened before the work, so that a name that is taken costs nobody an hour.
        if (!work.metrics_path.empty())
            work.metrics_sink = std::make_unique<ByteSink>(work.metrics_path, request.common.overwrite());
    }
    return works;
}

/// True when everything is within the limits.
bool run_job(const Request& request, const Job& job, JointMethods& methods, const std::string& command_line) {
    std::optional<Spool> spool;
    if (methods.learns()) spool.emplace(job.log);
    LogStream stream(
        spool ? open_log(spool->open(), read_options(request)) : open_log(job.log, read_options(request)),
        request.gap_steps);
    say_layout(request.common, stream.reader().layout());
    std::vector<JointWork> works = start_works(request, job, stream, methods, spool);
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
    std::vector<JointRun> runs;
    for (JointWork& work : works) runs.push_back({work.filter.get(), work.meter ? &*work.meter : nullptr});
    std::vector<StreamReport> reports = stream.run(runs, writer.get(), threads_of(request));
    bool within = true;
    for (std::size_t j = 0; j < works.size(); ++j) {
        works[j].metrics.stream = std::move(reports[j]);
        if (!tell(request, job, works[j], command_line)) within = false;
    }
    if (watched != nullptr) {
        const FilterMetrics& metrics = works.front().metrics;
        draw_plot(request.plot, request.common, provenance_of(job, works.front(), command_line),
                  [&] { return watched->course().figure(metrics.source, metrics.method, metrics.stream); });
    }
    return within;
}

ExitCode run(const Request& request, const std::string& command_line) {
    check(request);
    JointMethods methods({request.method.empty() ? "switching" : request.method, request.table,
                          request.joint_file, request.gear_ratio, request.orders,
                          request.gates.min_attenuation_db.has_value()});
    bool within = true;
    for (const Job& job : jobs_of(request)) {
        if (!run_job(request, job, methods, command_line)) within = false;
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
