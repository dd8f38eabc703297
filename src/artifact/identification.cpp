// SPDX-License-Identifier: MIT
#include "ripplenotch/artifact/identification.hpp"

#include <array>

#include "artifact/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"

namespace ripplenotch {
namespace {

Json optional_to_json(const std::optional<double>& value) {
    return value ? finite_or_null(*value) : Json(nullptr);
}

std::optional<double> optional_number(Fields& fields, std::string_view name) {
    if (fields.find(name) == nullptr) return std::nullopt;
    return fields.number(name);
}

const Json& array_at(Fields& fields, std::string_view name) {
    const Json& value = fields.at(name);
    if (!value.is_array()) raise<DataError>("{} is not a list", fields.where(name));
    return value;
}

std::array<double, 2> pair_at(Fields& fields, std::string_view name) {
    const Json& value = array_at(fields, name);
    if (value.size() != 2 || !value[0].is_number() || !value[1].is_number()) {
        raise<DataError>("{} is {}, expected two numbers", fields.where(name), value.dump());
    }
    return {value[0].get<double>(), value[1].get<double>()};
}

std::vector<double> numbers_at(Fields& fields, std::string_view name) {
    std::vector<double> numbers;
    for (const Json& value : array_at(fields, name)) {
        if (!value.is_number())
            raise<DataError>("{} holds {}, expected numbers", fields.where(name), value.dump());
        numbers.push_back(value.get<double>());
    }
    return numbers;
}

/// Reads each entry of a list of objects with `read(fields)`, strictly.
template <class Read>
void for_each_object(Fields& fields, std::string_view name, const std::string& source, Read read) {
    const Json& list = array_at(fields, name);
    for (std::size_t i = 0; i < list.size(); ++i) {
        Fields entry(list[i], source, fmt::format("{}[{}]", name, i));
        read(entry);
        entry.finish();
    }
}

LineKind kind_at(Fields& fields) {
    const std::string text = fields.text("kind");
    for (const LineKind kind : {LineKind::order, LineKind::tone, LineKind::alias, LineKind::unknown}) {
        if (line_kind_name(kind) == text) return kind;
    }
    raise<DataError>("{} is \"{}\", expected one of order, tone, alias, unknown", fields.where("kind"), text);
}

Json line_to_json(const Line& line) {
    Json json;
    json["kind"] = line_kind_name(line.kind);
    json["order"] = optional_to_json(line.order);
    json["order_output"] = optional_to_json(line.order_output);
    json["order_output_stderr"] = optional_to_json(line.order_output_stderr);
    json["order_output_seen"] = optional_to_json(line.order_output_seen);
    json["could_be"] = line.could_be;
    json["hz"] = optional_to_json(line.hz);
    json["amplitude_nm"] = line.amplitude_nm;
    json["phase_deg"] = line.phase_known ? finite_or_null(line.phase_deg) : Json(nullptr);
    json["snr"] = line.snr;
    json["speed_range_deg_s"] = {line.speed_from_deg_s, line.speed_to_deg_s};
    json["amplitude_by_speed"] = Json::array();
    for (const AmplitudeAtSpeed& at : line.by_speed) {
        json["amplitude_by_speed"].push_back({{"speed_deg_s", at.speed_deg_s},
                                              {"hz", at.hz},
                                              {"amplitude_nm", at.amplitude_nm},
                                              {"snr", at.snr}});
    }
    json["note"] = line.note;
    return json;
}

Line line_from_json(Fields& fields, const std::string& source, const std::string& path) {
    Line line;
    line.kind = kind_at(fields);
    line.order = optional_number(fields, "order");
    line.order_output = optional_number(fields, "order_output");
    line.order_output_stderr = optional_number(fields, "order_output_stderr");
    line.order_output_seen = optional_number(fields, "order_output_seen");
    if (fields.find("could_be") != nullptr) line.could_be = numbers_at(fields, "could_be");
    line.hz = optional_number(fields, "hz");
    line.amplitude_nm = fields.number("amplitude_nm");
    if (const auto phase = optional_number(fields, "phase_deg")) {
        line.phase_deg = *phase;
        line.phase_known = true;
    }
    line.snr = fields.number("snr");
    const auto range = pair_at(fields, "speed_range_deg_s");
    line.speed_from_deg_s = range[0];
    line.speed_to_deg_s = range[1];
    const Json& list = array_at(fields, "amplitude_by_speed");
    for (std::size_t i = 0; i < list.size(); ++i) {
        Fields entry(list[i], source, fmt::format("{}.amplitude_by_speed[{}]", path, i));
        line.by_speed.push_back({entry.number("speed_deg_s"), entry.number("hz"),
                                 entry.number("amplitude_nm"), entry.number("snr")});
        entry.finish();
    }
    if (fields.find("note") != nullptr) line.note = fields.text("note");
    return line;
}

Json ratio_to_json(const GearRatioFit& fit) {
    Json json;
    json["value"] = optional_to_json(fit.value);
    json["stderr"] = fit.value ? finite_or_null(fit.standard_error) : Json(nullptr);
    json["ci95"] =
        fit.value ? Json{finite_or_null(fit.ci95_low), finite_or_null(fit.ci95_high)} : Json(nullptr);
    json["candidates"] = Json::array();
    for (const RatioCandidate& candidate : fit.candidates) {
        json["candidates"].push_back(
            {{"value", candidate.value}, {"score", candidate.score}, {"reason", candidate.reason}});
    }
    json["residuals"] = Json::array();
    for (const auto& r : fit.residuals) {
        json["residuals"].push_back({{"speed_deg_s", r.speed_deg_s},
                                     {"hz", r.hz},
                                     {"order", r.order},
                                     {"residual_hz", r.residual_hz},
                                     {"weight", r.weight}});
    }
    return json;
}

GearRatioFit ratio_from_json(Fields& fields, const std::string& source) {
    GearRatioFit fit;
    fit.value = optional_number(fields, "value");
    fit.standard_error = optional_number(fields, "stderr").value_or(0.0);
    if (fields.find("ci95") != nullptr) {
        const auto interval = pair_at(fields, "ci95");
        fit.ci95_low = interval[0];
        fit.ci95_high = interval[1];
    }
    if (fit.value && !(*fit.value > 0.0)) {
        raise<DataError>("{} is {}, expected a positive number or null", fields.where("value"), *fit.value);
    }
    const Json& candidates = array_at(fields, "candidates");
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        Fields entry(candidates[i], source, fmt::format("gear_ratio.candidates[{}]", i));
        fit.candidates.push_back({entry.number("value"), entry.number("score"), entry.text("reason")});
        entry.finish();
    }
    if (fields.find("residuals") == nullptr) return fit;
    const Json& residuals = array_at(fields, "residuals");
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        Fields entry(residuals[i], source, fmt::format("gear_ratio.residuals[{}]", i));
        fit.residuals.push_back({entry.number("speed_deg_s"), entry.number("hz"), entry.number("order"),
                                 entry.number("residual_hz"), entry.number("weight")});
        entry.finish();
    }
    return fit;
}

void add_fields(Json& json, const Identification& identification) {
    json["verdict"] = identification.verdict;
    json["conclusive"] = identification.conclusive;
    json["joint"] = identification.joint;
    json["sample_rate_hz"] = identification.sample_rate.value();
    json["evidence"] = identification.evidence;
    json["gear_ratio"] = ratio_to_json(identification.gear_ratio);
    json["lines"] = Json::array();
    for (const Line& line : identification.lines) json["lines"].push_back(line_to_json(line));
    json["notes"] = identification.notes;
}

}  // namespace

std::string identification_text(const Identification& identification, const Provenance& provenance) {
    Json json = document_head("joint", provenance);
    add_fields(json, identification);
    return to_text(json);
}

std::string identifications_text(std::span<const Identification> identifications,
                                 const Provenance& provenance) {
    Json json = document_head("joints", provenance);
    json["joints"] = Json::array();
    for (const Identification& identification : identifications) {
        Json entry = Json::object();
        add_fields(entry, identification);
        json["joints"].push_back(std::move(entry));
    }
    return to_text(json);
}

Identification identification_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "joint");
    Fields fields(json, source, "");
    fields.ignore({"schema", "tool", "version", "command", "inputs"});
    Identification found;
    found.verdict = fields.text("verdict");
    const Json& conclusive = fields.at("conclusive");
    if (!conclusive.is_boolean()) raise<DataError>("{} is not true or false", fields.where("conclusive"));
    found.conclusive = conclusive.get<bool>();
    if (fields.find("joint") != nullptr) found.joint = fields.text("joint");
    found.sample_rate = Hertz(fields.number("sample_rate_hz"));
    if (!(found.sample_rate.value() > 0.0)) {
        raise<DataError>("{} is {}, expected a positive number", fields.where("sample_rate_hz"),
                         found.sample_rate.value());
    }
    found.evidence = fields.text("evidence");
    Fields ratio(fields.at("gear_ratio"), source, "gear_ratio");
    found.gear_ratio = ratio_from_json(ratio, source);
    ratio.finish();
    std::size_t number = 0;
    for_each_object(fields, "lines", source, [&](Fields& entry) {
        found.lines.push_back(line_from_json(entry, source, fmt::format("lines[{}]", number++)));
    });
    for (const Json& note : array_at(fields, "notes")) {
        if (!note.is_string())
            raise<DataError>("{} holds {}, expected texts", fields.where("notes"), note.dump());
        found.notes.push_back(note.get<std::string>());
    }
    fields.finish();
    return found;
}

Identification load_identification(const std::string& path) {
    return identification_from_json(read_all(path), path == "-" ? "standard input" : path);
}

}  // namespace ripplenotch
