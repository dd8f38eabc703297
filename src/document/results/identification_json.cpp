// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/identification_json.hpp"

namespace ripplenotch {

namespace {

std::array<double, 2> pair_at(Fields& fields, std::string_view name) {
    const Json& value = fields.list(name);
    if (value.size() != 2 || !value[0].is_number() || !value[1].is_number()) {
        raise<DataError>("{} is {}, expected two numbers", fields.where(name), in_words(value));
    }
    return {value[0].get<double>(), value[1].get<double>()};
}

LineKind kind_at(Fields& fields) {
    const std::string text = fields.text("kind");
    for (const LineKind kind : {LineKind::order, LineKind::tone, LineKind::unknown}) {
        if (line_kind_name(kind) == text) return kind;
    }
    raise<DataError>("{} is \"{}\", expected one of order, tone, unknown", fields.where("kind"), text);
}

Line line_from_json(Fields& fields) {
    Line line;
    line.kind = kind_at(fields);
    line.order = fields.number_if_any("order");
    line.order_output = fields.number_if_any("order_output");
    line.order_output_stderr = fields.number_if_any("order_output_stderr");
    if (fields.has("could_be")) line.could_be = fields.numbers("could_be");
    line.hz = fields.number_if_any("hz");
    line.amplitude_nm = fields.number("amplitude_nm");
    if (const auto phase = fields.number_if_any("phase_deg")) {
        line.phase_deg = *phase;
        line.phase_known = true;
    }
    line.snr = fields.number("snr");
    const auto range = pair_at(fields, "speed_range_deg_s");
    line.speed_from_deg_s = range[0];
    line.speed_to_deg_s = range[1];
    fields.each("amplitude_by_speed", [&](Fields& entry) {
        line.by_speed.push_back({entry.number("speed_deg_s"), entry.number("hz"),
                                 entry.number("amplitude_nm"), entry.number("snr")});
    });
    if (fields.has("note")) line.note = fields.text("note");
    return line;
}

GearRatioFit ratio_from_json(Fields& fields) {
    GearRatioFit fit;
    fit.value = fields.number_if_any("value");
    fit.standard_error = fields.number_if_any("stderr").value_or(0.0);
    if (fields.has("ci95")) {
        const auto interval = pair_at(fields, "ci95");
        fit.ci95_low = interval[0];
        fit.ci95_high = interval[1];
    }
    if (fit.value && !(*fit.value > 0.0)) {
        raise<DataError>("{} is {}, expected a positive number or null", fields.where("value"), *fit.value);
    }
    if (fields.has("second_comb")) fit.second_comb = fields.number_if_any("second_comb");
    fields.each("candidates", [&](Fields& entry) {
        fit.candidates.push_back({entry.number("value"), entry.number("score"), entry.text("reason"),
                                  entry.has("other_unit") && entry.flag("other_unit")});
    });
    if (!fields.has("residuals")) return fit;
    fields.each("residuals", [&](Fields& entry) {
        fit.residuals.push_back({entry.number("speed_deg_s"), entry.number("hz"), entry.number("order"),
                                 entry.number("residual_hz"), entry.number("weight")});
    });
    return fit;
}

Disagreement disagreement_from_json(Fields& fields) {
    Disagreement one;
    one.about = fields.named("about", about_of);
    one.order = fields.number_if_any("order");
    one.order_output = fields.number_if_any("order_output");
    one.chance = fields.number("chance");
    fields.each("values", [&](Fields& entry) {
        one.values.push_back({entry.whole("recording"), entry.number("value"), entry.number("stderr")});
    });
    return one;
}

int multiple_of(const Fields& fields, double number) {
    constexpr double most = 1e6;
    if (!(number >= 1.0 && number <= most) || number != std::floor(number))
        raise<DataError>("{} holds {}, expected whole numbers from 1 to {}", fields.where("multiples"),
                         number, most);
    return static_cast<int>(number);
}

// Older files have none of it.
void besides_from_json(Fields& fields, Identification& found) {
    if (fields.has("velocity_error")) {
        Fields error = fields.object("velocity_error");
        VelocityError told{DegPerSec(error.number("offset_deg_s")),
                           DegPerSec(error.number("offset_stderr_deg_s")), Seconds(), Seconds()};
        const auto delay = error.number_if_any("delay_s"),
                   delay_error = error.number_if_any("delay_stderr_s");
        told.delay_told = delay && delay_error;
        if (told.delay_told) {
            told.delay = Seconds(*delay);
            told.delay_error = Seconds(*delay_error);
        }
        found.velocity_error = told;
        error.finish();
    }
    if (fields.has("families")) {
        fields.each("families", [&](Fields& entry) {
            ToneFamily family{entry.number("hz"), entry.number("hz_stderr"), {}};
            for (const double n : entry.numbers("multiples"))
                family.multiples.push_back(multiple_of(entry, n));
            found.families.push_back(std::move(family));
        });
    }
    if (fields.has("hums")) {
        fields.each("hums", [&](Fields& entry) {
            found.hums.push_back({entry.number("from_hz"), entry.number("to_hz"), entry.number("peak_hz"),
                                  entry.number("rms_nm")});
        });
    }
    if (!fields.has("disagreements")) return;
    fields.each("disagreements",
                [&](Fields& entry) { found.disagreements.push_back(disagreement_from_json(entry)); });
}

}  // namespace

Identification identification_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "joint");
    Fields fields(json, source, "");
    fields.ignore_head();
    fields.ignore({"gear"});
    Identification found;
    found.verdict = fields.text("verdict");
    // Older files tell the finding in words alone.
    if (fields.has("finding")) found.finding = fields.named("finding", finding_of);
    if (fields.has("doubts")) {
        fields.each("doubts", [&](Fields& entry) {
            found.doubts.push_back({entry.named("reason", doubt_of), entry.text("because")});
        });
    }
    found.conclusive = fields.flag("conclusive");
    if (fields.has("joint")) found.joint = fields.text("joint");
    found.sample_rate = Hertz(fields.number("sample_rate_hz"));
    if (!(found.sample_rate.value() > 0.0)) {
        raise<DataError>("{} is {}, expected a positive number", fields.where("sample_rate_hz"),
                         found.sample_rate.value());
    }
    found.evidence = fields.text("evidence");
    if (fields.has("searched")) {
        Fields searched = fields.object("searched");
        found.searched = {searched.number("lowest_order"),
                          searched.number("highest_order"),
                          searched.number("detectable_nm"),
                          {}};
        searched.each("bounds", [&](Fields& entry) {
            found.searched->bounds.push_back({entry.number("from_order"), entry.number("detectable_nm")});
        });
        searched.finish();
    }
    Fields ratio = fields.object("gear_ratio");
    found.gear_ratio = ratio_from_json(ratio);
    ratio.finish();
    fields.each(
        "lines", [&](Fields& entry) { found.lines.push_back(line_from_json(entry)); }, most_lines);
    besides_from_json(fields, found);
    found.notes = fields.texts("notes");
    fields.finish();
    return found;
}

Identification load_identification(const std::string& path) {
    return identification_from_json(read_all(path), path == "-" ? "standard input" : path);
}

namespace {

Json optional_to_json(const std::optional<double>& value) {
    return value ? finite_or_null(*value) : Json(nullptr);
}

Json line_to_json(const Line& line) {
    Json json = Json::object();
    json["kind"] = line_kind_name(line.kind);
    json["order"] = optional_to_json(line.order);
    json["order_output"] = optional_to_json(line.order_output);
    json["order_output_stderr"] = optional_to_json(line.order_output_stderr);
    json["could_be"] = line.could_be;
    json["hz"] = optional_to_json(line.hz);
    json["amplitude_nm"] = line.amplitude_nm;
    json["phase_deg"] = line.phase_known ? finite_or_null(line.phase_deg) : Json(nullptr);
    json["snr"] = line.snr;
    json["speed_range_deg_s"] = {line.speed_from_deg_s, line.speed_to_deg_s};
    json["amplitude_by_speed"] = Json::array();
    for (const AmplitudeAtSpeed& at : line.by_speed) {
        list_in(json, "amplitude_by_speed")
            .push_back({{"speed_deg_s", at.speed_deg_s},
                        {"hz", at.hz},
                        {"amplitude_nm", at.amplitude_nm},
                        {"snr", at.snr}});
    }
    json["note"] = line.note;
    return json;
}

Json ratio_to_json(const GearRatioFit& fit) {
    Json json = Json::object();
    json["value"] = optional_to_json(fit.value);
    json["stderr"] = fit.value ? finite_or_null(fit.standard_error) : Json(nullptr);
    json["ci95"] =
        fit.value ? Json{finite_or_null(fit.ci95_low), finite_or_null(fit.ci95_high)} : Json(nullptr);
    json["second_comb"] = optional_to_json(fit.second_comb);
    json["candidates"] = Json::array();
    for (const RatioCandidate& candidate : fit.candidates) {
        list_in(json, "candidates")
            .push_back({{"value", candidate.value},
                        {"score", candidate.score},
                        {"reason", candidate.reason},
                        {"other_unit", candidate.other_unit}});
    }
    json["residuals"] = Json::array();
    for (const auto& r : fit.residuals) {
        // As many decimals as the frequency has: below them is only how a processor rounds.
        list_in(json, "residuals")
            .push_back({{"speed_deg_s", r.speed_deg_s},
                        {"hz", r.hz},
                        {"order", r.order},
                        {"residual_hz", to_digits_in_row({.value = r.residual_hz, .largest = r.hz})},
                        {"weight", r.weight}});
    }
    return json;
}

Json velocity_error_to_json(const std::optional<VelocityError>& error) {
    if (!error) return nullptr;
    Json json = {{"offset_deg_s", to_digits_in_row({.value = error->offset.value(),
                                                    .largest = 10.0 * error->offset_error.value()})},
                 {"offset_stderr_deg_s", error->offset_error.value()},
                 {"delay_s", nullptr},
                 {"delay_stderr_s", nullptr}};
    if (!error->delay_told) return json;
    json["delay_s"] =
        to_digits_in_row({.value = error->delay.value(), .largest = 10.0 * error->delay_error.value()});
    json["delay_stderr_s"] = to_digits(error->delay_error.value());
    return json;
}

void add_besides(Json& json, const Identification& identification) {
    json["velocity_error"] = velocity_error_to_json(identification.velocity_error);
    json["families"] = Json::array();
    for (const ToneFamily& family : identification.families) {
        list_in(json, "families")
            .push_back({{"hz", family.hz}, {"hz_stderr", family.hz_stderr}, {"multiples", family.multiples}});
    }
    json["hums"] = Json::array();
    for (const Hum& hum : identification.hums) {
        list_in(json, "hums")
            .push_back({{"from_hz", hum.from_hz},
                        {"to_hz", hum.to_hz},
                        {"peak_hz", hum.peak_hz},
                        {"rms_nm", hum.rms_nm}});
    }
    json["disagreements"] = Json::array();
    for (const Disagreement& one : identification.disagreements) {
        Json entry = Json::object();
        entry["about"] = about_name(one.about);
        entry["order"] = optional_to_json(one.order);
        entry["order_output"] = optional_to_json(one.order_output);
        entry["chance"] = one.chance;
        entry["values"] = Json::array();
        for (const Disagreement::Value& value : one.values) {
            list_in(entry, "values")
                .push_back({{"recording", value.recording}, {"value", value.value}, {"stderr", value.error}});
        }
        list_in(json, "disagreements").push_back(std::move(entry));
    }
}

void add_fields(Json& json, const Identification& identification) {
    json["verdict"] = identification.verdict;
    json["finding"] = finding_name(identification.finding);
    json["doubts"] = Json::array();
    for (const Doubt& doubt : identification.doubts)
        list_in(json, "doubts").push_back({{"reason", doubt_name(doubt.reason)}, {"because", doubt.because}});
    json["conclusive"] = identification.conclusive;
    json["joint"] = identification.joint;
    json["sample_rate_hz"] = identification.sample_rate.value();
    json["evidence"] = identification.evidence;
    json["searched"] = nullptr;
    if (const auto& searched = identification.searched) {
        json["searched"] = {{"lowest_order", searched->lowest_order},
                            {"highest_order", searched->highest_order},
                            {"detectable_nm", searched->detectable_nm},
                            {"bounds", Json::array()}};
        for (const SearchedOrders::Bound& bound : searched->bounds)
            list_in(json["searched"], "bounds")
                .push_back({{"from_order", bound.from_order}, {"detectable_nm", bound.detectable_nm}});
    }
    json["gear_ratio"] = ratio_to_json(identification.gear_ratio);
    json["gear"] = gear_to_json(found_gear(identification));
    json["lines"] = Json::array();
    for (const Line& line : identification.lines) list_in(json, "lines").push_back(line_to_json(line));
    add_besides(json, identification);
    json["notes"] = identification.notes;
}

}  // namespace

std::string identification_text(const Identification& identification, const Provenance& provenance) {
    Json json = document_head("joint", provenance);
    add_fields(json, identification);
    return to_fitted_text(std::move(json));
}

std::string identifications_text(std::span<const Identification> identifications,
                                 const Provenance& provenance) {
    Json json = document_head("joints", provenance);
    json["joints"] = Json::array();
    for (const Identification& identification : identifications) {
        Json entry = Json::object();
        add_fields(entry, identification);
        list_in(json, "joints").push_back(std::move(entry));
    }
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
