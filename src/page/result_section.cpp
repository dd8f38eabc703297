// SPDX-License-Identifier: MIT
#include "ripplenotch/page/result_section.hpp"

#include <algorithm>
#include <array>

#include "document/fields/document_head.hpp"
#include "page/diagnosis_rounds.hpp"
#include "page/json_table.hpp"
#include "page/json_words.hpp"
#include "page/key_numbers.hpp"
#include "page/result_tables.hpp"
#include "page/trend_tables.hpp"
#include "ripplenotch/chart/diagnosis_figure.hpp"
#include "ripplenotch/chart/identification_figure.hpp"
#include "ripplenotch/chart/map_figure.hpp"
#include "ripplenotch/chart/table_figure.hpp"
#include "ripplenotch/chart/trend_figure.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/diagnosis_json.hpp"
#include "ripplenotch/document/figure_json.hpp"
#include "ripplenotch/document/identification_json.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/document/trend_json.hpp"

namespace ripplenotch {
namespace {

void add_field(PageSection& section, const std::string& name, const Json& whole) {
    const Json& json = whole.at(name);
    if (is_table(json)) {
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

// Empty where there is no text of this name.
std::string text_at(const Json& json, const char* name) {
    const auto found = json.find(name);
    return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

// What a person reads first of a kind; its other tables are ledgers.
bool is_ledger(const std::string& kind, const std::string& name) {
    struct Shown {
        std::string_view kind, name;
    };
    constexpr std::array shown = {Shown{"joint", "lines"},
                                  Shown{"table", "bands"},
                                  Shown{"metrics", "orders"},
                                  Shown{"metrics", "switches"},
                                  Shown{"comparison", "methods"},
                                  Shown{"diagnosis", "rounds"},
                                  Shown{"diagnosis", "faults"},
                                  Shown{"diagnosis", "ambiguous"},
                                  Shown{"diagnosis", "unexplained"},
                                  Shown{"diagnosis", "undecidable"},
                                  Shown{"trend", "odd"}};
    const bool chosen =
        std::any_of(shown.begin(), shown.end(), [&](const Shown& s) { return s.kind == kind; });
    return chosen && std::none_of(shown.begin(), shown.end(),
                                  [&](const Shown& s) { return s.kind == kind && s.name == name; });
}

// Each method's ledgers, under the label that the comparison gives it.
void add_method_ledgers(PageSection& section, const Json& methods, const PageTable& compared) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
        for (const char* name : {"ledger", "switch_ledger"}) {
            const auto found = methods[i].find(name);
            if (found == methods[i].end() || !is_table(*found)) continue;
            section.tables.push_back(table_of(name, *found));
            section.tables.back().title = fmt::format("{} of {}", spoken(name).name, compared.rows[i][0]);
            section.tables.back().folded = true;
        }
    }
}

// The tables that people read across have columns of their own choice; false for any other.
bool add_known_table(PageSection& section, const std::string& kind, const std::string& name,
                     const Json& rows) {
    if (!is_table(rows)) return false;
    if (kind == "comparison" && name == "methods") {
        section.tables.push_back(comparison_table(rows));
        add_method_ledgers(section, rows, PageTable(section.tables.back()));
    } else if (kind == "recommendation" && name == "methods") {
        section.tables.push_back(comparison_table(rows));
        section.tables.push_back(table_of(name, rows));
        section.tables.back().title = "Every value of the methods";
        section.tables.back().folded = true;
    } else if (kind == "joint" && name == "lines") {
        Json lines = rows;  // amplitudes at each speed are in the figure
        for (Json& line : lines) line.erase("amplitude_by_speed");
        section.tables.push_back(table_of(name, lines));
        section.tables.push_back(table_of(name, rows));
        section.tables.back().title = "Every value of the lines";
        section.tables.back().folded = true;
    } else if (kind == "table" && name == "bands") {
        section.tables.push_back(notch_table(rows));
        section.tables.push_back(table_of(name, rows));
        section.tables.back().title = "Every value of the bands";
        section.tables.back().folded = true;
    } else if (kind == "trend" && name == "alerts") {
        section.tables.push_back(alert_table(rows));
        section.tables.push_back(table_of(name, rows));
        section.tables.back().title = "Every value of the alerts";
        section.tables.back().folded = true;
    } else if (kind == "trend" && name == "courses") {
        section.tables.push_back(course_table(rows));
    } else if (kind == "metrics" && name == "switches") {
        if (auto drawn = switch_figure(rows)) section.figures.push_back(std::move(*drawn));
        section.tables.push_back(largest_switches(rows));
    } else {
        return false;
    }
    return true;
}

// Every field as a fact or a table, in the order of the document, but for what stands elsewhere in the
// section.
void add_fields(PageSection& section, const std::string& kind, const Json& json,
                const std::optional<Diagnosis>& diagnosis) {
    constexpr std::array told = {"schema", "tool", "version", "command", "inputs", "verdict"};
    for (const auto& [name, entry] : json.items()) {
        if (std::find(told.begin(), told.end(), name) != told.end()) continue;
        if (diagnosis && name == "rounds") {
            if (!diagnosis->rounds.empty()) section.tables.push_back(rounds_table(*diagnosis));
        } else if (!add_known_table(section, kind, name, entry)) {
            const std::size_t before = section.tables.size();
            add_field(section, name, json);
            for (std::size_t i = before; i < section.tables.size(); ++i)
                section.tables[i].folded = is_ledger(kind, name);
        }
    }
}

PageSection section_of_figure(Figure figure) {
    PageSection section;
    section.title = figure.title;
    section.verdict = std::exchange(figure.sentence, "");
    section.figures.push_back(std::move(figure));
    return section;  // its JSON is all in the figure
}

}  // namespace

PageSection section_of_result(const std::string& text, const std::string& source) {
    const auto [kind, json] = parse_any_document(text, source);
    PageSection section;
    if (kind == "figure") section = section_of_figure(figure_from_json(text, source));
    if (kind != "figure") section.title = fmt::format("{}: {}", kind, source);
    section.command = text_at(json, "command");
    for (const Json& input : json.value("inputs", Json::array()))
        section.inputs.push_back({text_at(input, "name"), text_at(input, "sha256")});
    if (kind == "figure") return section;
    section.json = text;
    if (const auto verdict = json.find("verdict"); verdict != json.end())
        section.verdict = value_text(*verdict);
    std::optional<Diagnosis> diagnosis;
    if (kind == "diagnosis") diagnosis = read_diagnosis(text, source);
    if (section.verdict.empty()) section.verdict = sentence_of(kind, json);
    section.asked = question_of(kind);
    section.key = key_numbers(kind, json);
    add_fields(section, kind, json, diagnosis);
    if (kind == "joint") {
        section.figures.push_back(identification_figure(source, identification_from_json(text, source)));
        section.figures.back().sentence.clear();  // it is the verdict above
    } else if (kind == "map") {
        if (const MapFit fit = map_from_json(text, source); !fit.map.orders.empty())
            section.figures.push_back(map_figure(source, fit));
    } else if (kind == "table") {
        section.figures.push_back(table_figure(table_from_json(text, source)));
    } else if (kind == "trend" && json.contains("months")) {
        section.figures.push_back(trend_figure(trend_from_json(text, source)));
    } else if (diagnosis) {
        section.verdict = diagnosis_sentence(*diagnosis);
        section.figures.push_back(gap_figure(fmt::format("How the gap shrank: {}", source), *diagnosis));
    }
    return section;
}

std::vector<PageSection> sections_of_result(const std::string& text, const std::string& source) {
    const auto [kind, whole] = parse_any_document(text, source);
    if (kind != "diagnoses") return {section_of_result(text, source)};
    const auto joints = whole.find("joints");
    if (joints == whole.end() || !joints->is_array())
        raise<DataError>(
            "{}: joints: expected a list of diagnoses, as 'diagnose --joint all --json' prints it", source);
    std::vector<PageSection> sections;
    for (const Json& joint : *joints) {
        // Each is what diagnose prints of one joint, under a head of its own.
        Json one{{"schema", "ripplenotch/diagnosis/1"}};
        for (const char* name : {"tool", "version", "command", "inputs"})
            if (whole.contains(name)) one[name] = whole[name];
        if (joint.is_object())
            for (const auto& [name, entry] : joint.items())
                if (name != "joint") one[name] = entry;
        const std::string name = joint.is_object() ? text_at(joint, "joint") : "";
        sections.push_back(section_of_result(one.dump(), fmt::format("{}, joint {}", source, name)));
    }
    return sections;
}

}  // namespace ripplenotch
