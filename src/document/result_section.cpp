// SPDX-License-Identifier: MIT
#include "ripplenotch/document/result_section.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "document/json.hpp"
#include "document/json_words.hpp"
#include "ripplenotch/chart/diagnosis_figures.hpp"
#include "ripplenotch/chart/identification_figure.hpp"
#include "ripplenotch/chart/table_figure.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/figure_json.hpp"
#include "ripplenotch/document/identification_json.hpp"
#include "ripplenotch/document/table_json.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_rows = 200;

bool is_table(const Json& json) {
    return json.is_array() && !json.empty() &&
           std::all_of(json.begin(), json.end(), [](const Json& row) { return row.is_object(); });
}

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

// A row's objects become columns of their own: settle_ms {"0.5": 147} is column "settle 0.5, ms".
void cells_of(const Json& row, const std::string& prefix, const std::string& unit,
              std::vector<std::pair<std::string, std::string>>& cells) {
    for (const auto& [name, entry] : row.items()) {
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

PageTable table_of(const std::string& name, const Json& rows) {
    PageTable table{spoken(name).name, {}, {}};
    std::vector<std::vector<std::pair<std::string, std::string>>> all;
    for (const Json& row : rows) {
        if (all.size() == most_rows) break;
        cells_of(row, "", "", all.emplace_back());
        for (const auto& [column, value] : all.back()) {
            if (std::find(table.header.begin(), table.header.end(), column) == table.header.end())
                table.header.push_back(column);
        }
    }
    for (const auto& cells : all) {
        std::vector<std::string> row(table.header.size(), "-");
        for (const auto& [column, value] : cells) {
            const auto at =
                std::find(table.header.begin(), table.header.end(), column) - table.header.begin();
            row[static_cast<std::size_t>(at)] = value;
        }
        table.rows.push_back(std::move(row));
    }
    // Columns that no row fills say nothing.
    for (std::size_t c = table.header.size(); c-- > 0;) {
        if (!std::all_of(table.rows.begin(), table.rows.end(),
                         [c](const auto& row) { return says_nothing(row[c]); }))
            continue;
        table.header.erase(table.header.begin() + static_cast<std::ptrdiff_t>(c));
        for (auto& row : table.rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(c));
    }
    if (rows.size() > most_rows) table.title += fmt::format(" (the first {} of {})", most_rows, rows.size());
    return table;
}

// A round's gap as "0.435 to 0.0497" in one cell, and of its evidence what people ask for first: a page is
// not as wide as the JSON is deep.
Json rounds_for_people(const Json& rounds) {
    constexpr std::array kept = {"effect", "status", "reason", "parameters", "where"};
    Json shown = Json::array();
    for (const Json& round : rounds) {
        Json row;
        for (const char* name : kept) {
            if (round.contains(name)) row[name] = round[name];
        }
        const Json evidence = round.value("evidence", Json::object());
        if (evidence.contains("share_nm")) row["explains_nm"] = evidence["share_nm"];
        for (const auto& [as, before, after] :
             {std::tuple{"gap_nm", "gap_before_nm", "gap_after_nm"},
              {"validation_nm", "validation_before_nm", "validation_after_nm"}}) {
            if (!round.contains(before) || !round.contains(after)) continue;
            row[as] = fmt::format("{} to {}", field_text(round, before), field_text(round, after));
        }
        std::string rivals;
        for (const Json& rival : round.value("alternatives", Json::array()))
            rivals += (rivals.empty() ? "" : ", ") + rival.value("effect", "?");
        if (!rivals.empty()) row["rivals"] = rivals;
        shown.push_back(std::move(row));
    }
    return shown;
}

void add_field(PageSection& section, const std::string& name, const Json& whole) {
    const Json& json = whole.at(name);
    if (name == "rounds" && is_table(json)) {
        section.tables.push_back(table_of(name, rounds_for_people(json)));
    } else if (is_table(json)) {
        section.tables.push_back(table_of(name, json));
    } else if (json.is_object()) {
        for (const auto& [inner, entry] : json.items()) {
            const Spoken outer = spoken(name);
            if (is_table(entry)) {
                section.tables.push_back(table_of(name + " " + inner, entry));
            } else if (inner != "schema" && !entry.is_null() && !(entry.is_array() && entry.empty())) {
                const Spoken said = spoken(inner);
                const std::string unit = said.unit.empty() ? outer.unit : said.unit;
                section.facts.push_back(
                    {fmt::format("{} {}{}{}", outer.name, said.name, unit.empty() ? "" : ", ", unit),
                     field_text(json, inner)});
            }
        }
    } else if (!json.is_null() && !(json.is_array() && json.empty()) && json != "") {
        const Spoken said = spoken(name);
        section.facts.push_back(
            {said.unit.empty() ? said.name : said.name + ", " + said.unit, field_text(whole, name)});
    }
}

double number_or(const Json& json, const char* name, double otherwise) {
    const auto found = json.find(name);
    return found != json.end() && found->is_number() ? found->get<double>() : otherwise;
}

// "explained: coulomb-friction, tone; gap from 1.01 to 0.0493 Nm rms, noise floor 0.0494 Nm"
std::string diagnosis_in_words(const Json& json) {
    const Json gap = json.value("gap", Json::object()), named = json.value("named", Json::array());
    return fmt::format("{}: {}; gap from {:.3g} to {:.3g} Nm rms, noise floor {:.3g} Nm",
                       json.value("verdict", "?"), named.empty() ? "no effect is named" : value_text(named),
                       number_or(gap, "before_nm", 0.0), number_or(gap, "after_nm", 0.0),
                       number_or(gap, "noise_floor_nm", 0.0));
}

Figure gap_of(const Json& json, const std::string& source) {
    std::vector<GapRound> rounds;
    for (const Json& round : json.value("rounds", Json::array())) {
        if (!round.is_object()) continue;
        const std::string effect = round.value("effect", "?"), status = round.value("status", "");
        rounds.push_back(
            {status.empty() || status == "confirmed" ? effect : fmt::format("{} ({})", effect, status),
             number_or(round, "gap_before_nm", 0.0), number_or(round, "gap_after_nm", 0.0)});
    }
    const Json gap = json.value("gap", Json::object());
    return gap_figure(fmt::format("How the gap shrank: {}", source), "", rounds,
                      number_or(gap, "noise_floor_nm", 0.0));
}

std::string kind_of(const Json& json, const std::string& source) {
    const std::string schema = json.is_object() ? json.value("schema", "") : "";
    constexpr std::string_view before = "ripplenotch/", after = "/1";
    if (!schema.starts_with(before) || !schema.ends_with(after)) {
        raise<DataError>(
            "{}: read schema '{}', expected a result of ripplenotch such as joint.json or what --json prints",
            source, schema);
    }
    return schema.substr(before.size(), schema.size() - before.size() - after.size());
}

void add_figures(PageSection& section, const std::string& kind, const Json& json, const std::string& text,
                 const std::string& source) {
    if (kind == "joint") {
        Figure figure = identification_figure(source, identification_from_json(text, source));
        figure.sentence.clear();  // it is the verdict above
        section.figures.push_back(std::move(figure));
    } else if (kind == "table") {
        section.figures.push_back(table_figure(table_from_json(text, source)));
    } else if (kind == "diagnosis") {
        section.verdict = diagnosis_in_words(json);
        section.figures.push_back(gap_of(json, source));
    }
}

}  // namespace

PageSection section_of_result(const std::string& text, const std::string& source) {
    Json json;
    try {
        json = Json::parse(text);
    } catch (const Json::parse_error&) {
        raise<DataError>("{}: read {}, expected JSON as --json, -o joint.json or --plot FILE.json write it",
                         source, text.empty() ? "an empty file" : "what is not JSON");
    }
    const std::string kind = kind_of(json, source);
    PageSection section;
    section.title = fmt::format("{}: {}", kind, source);
    section.command = json.value("command", "");
    section.json = text;
    for (const Json& input : json.value("inputs", Json::array()))
        section.inputs.push_back({input.value("name", ""), input.value("sha256", "")});
    if (kind == "figure") {
        Figure figure = figure_from_json(text, source);
        section.title = figure.title;
        section.verdict = figure.sentence;
        figure.sentence.clear();
        section.figures.push_back(std::move(figure));
        section.json.clear();  // it is all in the figure
        return section;
    }
    if (const auto verdict = json.find("verdict"); verdict != json.end())
        section.verdict = value_text(*verdict);
    constexpr std::array told = {"schema", "tool", "version", "command", "inputs", "verdict"};
    for (const auto& [name, entry] : json.items()) {
        const bool already = std::find(told.begin(), told.end(), name) != told.end();
        if (!already) add_field(section, name, json);
    }
    add_figures(section, kind, json, text, source);
    return section;
}

}  // namespace ripplenotch
