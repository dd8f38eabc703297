// SPDX-License-Identifier: MIT
#include "page/result_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_cell = 80;
constexpr int most_decimals = 12;

// Endings of names that are units, the longer first where one ends in the other.
constexpr std::array<std::pair<std::string_view, std::string_view>, 13> units = {{{"_nm2_hz", "Nm²/Hz"},
                                                                                  {"_kgm2", "kgm²"},
                                                                                  {"_deg_s", "deg/s"},
                                                                                  {"_nm_s", "Nm/s"},
                                                                                  {"_percent", "%"},
                                                                                  {"_bytes", "bytes"},
                                                                                  {"_deg", "deg"},
                                                                                  {"_hz", "Hz"},
                                                                                  {"_nm", "Nm"},
                                                                                  {"_db", "dB"},
                                                                                  {"_ms", "ms"},
                                                                                  {"_s", "s"},
                                                                                  {"_rad", "rad"}}};

std::optional<double> number_at(const Json& owner, const std::string& name) {
    const auto found = owner.find(name);
    if (found == owner.end() || !found->is_number()) return std::nullopt;
    return found->get<double>();
}

// Decimals at which an error has two digits; empty for none or a meaningless one.
std::optional<int> decimals_of(double error) {
    if (!std::isfinite(error) || !(error > 0.0)) return std::nullopt;
    return std::clamp(1 - static_cast<int>(std::floor(portable::log10(error))), 0, most_decimals);
}

// [from, to]
bool is_span(const Json& json) {
    return json.is_array() && json.size() == 2 && json[0].is_number() && json[1].is_number();
}

std::optional<int> decimals_of_span(const Json& ci95) {
    if (!is_span(ci95)) return std::nullopt;
    return decimals_of(0.5 * (ci95[1].get<double>() - ci95[0].get<double>()));
}

// The decimals of a field, from the error in the same object.
std::optional<int> decimals_beside(const Json& owner, const std::string& name) {
    const bool of_value = name == "value" || name == "stderr" || name == "ci95";
    if (of_value && owner.contains("ci95")) return decimals_of_span(owner["ci95"]);
    constexpr std::string_view ending = "_stderr";
    const std::string error = of_value                 ? "stderr"
                              : name.ends_with(ending) ? name
                                                       : name + std::string(ending);
    const auto found = number_at(owner, error);
    return found ? decimals_of(*found) : std::nullopt;
}

// Both ends with the digits that the larger one needs: "-112.5 to 0" instead of "-112.501 to -0.000176435".
std::string span_text(const Json& span) {
    const double from = span[0].get<double>(), to = span[1].get<double>();
    const double larger = std::max(std::abs(from), std::abs(to));
    if (!(larger > 0.0) || !std::isfinite(larger)) return fmt::format("{:g} to {:g}", from, to);
    const double unit = portable::pow(10.0, std::floor(portable::log10(larger)) - 3.0);
    const auto shown = [unit](double value) {
        return fmt::format("{:.6g}", unit * std::round(value / unit) + 0.0);
    };
    return fmt::format("{} to {}", shown(from), shown(to));
}

// "0.5 to 2.25; 4 to 5": stretches of time, of speed.
std::string spans_text(const Json& spans) {
    constexpr std::size_t most = 4;
    std::string joined;
    for (std::size_t i = 0; i < std::min(spans.size(), most); ++i)
        joined += (i > 0 ? "; " : "") + span_text(spans[i]);
    return spans.size() > most ? fmt::format("{}; and {} more", joined, spans.size() - most) : joined;
}

}  // namespace

Spoken spoken(std::string name) {
    if (name == "hz") return {"frequency", "Hz"};
    if (name == "db") return {"level", "dB"};
    std::string unit;
    for (const auto& [ending, means] : units) {
        if (name.size() > ending.size() && name.ends_with(ending)) {
            name.resize(name.size() - ending.size());
            unit = means;
            break;
        }
    }
    std::replace(name.begin(), name.end(), '_', ' ');
    return {name, unit};
}

std::string value_text(const Json& json) {
    if (json.is_null()) return "-";
    if (json.is_string()) return json.get<std::string>();
    if (json.is_number_float()) {
        // Four significant digits where no error says how many; whole numbers as they are.
        const double value = json.get<double>() + 0.0;
        const bool whole = value == std::floor(value) || !(std::abs(value) < 1e4);
        return whole ? fmt::format("{:.6g}", value) : fmt::format("{:.4g}", value);
    }
    if (json.is_array() && !json.empty() && std::all_of(json.begin(), json.end(), is_span))
        return spans_text(json);
    if (json.is_array()) {
        const std::string all = joined(json, ", ", value_text);
        return all.size() > most_cell ? fmt::format("{} values", json.size()) : all;
    }
    if (json.is_object()) {
        std::string joined;
        for (const auto& [name, entry] : json.items())
            joined +=
                fmt::format("{}{} {}", joined.empty() ? "" : "; ", spoken(name).name, value_text(entry));
        return joined;
    }
    return json.is_boolean() ? (json.get<bool>() ? "yes" : "no") : json.dump();
}

std::string coarse_text(double value) {
    constexpr double dust = 1e-9;  // in Nm, dB, %, ms: rounding errors of zero
    if (std::abs(value) < dust) return "0";
    return std::abs(value) < 999.5 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

std::string field_text(const Json& owner, const std::string& name) {
    const Json& json = owner.at(name);
    const auto decimals = decimals_beside(owner, name);
    if (decimals && is_span(json))
        return fmt::format("{} to {}", rounded(json[0].get<double>(), *decimals),
                           rounded(json[1].get<double>(), *decimals));
    if (!json.is_number_float()) return value_text(json);
    if (decimals) return rounded(json.get<double>(), *decimals);
    constexpr std::array coarse = {"Nm", "dB", "%", "ms"};
    const bool of_coarse = std::find(coarse.begin(), coarse.end(), spoken(name).unit) != coarse.end();
    if (of_coarse || name.starts_with("residual")) return coarse_text(json.get<double>());
    return value_text(json);
}

std::string parameters_text(const Json& parameters) {
    std::string joined;
    for (const auto& [name, entry] : parameters.items()) {
        const Spoken said = spoken(name);
        const bool fitted = entry.is_object() && entry.contains("value");
        const std::string value = fitted ? field_text(entry, "value") : field_text(parameters, name);
        const std::string interval = fitted && entry.contains("ci95") && is_span(entry["ci95"])
                                         ? fmt::format(" ({})", field_text(entry, "ci95"))
                                         : "";
        joined += fmt::format("{}{} {}{}{}", joined.empty() ? "" : "; ", said.name, value, interval,
                              said.unit.empty() ? "" : " " + said.unit);
    }
    return joined;
}

std::string where_text(const Json& where) {
    std::string joined;
    for (const auto& [name, entry] : where.items()) {
        if (entry.is_null() || entry.empty()) continue;
        const Spoken said = spoken(name);
        joined += fmt::format("{}{} {}{}", joined.empty() ? "" : "; ", said.name, value_text(entry),
                              said.unit.empty() ? "" : " " + said.unit);
    }
    return joined;
}

namespace {

constexpr std::size_t most_rows = 200, most_columns = 100;

// Short enough to be columns of a table.
bool is_short_list(const Json& json) {
    return is_table(json) && json.size() <= 3 && std::all_of(json.begin(), json.end(), [](const Json& row) {
               return row.size() <= 4 &&
                      std::none_of(row.begin(), row.end(), [](const Json& v) { return v.is_structured(); });
           });
}

// Nothing, or more than a cell holds: the JSON has it.
bool says_nothing(const std::string& cell) {
    return cell.empty() || cell == "-" || cell.ends_with(" values");
}

// A row's objects become columns of their own: settle_ms {"0.5": 147} is column "settle 0.5, ms". One more
// cell than there may be columns indicates that some are left out.
void cells_of(const Json& row, const std::string& prefix, const std::string& unit, NamedCells& cells) {
    for (const auto& [name, entry] : row.items()) {
        if (cells.size() > most_columns) return;
        const Spoken said = spoken(name);
        const std::string full = prefix + said.name;
        const std::string in = said.unit.empty() ? unit : said.unit;
        if (name == "parameters" && entry.is_object()) {
            cells.emplace_back("parameters (95 % interval)", parameters_text(entry));
        } else if (name == "where" && entry.is_object()) {
            cells.emplace_back("where", where_text(entry));
        } else if (entry.is_object() && entry.size() <= 6) {
            cells_of(entry, full + " ", in, cells);
        } else if (is_short_list(entry)) {
            for (std::size_t i = 0; i < entry.size(); ++i)
                cells_of(entry[i], fmt::format("{} {} ", full, i + 1), "", cells);
        } else {
            cells.emplace_back(in.empty() ? full : full + ", " + in, field_text(row, name));
        }
    }
}

}  // namespace

bool is_table(const Json& json) {
    return json.is_array() && !json.empty() &&
           std::all_of(json.begin(), json.end(), [](const Json& row) { return row.is_object(); });
}

PageTable table_of(const std::string& name, const Json& rows) {
    std::vector<NamedCells> all;
    for (std::size_t i = 0; i < std::min(rows.size(), most_rows); ++i)
        cells_of(rows[i], "", "", all.emplace_back());
    PageTable table = table_of_cells(spoken(name).name, all, 0);
    if (rows.size() > most_rows) table.title += fmt::format(" (the first {} of {})", most_rows, rows.size());
    return table;
}

PageTable table_of_cells(const std::string& title, std::span<const NamedCells> rows, std::size_t always) {
    PageTable table{title, {}, {}};
    std::unordered_map<std::string, std::size_t> places;  // indices of the columns in the header
    bool left_out = false;
    for (const NamedCells& cells : rows) {
        for (const auto& [column, value] : cells) {
            if (places.size() < most_columns && places.emplace(column, places.size()).second)
                table.header.push_back(column);
            left_out |= places.size() == most_columns && !places.contains(column);
        }
    }
    for (const NamedCells& cells : rows) {
        std::vector<std::string>& row = table.rows.emplace_back(table.header.size(), "-");
        for (const auto& [column, value] : cells)
            if (const auto at = places.find(column); at != places.end()) row[at->second] = value;
    }
    for (std::size_t c = table.header.size(); c-- > always;) {
        if (!std::all_of(table.rows.begin(), table.rows.end(),
                         [c](const auto& row) { return says_nothing(row[c]); }))
            continue;
        table.header.erase(table.header.begin() + static_cast<std::ptrdiff_t>(c));
        for (auto& row : table.rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(c));
    }
    if (left_out) table.title += fmt::format(" (the first {} columns)", most_columns);
    return table;
}

}  // namespace ripplenotch
