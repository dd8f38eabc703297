// SPDX-License-Identifier: MIT
// The head of a TwinCAT Scope export.
#include "log/text/text_dialect.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view name_key = "Name";
constexpr std::size_t most_lines = 60;  // the longest heads have 17 lines for channels and 4 for the project
constexpr double ticks_since_1601 = 1e16;  // no recording has so many milliseconds

// The lines of a head, less "Name".
constexpr std::array<std::string_view, 18> keys = {
    "SymbolComment", "Data-Type",        "SampleTime[ms]", "VariableSize", "SymbolBased",
    "IndexGroup",    "IndexOffset",      "SymbolName",     "NetID",        "NetId",
    "Port",          "Offset",           "ScaleFactor",    "BitMask",      "Unit",
    "Comment",       "Unit ScaleFactor", "Unit Offset"};

std::optional<double> scope_number(std::string_view cell) {
    const auto number = parse_number(cell, '.');
    return number ? number : parse_number(cell, ',');
}

class Head {
  public:
    Head(const TextLines& lines, char delimiter) : lines_(lines), delimiter_(delimiter) {}

    [[nodiscard]] std::vector<std::string> cells(std::size_t line) const {
        return lines_.cells(line, delimiter_);
    }
    [[nodiscard]] bool is_names(std::size_t line) const {
        const std::string_view text = lines_.line(line);
        return text.size() > name_key.size() + 1 && text.starts_with(name_key) &&
               text[name_key.size()] == delimiter_;
    }
    [[nodiscard]] bool is_row(std::size_t line) const {
        const std::vector<std::string> row = cells(line);
        return !row.empty() && scope_number(row.front()).has_value();
    }
    [[nodiscard]] bool is_key(std::size_t line) const {
        const std::vector<std::string> found = cells(line);
        return !found.empty() && std::ranges::find(keys, found.front()) != keys.end();
    }

    /// Finds both; false where there are none, or lines of something else between them: a head that begins
    /// with "Name" by chance.
    bool find_lines() {
        const std::size_t end = std::min(lines_.content.size(), most_lines);
        for (first_row = 1; first_row < end && !is_row(first_row); ++first_row)
            if (is_names(first_row)) names_line = first_row;
        if (first_row >= end) return false;
        for (std::size_t line = names_line + 1; line < first_row; ++line)
            if (!is_key(line)) return false;
        return true;
    }
    std::size_t names_line = 0, first_row = 0;  ///< of the lines of content

    /// What the head says under `key` of each column, as cells; empty where there is no such line.
    [[nodiscard]] std::vector<std::string> under(std::string_view key) const {
        for (std::size_t line = names_line + 1; line < first_row; ++line) {
            std::vector<std::string> found = cells(line);
            if (!found.empty() && found.front() == key) return found;
        }
        return {};
    }

  private:
    const TextLines& lines_;
    char delimiter_;
};

// "Nm (Torque)", "mNm (Torque)", "° (Angle)": the unit, then what it measures.
std::string scope_unit(const std::string& text) {
    const std::size_t bracket = text.ends_with(')') ? text.rfind('(') : std::string::npos;
    std::string unit = text.substr(0, bracket);
    while (unit.ends_with(' ')) unit.pop_back();
    return unit == "None" || unit == "-" ? "" : unit;
}

// A unit's own size says nothing that its name does not say: 0.001 of mNm.
bool is_size_of(double factor, const std::string& unit) {
    for (const Role role : {Role::velocity, Role::torque, Role::position}) {
        const auto usual = usual_unit(unit, role);
        const auto size = usual ? role_factor(role, *usual) : std::nullopt;
        if (!size) continue;
        const double in_si = role == Role::torque ? *size : *size / degrees_per_radian;
        for (const double known : {in_si, 1.0 / in_si})
            if (std::abs(factor / known - 1.0) < 1e-3) return true;
    }
    return false;
}

struct ScaleKey {
    std::string_view key;
    bool factor, of_unit;
};
constexpr std::array scale_keys = {ScaleKey{"ScaleFactor", true, false}, ScaleKey{"Offset", false, false},
                                   ScaleKey{"Unit ScaleFactor", true, true},
                                   ScaleKey{"Unit Offset", false, true}};

void read_scales(const Head& head, std::size_t shift, TextDialect& found) {
    found.scales.assign(found.names.size(), {});
    for (const ScaleKey& key : scale_keys) {
        const std::vector<std::string> cells = head.under(key.key);
        for (std::size_t c = 0; c < found.names.size() && c + shift < cells.size(); ++c) {
            const auto number = scope_number(cells[c + shift]);
            if (!number || *number == (key.factor ? 1.0 : 0.0)) continue;
            if (key.factor && key.of_unit && is_size_of(*number, found.units[c])) continue;
            HeadScale& scale = found.scales[c];
            scale.words += (scale.words.empty() ? "" : ", ") + std::string(key.key) + " " + shortest(*number);
            (key.factor ? scale.factor *= * number : scale.offset += *number);
        }
    }
}

std::optional<double> common_step(const Head& head, const std::string& source) {
    const std::vector<std::string> cells = head.under("SampleTime[ms]");
    std::optional<double> step_ms;
    for (std::size_t c = 1; c < cells.size(); ++c) {
        const auto number = scope_number(cells[c]);
        if (!number || !(*number > 0.0)) continue;
        if (step_ms.value_or(*number) != *number)
            raise<DataError>(
                "{}: read channels of {} and {} ms without times, expected a column of times; export again "
                "with Timelines: All, or channels of one sample time",
                source, shortest(*step_ms), shortest(*number));
        step_ms = number;
    }
    return step_ms ? std::optional<double>(1e-3 * *step_ms) : std::nullopt;
}

// "Name A Name B": a column of times for each channel. "Name A B": times that A and B share.
void read_channels(const std::vector<std::string>& names, const std::vector<std::string>& units,
                   double first_time, TextDialect& found) {
    found.clock_of.assign(names.size(), 0);
    found.names.assign(names.size(), "");
    found.units.assign(names.size(), "");
    for (std::size_t c = 1; c < names.size(); ++c) {
        const bool times = names[c] == name_key;
        found.clock_of[c] = times ? c : found.clock_of[c - 1];
        if (times) continue;
        found.names[c] = names[c];
        if (c < units.size()) found.units[c] = scope_unit(units[c]);
    }
    found.names[0] = first_time > ticks_since_1601 ? "time [100ns]" : "time [ms]";
}

}  // namespace

std::optional<TextDialect> scope_header(const TextLines& lines, const std::string& source) {
    const std::string_view first = lines.line(0);
    constexpr std::string_view separators = "\t;,: ";
    if (!first.starts_with(name_key) || first.size() <= name_key.size() + 1 ||
        separators.find(first[name_key.size()]) == std::string_view::npos)
        return std::nullopt;
    TextDialect found;
    found.rules.delimiter = first[name_key.size()];
    Head head(lines, found.rules.delimiter);
    if (!head.find_lines()) return std::nullopt;
    found.has_header = true;
    found.row_step_key = "SampleTime[ms]";
    found.header_end = lines.content[head.names_line].end;
    found.head_lines = lines.content[head.first_row].number - 1;
    std::vector<std::string> names = head.cells(head.names_line), units = head.under("Unit");
    const std::vector<std::string> row = head.cells(head.first_row);
    const bool twice = std::ranges::count(names, name_key) > 1;
    const bool says_more = head.first_row > head.names_line + 1;
    // A delimiter at the end of the rows alone, or of the head alone.
    if (names.size() + 1 == row.size() && row.back().empty()) names.emplace_back();
    if (names.size() == row.size() + 1 && names.back().empty()) names.pop_back();
    if (says_more && !twice && names.size() == row.size() + 1) {
        found.names.assign(names.begin() + 1, names.end());
        if (!units.empty()) units.erase(units.begin());
        for (std::string& unit : units) unit = scope_unit(unit);
        units.resize(found.names.size());
        found.units = units;
        found.row_step_s = common_step(head, source);
        read_scales(head, 1, found);
        return found;
    }
    const bool names_alone = !says_more && head.names_line == 0 && !twice;
    if (names.size() != row.size()) {
        if (names_alone) return std::nullopt;
        raise<DataError>(
            "{}:{}: read a row of {} cells under {} of a TwinCAT Scope export, expected as many; {}", source,
            lines.content[head.first_row].number, row.size(), names.size(),
            found.rules.delimiter == ','
                ? "a comma that separates cells cannot mark decimals too: export again with another separator"
                : "correct the head, or export again");
    }
    // "Name" alone over names may be a column of names; over times it runs forward.
    const auto first_time = scope_number(row.front());
    if (names_alone) {
        const std::vector<std::string> next =
            head.first_row + 1 < lines.content.size() ? head.cells(head.first_row + 1) : row;
        const auto second_time = scope_number(next.front());
        if (!second_time || !(*second_time > *first_time)) return std::nullopt;
    }
    read_channels(names, units, *first_time, found);
    read_scales(head, 0, found);
    return found;
}

}  // namespace ripplenotch
