// SPDX-License-Identifier: MIT
#include "cli/filter/filter_work.hpp"

#include <fmt/format.h>

#include <complex>

#include "cli/filter/filter.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/options/verdict_options.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/comparison_json.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {
namespace {

constexpr double faster_than_seen = 1.2;  ///< than any window of a map's logs, to be worth a word

/// Whether something about the ripple is told, and whether it is measured.
bool tells(const FilterRequest& request, const FilterJob& job) {
    return job.metrics || request.common.json || request.common.verbose || request.crossover;
}
/// Where a gear is known the warnings are worth it, too.
bool measures(const FilterRequest& request, const FilterJob& job) {
    return must_measure(request, job) || !request.common.quiet;
}

std::string metrics_name(const FilterJob& job, bool one_of_several) {
    const std::string of_log = *job.metrics;
    if (!job.metrics_in_folder || !one_of_several) return of_log;
    return of_log.substr(0, of_log.size() - metrics_ending.size()) + "." + std::string(joint_mark) +
           std::string(metrics_ending);
}

/// The complex gains of the method's filter for the lines of its gear, by speed.
LineGains gains_of(const Contender& method, Hertz sample_rate) {
    return [method, sample_rate](double speed, std::span<std::complex<double>> gains) {
        const auto frozen = method.frozen(sample_rate, DegPerSec(speed));
        for (std::size_t i = 0; i < gains.size(); ++i) {
            const Hertz at = ripple_frequency(method.gear->orders[i], method.gear->ratio, DegPerSec(speed));
            gains[i] = frozen ? response(frozen->cascade, at, SampledAt(sample_rate)) : 1.0;
        }
    };
}

/// Whether what is left of the ripple is predicted along a log: not for methods that look at the whole log
/// first, and not for those whose filter at a speed is too dear for every window of a log.
bool predictable(const Contender& method) {
    return method.method->learner == nullptr && method.method->frozen != nullptr &&
           !method.method->frozen_is_dear;
}

/// All but the filter, which may have to learn from the log first.
JointWork start_work(const FilterRequest& request, const FilterJob& job, const LogStream& stream,
                     const std::string& joint, JointMethods& methods,
                     const std::shared_ptr<JointMessages>& messages) {
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
        refuse_table_rate({.table = *metrics.table_rate, .log = stream.design_rate()}, metrics.source);
    }
    refuse_other_joint(method, joint);
    metrics.joint = joint;
    metrics.method = method.text;
    metrics.sample_rate = stream.design_rate();
    metrics.gear = gear;
    if (gear) say(work.common, gear_in_words(*gear));
    if (measures(request, job) && gear) {
        work.meter.emplace(gear->ratio, gear->orders, stream.design_rate(), 2,
                           predictable(method) ? gains_of(method, stream.design_rate()) : LineGains{});
    }
    if (tells(request, job)) {
        metrics.crossover = request.crossover;
        metrics.delays = delay_ledger(method, stream.design_rate(), {request.crossover, true});
    }
    if (job.metrics) work.metrics_path = with_joint(metrics_name(job, messages != nullptr), joint);
    if (request.common.json) work.metrics_path.emplace(1, '-');
    return work;
}

// The filters of a method that looks at the whole log first, from a pass of its own.
void learn(const FilterRequest& request, const JointMethods& methods, const Spool& spool,
           std::vector<JointWork>& works) {
    LogStream stream(open_log(spool.open(), request.read_options(methods)), request.gap_steps);
    std::vector<std::unique_ptr<Learner>> learners;
    std::vector<JointRun> runs;
    for (const JointWork& work : works) {
        learners.push_back(work.method->learner(stream.design_rate()));
        runs.push_back({learners.back().get()});
        runs.back().other_ripple = work.other_ripple.get();
    }
    static_cast<void>(stream.run(runs, nullptr));
    for (JointWork& work : works)
        if (work.other_ripple) work.other_ripple->begin_again();
    for (std::size_t j = 0; j < works.size(); ++j) {
        works[j].filter = learners[j]->learned();
        for (const std::string& note : learners[j]->notes())
            say(works[j].common, fmt::format("{}: {}", works[j].metrics.source, note));
    }
}

// A map says nothing of speeds that it never saw.
std::vector<std::string> beyond_map(const JointWork& work) {
    const RippleMap* map = work.method->map.get();
    const double fastest = work.metrics.stream.fastest_deg_s;
    if (map == nullptr || map->orders.empty() || !(fastest > faster_than_seen * map->speeds_deg_s.to))
        return {};
    return {
        fmt::format("the log moves at up to {:.3g} deg/s, and its map was made at {:.3g} to {:.3g} deg/s: "
                    "beyond, the map's edge holds",
                    fastest, map->speeds_deg_s.from, map->speeds_deg_s.to)};
}

void start_filter(const FilterRequest& request, JointWork& work) {
    if (!work.filter) work.filter = work.method->start(work.metrics.sample_rate);
    if (request.exact) return;
    if (const std::string way = work.filter->hurry(); !way.empty())
        say(work.common, fmt::format("{}: {}", work.metrics.source, way));
}

}  // namespace

bool must_measure(const FilterRequest& request, const FilterJob& job) {
    return tells(request, job) || request.gates.min_attenuation_db || request.require_improvement;
}

ReadOptions FilterRequest::read_options(const JointMethods& methods) const {
    ReadOptions options = ripplenotch::read_options(log, methods.common_gear());
    options.gear_ratio_of = [&methods](const std::string& joint) -> std::optional<double> {
        const std::optional<GearAccount> own = methods.of(joint)->gear;
        return own ? std::optional(own->ratio.value()) : std::nullopt;
    };
    if (!options.gear_ratio) options.gear_ratio = how.gear.ratio;
    options.needs_velocity = methods.follows_motion();
    options.every_joint = options.joint.has_value();
    options.check_joint = [&methods](const std::string& joint) { static_cast<void>(methods.of(joint)); };
    return options;
}

Provenance provenance_of(const FilterJob& job, const JointWork& work, const std::string& command_line) {
    Provenance provenance;
    provenance.command = command_line;
    provenance.inputs.push_back(input_record(job.log));
    provenance.inputs.back().rows = work.metrics.stream.recording.rows();
    provenance.recordings.push_back({work.metrics.stream.recording});
    for (const std::string& file : work.method->files) provenance.inputs.push_back(input_record(file));
    return provenance;
}

bool tell(const FilterRequest& request, const FilterJob& job, JointWork& work,
          const std::string& command_line) {
    FilterMetrics& metrics = work.metrics;
    if (work.meter) metrics.levels = work.meter->levels();
    std::vector<std::string> warnings = filter_warnings(metrics);
    for (std::string& warning : beyond_map(work)) warnings.push_back(std::move(warning));
    if (must_measure(request, job) && !metrics.gear) {
        warnings.emplace_back(
            "no gear ratio is known, so no ripple was measured; give --gear-ratio or --joint-file");
    }
    const auto broken = filter_violations(request.gates, *work.method, metrics);
    const std::string& unit = metrics.stream.recording.torque_unit;
    for (std::string& warning : warnings) warning = in_torque_unit(std::move(warning), unit);
    say_warnings(work.common, warnings);
    for (const std::string& line : filter_summary(metrics)) say(work.common, in_torque_unit(line, unit));
    if (work.metrics_sink) {
        work.metrics_sink->write(metrics_to_json(metrics, provenance_of(job, work, command_line)));
        work.metrics_sink->finish();
    }
    say_warnings(work.common, broken);
    return broken.empty() && !(request.require_improvement && !harm_done(metrics).empty());
}

std::vector<JointWork> start_works(const FilterRequest& request, const FilterJob& job,
                                   const LogStream& stream, JointMethods& methods,
                                   const std::optional<Spool>& spool) {
    std::vector<JointWork> works;
    const auto joints = stream.reader().layout().all_chosen();
    const auto messages = joints.size() > 1 ? std::make_shared<JointMessages>() : nullptr;
    for (const JointColumns& joint : joints)
        works.push_back(start_work(request, job, stream, joint.joint, methods, messages));
    for (JointWork& work : works) {
        if (work.method->others.empty()) continue;
        if (!spool && job.log == "-")
            raise<UsageError>(
                "the map also holds ripple of the motors of other joints, for which the log is read twice, "
                "and "
                "standard input can be read once; give a file");
        std::optional<Spool> again;
        if (!spool) again.emplace(job.log);
        work.other_ripple = std::make_unique<OtherRipple>(work.method->others, spool ? *spool : *again,
                                                          request.read_options(methods), request.gap_steps);
        say(work.common,
            fmt::format("{}: less the ripple of the {} of {}, by the map", work.metrics.source,
                        work.method->others.size() == 1 ? "motor" : "motors",
                        joined(work.method->others, ", ", [](const RippleMap& map) { return map.joint; })));
    }
    if (spool && methods.learns()) learn(request, methods, *spool, works);
    for (JointWork& work : works) {
        start_filter(request, work);
        // Outputs are opened before the work, so that a name that is taken costs nobody an hour.
        if (work.metrics_path)
            work.metrics_sink = std::make_unique<ByteSink>(*work.metrics_path, request.common.overwrite());
    }
    return works;
}

}  // namespace ripplenotch
