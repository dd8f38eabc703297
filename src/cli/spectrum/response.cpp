// SPDX-License-Identifier: MIT
#include "cli/spectrum/response.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/log/clock.hpp"
#include "ripplenotch/verdict/side_column.hpp"

namespace ripplenotch {

namespace {

constexpr std::array<std::string_view, 2> estimator_names = {"h1", "h2"};
constexpr std::array<Role, 3> signal_roles = {Role::torque, Role::velocity, Role::position};

std::optional<Role> role_named(std::string_view name) {
    const auto* found = std::find_if(signal_roles.begin(), signal_roles.end(),
                                     [name](Role role) { return role_name(role) == name; });
    return found == signal_roles.end() ? std::nullopt : std::optional(*found);
}

struct Signal {
    std::string name, unit;
    std::vector<double> values;
};

bool is_signal(const std::string& name, const Layout& layout) {
    return role_named(name) || std::any_of(layout.columns.begin(), layout.columns.end(),
                                           [&](const Column& column) { return column.name == name; });
}

// A name may hold a slash, too: "joint_states/effort".
std::pair<std::string, std::string> split_signals(const std::string& asked, const ResponseLog& read) {
    std::vector<std::pair<std::string, std::string>> found;
    const std::string text = with_joint(asked, read.log.trace.joint);
    for (std::size_t at = text.find('/'); at != std::string::npos; at = text.find('/', at + 1)) {
        std::pair<std::string, std::string> names{text.substr(0, at), text.substr(at + 1)};
        const Layout& layout = read.log.layout;
        if (is_signal(names.first, layout) && is_signal(names.second, layout))
            found.push_back(std::move(names));
    }
    if (found.size() == 1) return found.front();
    const std::string columns = joined(read.log.layout.columns, ", ", &Column::name);
    if (found.size() > 1)
        raise<UsageError>("--response {}: more than one of its slashes stands between two columns of {}: {}",
                          text, read.path, columns);
    raise<UsageError>(
        "--response: read '{}', expected OUT/IN, two of torque, velocity, position and the columns of {}: {}",
        text, read.path, columns);
}

Signal signal_named(const std::string& name, const ResponseLog& read) {
    const Trace& trace = read.log.trace;
    const auto role = role_named(name);
    if (!role) {
        if (read.path == "-")
            raise<UsageError>(
                "--response: '{}' is a column by its name, for which a log is read again, and standard input "
                "cannot be; give a file, or use --columns torque={}",
                name, name);
        Signal signal{name, "", side_column(read.path, name, trace.joint, read.reading, all_rows)};
        require_beside(signal.values, trace, read.path, name);
        return signal;
    }
    const auto& columns = read.log.layout.chosen;
    if (*role == Role::torque) return {name, read.log.recording.torque_unit, trace.torque_nm};
    if (*role == Role::velocity) return {name, "deg/s", trace.velocity_deg_s};
    if (!columns.position || trace.position_deg.empty())
        raise<DataError>("{}: the log has no position of the joint for --response", read.path);
    return {name, "deg", trace.position_deg};
}

// Columns by name are numbers as they stand in the log, whatever their unit is.
std::string gain_unit(const Signal& out, const Signal& in) {
    const auto unit = [](const Signal& signal) {
        return signal.unit.empty() ? fmt::format("the unit of column {}", signal.name) : signal.unit;
    };
    return out.unit == in.unit ? "" : fmt::format("{} per {}", unit(out), unit(in));
}

std::optional<PredictedResponse> predicted(const ResponseRequest& request, const GearOptions& gear,
                                           const Trace& trace, std::span<const double> hz) {
    if (!request.method) return std::nullopt;
    const JointMethods methods({*request.method, std::nullopt, gear});
    const auto method = methods.of(trace.joint);
    double speed = 0.0;
    if (methods.follows_motion()) {
        std::vector<double> speeds = trace.velocity_deg_s;
        for (double& value : speeds) value = std::abs(value);
        speed = median_in(speeds);
    }
    const Hertz rate = nominal_rate(trace.sample_rate);
    const auto filter = method->frozen(rate, DegPerSec(speed));
    if (!filter)
        raise<UsageError>("--method {}: it is no linear filter at a constant speed, so it has no response",
                          method->text);
    PredictedResponse found{method->text, filter->note, {}};
    if (methods.follows_motion())
        found.note +=
            fmt::format("{}at the median speed of {:.4g} deg/s", found.note.empty() ? "" : ", ", speed);
    for (const double at : hz)
        found.at.push_back(
            response(filter->cascade, Hertz(std::min(at, 0.5 * rate.value())), SampledAt(rate)));
    return found;
}

std::string cell(double value, int decimals) { return std::isfinite(value) ? rounded(value, decimals) : "-"; }

}  // namespace

bool ResponseRequest::names(std::string_view signal) const {
    return signals && (signals->starts_with(fmt::format("{}/", signal)) ||
                       signals->ends_with(fmt::format("/{}", signal)));
}

bool ResponseRequest::needs_motion(const GearOptions& gear) const {
    return names("velocity") || names("position") ||
           (method && JointMethods({*method, std::nullopt, gear}).follows_motion());
}

void attach_response(Options& options, ResponseRequest& request) {
    options.text("--response", request.signals, "OUT/IN",
                 "frequency response with coherence between two signals: torque, velocity, position, or a "
                 "column by name");
    options.choice("--estimator", request.estimator, estimator_names,
                   "--response: h1 where OUT is noisy, h2 where IN is");
    options.text("--method", request.method, "SPEC",
                 "--response: a filter whose predicted response is shown, as in compare");
}

ResponseReport response_report(const ResponseRequest& request, const GearOptions& gear,
                               const ResponseLog& read) {
    const Trace& trace = read.log.trace;
    const auto [out_name, in_name] = split_signals(*request.signals, read);
    const Signal out = signal_named(out_name, read), in = signal_named(in_name, read);
    ResponseReport report{trace.joint, out.name, in.name, gain_unit(out, in), {}, {}};
    try {
        report.response =
            frequency_response({trace.sample_rate, trace.time_s, in.values, out.values, trace.run_starts},
                               {request.segment, request.resolution,
                                request.estimator == "h2" ? ResponseEstimator::h2 : ResponseEstimator::h1});
    } catch (const DataError& error) {  // the library knows no file
        raise<DataError>("{}: {}", read.path, error.what());
    }
    report.predicted = predicted(request, gear, trace, report.response.hz);
    return report;
}

std::string response_table(const ResponseReport& report) {
    const FrequencyResponse& response = report.response;
    std::string text = response_verdict(report) + "\n";
    for (const std::string& note : response_notes(report)) text += note + "\n";
    if (!report.unit.empty()) text += fmt::format("The gain is in {}.\n", report.unit);
    if (report.predicted && !report.predicted->note.empty())
        text += fmt::format("Predicted: {}.\n", report.predicted->note);
    std::vector<std::vector<std::string>> rows{
        {"Hz", "gain", "95 %", "", "phase", "+/-", "group delay", "+/-", "phase delay", "coherence"},
        {"", "dB", "from", "to", "deg", "", "ms", "", "ms", ""}};
    if (report.predicted) {
        rows[0].insert(rows[0].end(), {"predicted", ""});
        rows[1].insert(rows[1].end(), {"dB", "deg"});
    }
    for (const ResponseRow& row : third_octaves(response)) {
        const std::size_t k = row.bin;
        const auto ms = [](const std::optional<Seconds>& time) {
            return time ? 1e3 * time->value() : not_a_number;
        };
        const auto& delay = row.group_delay;
        std::vector<std::string> cells = {fmt::format("{:.4g}", response.hz[k]),
                                          cell(decibels(response.gain[k]), 2),
                                          cell(decibels(response.gain_low[k]), 2),
                                          cell(decibels(response.gain_high[k]), 2),
                                          cell(response.phase_deg[k], 1),
                                          cell(response.phase_error_deg[k], 1),
                                          cell(ms(delay ? std::optional(delay->delay) : std::nullopt), 2),
                                          cell(ms(delay ? std::optional(delay->error) : std::nullopt), 2),
                                          cell(ms(row.phase_delay), 2),
                                          rounded(response.coherence[k], 3)};
        if (report.predicted) {
            const std::complex<double>& at = report.predicted->at[k];
            cells.push_back(cell(decibels(portable::hypot(at.real(), at.imag())), 2));
            cells.push_back(cell(portable::arg(at) * degrees_per_radian, 1));
        }
        rows.push_back(std::move(cells));
    }
    return text + "\n" + text_table(rows, "r");
}

std::string response_csv(const ResponseReport& report) {
    const FrequencyResponse& response = report.response;
    std::string text = "frequency_hz,gain_db,gain_low_db,gain_high_db,phase_deg,phase_error_deg,coherence";
    text += report.predicted ? ",predicted_db,predicted_deg\n" : "\n";
    const auto add = [&text](double value) {
        if (std::isfinite(value)) text += fmt::format("{:.6g}", value);
        text += ",";
    };
    for (std::size_t k = 0; k < response.hz.size(); ++k) {
        for (const double value : {response.hz[k], decibels(response.gain[k]), decibels(response.gain_low[k]),
                                   decibels(response.gain_high[k]), response.phase_deg[k],
                                   response.phase_error_deg[k], response.coherence[k]})
            add(value);
        if (report.predicted) {
            const std::complex<double>& at = report.predicted->at[k];
            add(decibels(portable::hypot(at.real(), at.imag())));
            add(portable::arg(at) * degrees_per_radian);
        }
        text.back() = '\n';
    }
    return text;
}

}  // namespace ripplenotch
