// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "document/fields/features_fields.hpp"
#include "document/fields/fields.hpp"
#include "document/json/json_door.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/features_json.hpp"
#include "ripplenotch/fleet/log_date.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view features_line = "a line of features, as 'ripplenotch features' prints it";

class LineFields {
  public:
    LineFields(const Json& json, const std::string& source) : json_(json), source_(source) {}

    [[noreturn]] void refuse(std::string_view name, std::string_view expected) const {
        const auto found = json_.find(name);
        raise<DataError>("{}: {} is {}, expected {}", source_, name,
                         found == json_.end() ? "not there" : in_words(*found), expected);
    }
    [[nodiscard]] std::string text(std::string_view name) const {
        const auto found = json_.find(name);
        if (found == json_.end() || !found->is_string()) refuse(name, "a text");
        return found->get<std::string>();
    }
    [[nodiscard]] std::optional<double> number_or_null(std::string_view name) const {
        const auto found = json_.find(name);
        if (found == json_.end() || !(found->is_number() || found->is_null()))
            refuse(name, "a number or null");
        return found->is_null() ? std::nullopt : std::optional(found->get<double>());
    }
    [[nodiscard]] double number(std::string_view name) const {
        const auto value = number_or_null(name);
        if (!value) refuse(name, "a number");
        return *value;
    }
    [[nodiscard]] std::size_t whole(std::string_view name) const {
        const double value = number(name);
        if (value < 0.0 || value > 1e15 || value != std::floor(value)) refuse(name, "a whole number");
        return static_cast<std::size_t>(value);
    }
    [[nodiscard]] std::string reason(const std::string& name) const {
        const auto reasons = json_.find("not_told");
        if (reasons == json_.end() || !reasons->is_object()) refuse("not_told", "an object of reasons");
        const auto found = reasons->find(name);
        if (found == reasons->end() || !found->is_string() || found->get<std::string>().empty())
            raise<DataError>("{}: {} is null and not_told has no reason for it", source_, name);
        return found->get<std::string>();
    }
    [[nodiscard]] std::optional<Interval> interval(const std::string& name) const {
        const auto found = json_.find(name);
        if (found == json_.end()) return std::nullopt;
        const bool two = found->is_array() && found->size() == 2 && (*found)[0].is_number() &&
                         (*found)[1].is_number() && (*found)[0].get<double>() <= (*found)[1].get<double>();
        if (!two) refuse(name, "two numbers, the lower one first");
        return Interval{(*found)[0].get<double>(), (*found)[1].get<double>()};
    }
    [[nodiscard]] const Json& json() const { return json_; }

  private:
    const Json& json_;
    const std::string& source_;
};

bool is_known(std::string_view name) {
    constexpr std::array names = {
        "schema",    "version",     "log",        "sha256",           "robot",
        "joint",     "error",       "date",       "error_code",       "date_source",
        "rows",      "load_rms_nm", "duration_s", "temperature_degc", "temperature_source",
        "reversals", "not_told"};
    return std::find(names.begin(), names.end(), name) != names.end() ||
           std::any_of(mix_fields.begin(), mix_fields.end(),
                       [&](const MixField& field) { return field.name == name; });
}

void read_descriptors(const LineFields& line, const std::string& source, FeatureLine& read) {
    std::size_t intervals = 0;
    for (const auto& [name, value] : line.json().items()) {
        if (is_known(name)) continue;
        if (name.find("_ci95") != std::string::npos) {
            ++intervals;
            continue;
        }
        try {
            read.descriptors.push_back(descriptor_named(name));
        } catch (const DataError& error) {
            raise<DataError>("{}: {}", source, error.what());
        }
        Descriptor& one = read.descriptors.back();
        one.value = line.number_or_null(name);
        if (one.value) one.ci95 = line.interval(one.interval_name());
        if (one.ci95) --intervals;
        if (!one.value) one.reason = line.reason(name);
    }
    if (intervals != 0) raise<DataError>("{}: an interval stands beside no value", source);
}

void read_conditions(const LineFields& line, FeatureLine& read) {
    const auto date = line.json().find("date");
    if (date == line.json().end() || !(date->is_null() || date->is_string()))
        line.refuse("date", "a date or null");
    if (date->is_string()) {
        read.date = date->get<std::string>();
        if (!date_seconds(*read.date)) line.refuse("date", "a date such as 2026-01-05T12:30:00Z");
    }
    read.date_source = read.date ? line.text("date_source") : line.reason("date");
    read.temperature_degc = line.number_or_null("temperature_degc");
    read.temperature_source =
        read.temperature_degc ? line.text("temperature_source") : line.reason("temperature_degc");
    read.rows = line.whole("rows");
    read.duration_s = line.number("duration_s");
    for (const MixField& field : mix_fields) read.mix.*field.value = line.number(field.name);
    read.mix.reversals = line.whole("reversals");
    read.mix.load_rms_nm = line.number_or_null("load_rms_nm");
}

}  // namespace

FeatureLine feature_line_from_json(std::string_view text, const std::string& source) {
    const Json json = read_json(text, source, features_line);
    if (!json.is_object()) raise<DataError>("{}: expected {}", source, features_line);
    const LineFields line(json, source);
    if (line.text("schema") != features_schema) line.refuse("schema", features_schema);
    FeatureLine read;
    read.version = line.text("version");
    read.log = line.text("log");
    read.sha256 = line.text("sha256");
    read.robot = line.text("robot");
    read.joint = line.text("joint");
    if (json.contains("error")) {
        read.error = line.text("error");
        read.error_code = static_cast<int>(line.whole("error_code"));
        if (read.error.empty()) line.refuse("error", "a message");
        return read;
    }
    read_conditions(line, read);
    read_descriptors(line, source, read);
    return read;
}

std::vector<FeatureLine> feature_lines_from_text(std::string_view text, const std::string& source) {
    std::vector<FeatureLine> lines;
    for (std::size_t at = 0, number = 1; at < text.size(); ++number) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view one = text.substr(at, end - at);
        if (one.find_first_not_of(" \t\r") != std::string_view::npos)
            lines.push_back(feature_line_from_json(one, fmt::format("{}, line {}", source, number)));
        at = end + 1;
    }
    return lines;
}

}  // namespace ripplenotch
