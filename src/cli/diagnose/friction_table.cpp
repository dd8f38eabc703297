// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>

#include "cli/diagnose/joint_diagnosis.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/diagnose/friction_table.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// Rows have no time of their own; the reader asks for some clock.
ReadOptions reading_of(const DiagnoseRequest& request) {
    ReadOptions reading = request.log;
    reading.sample_rate = Hertz(1.0);
    reading.takes_motor_units = true;
    reading.gear_ratio = request.gear.ratio;
    return reading;
}

// Whether a log might be a table, before it is opened: nothing is stated that only a log has.
bool may_be_table(const DiagnoseRequest& request) {
    const bool has_model = !request.model.empty() && request.model != "auto";
    return !request.path.empty() && request.path != "-" && !has_model && !request.log.sample_rate &&
           !request.log.constant_speed && !request.given.any() && !request.validate;
}

// Opens as a log: then it has a clock, in a column or in its head, or its motion is a position.
bool has_clock(const DiagnoseRequest& request) {
    ReadOptions reading = request.log;
    reading.takes_motor_units = true;
    try {
        (void)open_log(request.path, reading);
        return true;
    } catch (const Error&) {
        return false;
    }
}

bool has_speed_and_torque_alone(const DiagnoseRequest& request) {
    try {
        const auto reader = open_log(request.path, reading_of(request));
        const Layout& layout = reader->layout();
        return !layout.chosen.time && !layout.chosen.position && layout.chosen.velocity &&
               layout.chosen.torque && layout.joints.size() <= 1;
    } catch (const Error&) {
        return false;  // what is wrong with it is said where it is read as a log
    }
}

void check_table_options(const DiagnoseRequest& request) {
    const auto refuse = [](bool given, std::string_view option) {
        if (given) raise<UsageError>("{} has no use with a friction table, which is fitted alone", option);
    };
    refuse(!request.model.empty() && request.model != "auto", "--model FILE");
    refuse(request.validate.has_value(), "--validate");
    refuse(request.given.simulated.has_value(), "--simulated");
    refuse(request.given.arm.has_value(), "--arm");
    refuse(request.log.sample_rate.has_value(), "--sample-rate");
    refuse(request.common.plot.has_value(), "--plot");
    check_improved(request, ".json");
}

std::string values_of_term(const FrictionDiagnosis& found, std::size_t place) {
    const Term& term = found.model.terms[place];
    std::string text;
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        const auto fitted = std::ranges::find_if(found.values, [&](const FittedValue& value) {
            return value.term == place && value.parameter == p;
        });
        text += fitted != found.values.end()
                    ? fmt::format("  {}{}{}\n", value_text(term, *fitted), parameter.unit.empty() ? "" : " ",
                                  parameter.unit)
                    : fmt::format("  {} = {} {} (assumed: each row is steady motion)\n", parameter.name,
                                  short_number(*term.values[p]), parameter.unit);
    }
    return text;
}

std::string friction_story(const CommonOptions& common, const FrictionDiagnosis& found) {
    std::string names;
    for (const Term& term : found.model.terms)
        names += fmt::format("{}{}", names.empty() ? "" : ", ", term.effect->name);
    std::string text =
        paragraph(common, fmt::format("Friction: {}; residual {:.3g} Nm rms, noise of a row {:.3g} Nm.",
                                      names, found.residual_nm, found.noise_nm));
    text +=
        fmt::format("{} rows from {} to {} deg/s, {} in positive and {} in negative direction{}\n",
                    found.rows, short_number(found.speed_deg_s.from), short_number(found.speed_deg_s.to),
                    found.positive, found.negative,
                    found.rows_at_rest > 0 ? fmt::format("; {} at rest, not used", found.rows_at_rest) : "");
    for (std::size_t t = 0; t < found.model.terms.size(); ++t)
        text += fmt::format("{}\n{}", found.model.terms[t].effect->name, values_of_term(found, t));
    for (const TriedFriction& one : found.tried)
        text += fmt::format("{}: {} (chance that noise does as much: {:.2g})\n", one.effect,
                            one.found ? "found" : "not found", one.chance);
    if (found.stribeck_deg_s)
        text += fmt::format(
            "stribeck-friction as large as Coulomb friction would be found at Stribeck speeds of {} to {} "
            "deg/s\n",
            short_number(found.stribeck_deg_s->from), short_number(found.stribeck_deg_s->to));
    for (const Tie& tie : found.ambiguous)
        text +=
            fmt::format("{}: this table cannot tell; {} would\n", joined(tie.effects, " or "), tie.advice);
    for (const Undecidable& one : found.undecidable)
        text += fmt::format("not examined: {}: {}\n", one.effect, one.reason);
    return text;
}

}  // namespace

std::optional<Log> friction_table_of(const DiagnoseRequest& request) {
    const bool is_stated = request.friction_table;
    if (is_stated && request.path.empty()) raise<UsageError>("LOG is missing: the table of speed and torque");
    if (is_stated) check_table_options(request);
    if (!is_stated && (!may_be_table(request) || has_clock(request) || !has_speed_and_torque_alone(request)))
        return std::nullopt;
    if (is_stated && request.path != "-" && has_clock(request))
        raise<DataError>("{}: it has a time, expected a table of constant speeds; leave out --friction-table",
                         request.path);
    Log table = read_log(request.path, reading_of(request));
    // A log of fewer rows is refused, so that such a file can only be a table.
    const std::size_t of_a_log = fewest_samples_diagnosed;
    if (!is_stated && table.trace.size() >= of_a_log)
        raise<DataError>(
            "{}: {} rows of speed and torque without a time, which may be a log or a table of constant "
            "speeds; use --sample-rate 1kHz for a log, or --friction-table",
            request.path, table.trace.size());
    if (!is_stated) check_table_options(request);
    refuse_open_readings(table);
    return table;
}

Answer run_friction_table(const DiagnoseRequest& request, const Log& table, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    if (request.path != "-") provenance.inputs.push_back(input_record(request.path));
    say_layout(request.common, table.layout);
    const auto found = std::make_shared<FrictionDiagnosis>();
    try {
        *found = diagnose_friction({table.trace.velocity_deg_s, table.trace.torque_nm});
    } catch (const DataError& error) {  // the library knows no file
        raise<DataError>("{}: {}", request.path, error.what());
    }
    Answer answer{friction_story(request.common, *found)};
    answer.document = [=] { return write_friction(*found, provenance); };
    if (request.improved)
        answer.files.push_back({*request.improved, write_model(found->model, provenance),
                                fmt::format("the model is in {}", *request.improved)});
    if (request.require_conclusive && !found->ambiguous.empty()) answer.code = ExitCode::inconclusive;
    return answer;
}

}  // namespace ripplenotch
