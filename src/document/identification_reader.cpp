// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>

#include "document/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/document/identification_json.hpp"

namespace ripplenotch {
namespace {

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

/// The value of a name, where `value_of` knows it.
template <class ValueOf>
auto named(Fields& fields, std::string_view field, ValueOf value_of) {
    const std::string text = fields.text(field);
    const auto value = value_of(text);
    if (!value) raise<DataError>("{} is \"{}\", which is none of its names", fields.where(field), text);
    return *value;
}

LineKind kind_at(Fields& fields) {
    const std::string text = fields.text("kind");
    for (const LineKind kind : {LineKind::order, LineKind::tone, LineKind::alias, LineKind::unknown}) {
        if (line_kind_name(kind) == text) return kind;
    }
    raise<DataError>("{} is \"{}\", expected one of order, tone, alias, unknown", fields.where("kind"), text);
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

std::size_t whole_at(Fields& fields, std::string_view name) {
    const double number = fields.number(name);
    if (number < 0.0 || number != std::floor(number) || number > 1e9)
        raise<DataError>("{} is {}, expected a whole number", fields.where(name), number);
    return static_cast<std::size_t>(number);
}

Disagreement disagreement_from_json(Fields& fields, const std::string& source, const std::string& path) {
    Disagreement one;
    one.about = named(fields, "about", about_of);
    one.order = optional_number(fields, "order");
    one.order_output = optional_number(fields, "order_output");
    one.chance = fields.number("chance");
    const Json& values = array_at(fields, "values");
    for (std::size_t i = 0; i < values.size(); ++i) {
        Fields entry(values[i], source, fmt::format("{}.values[{}]", path, i));
        one.values.push_back({whole_at(entry, "recording"), entry.number("value"), entry.number("stderr")});
        entry.finish();
    }
    return one;
}

/// Older files have none of it.
void besides_from_json(Fields& fields, const std::string& source, Identification& found) {
    if (fields.find("families") != nullptr) {
        for_each_object(fields, "families", source, [&](Fields& entry) {
            ToneFamily family{entry.number("hz"), entry.number("hz_stderr"), {}};
            for (const double n : numbers_at(entry, "multiples"))
                family.multiples.push_back(static_cast<int>(n));
            found.families.push_back(std::move(family));
        });
    }
    if (fields.find("hums") != nullptr) {
        for_each_object(fields, "hums", source, [&](Fields& entry) {
            found.hums.push_back({entry.number("from_hz"), entry.number("to_hz"), entry.number("peak_hz"),
                                  entry.number("rms_nm")});
        });
    }
    if (fields.find("disagreements") == nullptr) return;
    std::size_t number = 0;
    for_each_object(fields, "disagreements", source, [&](Fields& entry) {
        found.disagreements.push_back(
            disagreement_from_json(entry, source, fmt::format("disagreements[{}]", number++)));
    });
}

}  // namespace

Identification identification_from_json(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "joint");
    Fields fields(json, source, "");
    fields.ignore({"schema", "tool", "version", "command", "inputs", "recording", "recordings", "gear"});
    Identification found;
    found.verdict = fields.text("verdict");
    // Older files tell the finding in words alone.
    if (fields.find("finding") != nullptr) found.finding = named(fields, "finding", finding_of);
    if (fields.find("doubts") != nullptr) {
        for_each_object(fields, "doubts", source, [&](Fields& entry) {
            found.doubts.push_back({named(entry, "reason", doubt_of), entry.text("because")});
        });
    }
    const Json& conclusive = fields.at("conclusive");
    if (!conclusive.is_boolean()) raise<DataError>("{} is not true or false", fields.where("conclusive"));
    found.conclusive = conclusive.get<bool>();
    if (fields.find("joint") != nullptr) found.joint = fields.text("joint");
    found.sample_rate = Hertz(fields.number("sample_rate_hz"));
    if (!(found.sample_rate.value() > 0.0)) {
        raise<DataError>("{} is {}, expected a positive number", fields.where("sample_rate_hz"),
                         found.sample_rate.value());
    }
    found.evidence = named(fields, "evidence", evidence_of);
    Fields ratio(fields.at("gear_ratio"), source, "gear_ratio");
    found.gear_ratio = ratio_from_json(ratio, source);
    ratio.finish();
    std::size_t number = 0;
    for_each_object(fields, "lines", source, [&](Fields& entry) {
        found.lines.push_back(line_from_json(entry, source, fmt::format("lines[{}]", number++)));
    });
    besides_from_json(fields, source, found);
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
