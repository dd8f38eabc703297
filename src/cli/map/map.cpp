// SPDX-License-Identifier: MIT
// ripplenotch map: what the ripple of a joint is at every motor angle, speed and direction, from its logs.

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/command.hpp"
#include "cli/gear/gear_choice.hpp"
#include "cli/map/map_text.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/readings/readings.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/chart/map_figure.hpp"
#include "ripplenotch/core/inputs_read.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {
namespace {

struct Request {
    CommonOptions common;
    PlotRequest plot;
    LogOptions log;
    std::vector<std::string> logs;
    GearOptions gear;
    Degrees zero;
    bool require_conclusive = false;
};

std::vector<Log> read_logs(const Request& request, const GearAccount& gear, Provenance& provenance) {
    ReadOptions read = read_options(request.log, gear);
    std::vector<Log> logs;
    for (const std::string& path : request.logs) {
        logs.push_back(
            read_log_in_part(path, read, std::max(most_rows_held / request.logs.size(), most_rows_held / 4)));
        const Log& log = logs.back();
        say_layout(request.common, log.layout);
        say_warnings(request.common, log.recording.warnings);
        provenance.inputs.push_back(input_record(path));
        provenance.inputs.back().rows = log.recording.rows();
        provenance.recordings.push_back({log.recording});
    }
    return logs;
}

MapFit fitted(const std::vector<Log>& logs, const OtherReading& reading, const Request& request,
              const GearAccount& gear) {
    std::vector<Trace> traces;
    for (const Log& log : logs) traces.push_back(read_otherwise(log.trace, reading));
    std::vector<TraceView> views;
    for (const Trace& trace : traces) views.push_back(trace.view());
    return fit_ripple_map(views, gear, request.zero.value());
}

// A reading under which something turns with the motor is confirmed by that; where two have it, or none of
// several, nobody knows which one holds.
MapFit fitted_by_readings(const std::vector<Log>& logs, const Request& request, const GearAccount& gear) {
    MapFit fit = fitted(logs, {}, request, gear);
    std::vector<std::string> rivals;
    for (const OtherReading& reading : open_readings(logs)) {
        if (reading.changes_side) continue;
        const MapFit other = fitted(logs, reading, request, gear);
        if (other.finding == MapFinding::mapped || fit.finding != MapFinding::mapped)
            rivals.push_back(reading.words);
    }
    if (rivals.empty()) return fit;
    std::string others;
    for (const std::string& words : rivals)
        others += fmt::format("{}if {}", others.empty() ? "" : ", ", words);
    fit.doubt = fmt::format("Cannot tell: it may be otherwise {}; {} settles it. {}:", others,
                            settling_options(logs), assumed_reading(logs));
    fit.conclusive = false;
    return fit;
}

ExitCode run(Request& request, const std::string& command_line) {
    if (request.log.joint == "all") raise<UsageError>("--joint all: map looks at one joint; name it");
    check_plot(request.plot, request.common);
    Provenance provenance{{}, command_line};
    const GearChoice choice(request.gear);
    const std::optional<GearAccount> gear = choice.of();
    if (!gear) raise_no_gear("map");
    say(request.common, gear_in_words(*gear));
    const std::vector<Log> logs = read_logs(request, *gear, provenance);
    if (choice.joint()) provenance.inputs.push_back(input_record(choice.joint()->path));
    MapFit fit = fitted_by_readings(logs, request, *gear);
    fit.map.joint = logs.front().trace.joint;
    for (const std::string& note : fit.notes) say(request.common, note);
    const std::string text = map_report(fit, request.logs);
    const bool json_file = ends_with_json(request.common.output);
    if (request.common.json || json_file) {
        write_text(request.common.output, map_text(fit, provenance), request.common.overwrite());
        // The file is for the next command; people still want to read what came out.
        if (json_file && !request.common.json) write_text("-", text, ByteSink::Overwrite::yes);
    } else {
        write_text(request.common.output, text, request.common.overwrite());
    }
    draw_plot(request.plot, request.common, provenance, [&] {
        if (fit.map.orders.empty())
            raise<DataError>("--plot: the map is empty, there is nothing to draw: {}", map_verdict(fit));
        return map_figure(joint_in_words(request.logs.front(), fit.map.joint), fit);
    });
    return fit.conclusive || !request.require_conclusive ? ExitCode::done : ExitCode::inconclusive;
}

std::function<ExitCode()> attach(Options& options) {
    const auto request = std::make_shared<Request>();
    options.arguments("LOG", request->logs, true,
                      "logs of one joint; several make one map, and are held together");
    attach_gear(options, request->gear);
    options.quantity("--zero", request->zero, Dimension::angle,
                     "joint position at which the wave generator's angle counts as 0");
    options.flag("--require-conclusive", request->require_conclusive,
                 "exit with code 5 when the logs do not settle it");
    attach_plot(options, request->plot);
    attach_log(options, request->log);
    attach_common(options, request->common, {"a ripple map", ".txt .json"});
    return [request, &options] { return run(*request, options.command_line()); };
}

}  // namespace

const Command commands::map{
    .name = "map",
    .summary = "the ripple by motor angle, speed and direction, for a compensator without delay",
    .description =
        "Reads logs of one joint and fits the cosine and sine amplitude of each order as a function of "
        "speed, "
        "direction,\n"
        "the joint's own turn and load: the smallest form that pays on blocks of the logs that were left "
        "out. "
        "The map is\n"
        "empty where nothing turns with the motor.\n"
        "Example: ripplenotch map log.csv --gear-ratio 100 --orders 1,2 -o map.json",
    .attach = attach,
};

}  // namespace ripplenotch
