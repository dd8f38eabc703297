// SPDX-License-Identifier: MIT
#include "page/result_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_switches = 10, fewest_for_figure = 20, bars = 20;

using Keys = std::vector<std::pair<std::string, std::string>>;

// "tracking,q=1,orders=1:2" as a name and its keys.
std::pair<std::string, Keys> parted(const std::string& spec) {
    std::pair<std::string, Keys> parts;
    std::size_t from = 0;
    while (from <= spec.size()) {
        const std::size_t end = std::min(spec.find(',', from), spec.size());
        const std::string piece = spec.substr(from, end - from);
        const std::size_t equals = piece.find('=');
        if (from == 0)
            parts.first = piece;
        else
            parts.second.emplace_back(piece.substr(0, equals),
                                      equals == std::string::npos ? "" : piece.substr(equals + 1));
        from = end + 1;
    }
    return parts;
}

// The methods without what all that have a key share: the gear ratio, the orders. Two that would be one name
// keep theirs.
std::vector<std::string> short_names(const std::vector<std::string>& specs) {
    std::vector<std::pair<std::string, Keys>> all;
    std::map<std::string, std::set<std::string>> values;
    for (const std::string& spec : specs) {
        all.push_back(parted(spec));
        for (const auto& [key, value] : all.back().second) values[key].insert(value);
    }
    std::vector<std::string> names;
    for (const auto& [name, keys] : all) {
        names.push_back(name);
        for (const auto& [key, value] : keys)
            if ((key != "gear-ratio" && key != "orders") || values[key].size() > 1)
                names.back() += fmt::format(", {} {}", key, value);
    }
    return std::set<std::string>(names.begin(), names.end()).size() == names.size() ? names : specs;
}

// Empty where there is no number.
std::optional<double> number_under(const Json& json, const char* pointer) {
    const Json::json_pointer at(pointer);
    if (!json.contains(at) || !json.at(at).is_number()) return std::nullopt;
    return json.at(at).get<double>();
}

const Json& list_at(const Json& json, const char* name) {
    static const Json none = Json::array();
    const auto found = json.find(name);
    return found != json.end() && found->is_array() ? *found : none;
}

// A number, or a dash; attenuation without bound is null in a document.
std::string cell(const Json& row, const char* name) {
    const auto value = number_under(row, fmt::format("/{}", name).c_str());
    return value ? coarse_text(*value) : "-";
}

NamedCells method_cells(const std::string& name, const Json& method) {
    NamedCells cells{{"method", name}};
    if (const auto meets = method.find("meets"); meets != method.end() && meets->is_boolean())
        cells.emplace_back("fits", meets->get<bool>() ? "yes" : "no");
    cells.emplace_back("maximum delay, ms", cell(method, "longest_delay_ms"));
    cells.emplace_back("settles to 0.5 %, ms", cell(method, "settle_ms/0.5"));
    cells.emplace_back("overshoot, %", cell(method, "overshoot_percent"));
    cells.emplace_back("undershoot, %", cell(method, "undershoot_percent"));
    cells.emplace_back("ramp delay, ms", cell(method, "ramp_delay_ms"));
    cells.emplace_back("delay at 0 Hz, ms", cell(method, "dc_delay_ms"));
    cells.emplace_back("lag at the crossover, deg", cell(method, "phase_lag_deg"));
    for (const Json& line : list_at(method, "attenuation_db"))
        cells.emplace_back(fmt::format("attenuation of order {}, dB", cell(line, "order")), cell(line, "db"));
    cells.emplace_back("remaining ripple, Nm rms", cell(method, "ripple_rms_nm"));
    cells.emplace_back("residual, Nm rms", cell(method, "residual_rms_nm"));
    cells.emplace_back("switches", cell(method, "switches"));
    cells.emplace_back("largest jump, Nm", cell(method, "largest_jump_nm"));
    cells.emplace_back("start, of raw", cell(method, "start_ratio"));
    cells.emplace_back("error, Nm rms", cell(method, "error_nm"));
    cells.emplace_back("true error, Nm rms", cell(method, "error_rms_nm"));
    return cells;
}

double jump_of(const Json& one) { return std::abs(number_under(one, "/jump_nm").value_or(0.0)); }

}  // namespace

PageTable comparison_table(const Json& methods) {
    std::vector<std::string> names;
    for (const Json& method : methods) names.push_back(value_text(method.value("method", Json())));
    names = short_names(names);
    std::vector<NamedCells> rows;
    std::vector<PageFact> legend;
    for (const Json& method : methods) {
        const std::string& name = names[rows.size()];
        if (std::string why = joined(list_at(method, "shortfalls"), "; ", value_text); !why.empty())
            legend.push_back({name, std::move(why)});
        rows.push_back(method_cells(name, method));
    }
    PageTable table = table_of_cells("The methods", rows, 1);
    table.legend = std::move(legend);
    return table;
}

// The least attenuated order of a table's band; older tables state them, too.
std::optional<double> least_attenuation_db(const Json& band) {
    std::optional<double> least;
    for (const Json& one : list_at(band, "worst_attenuation_db"))
        if (one.is_number()) least = std::min(least.value_or(one.get<double>()), one.get<double>());
    return least;
}

PageTable notch_table(const Json& bands) {
    Json rows = Json::array();
    for (const Json& band : bands) {
        Json row{{"band", band.value("number", Json())}};
        row["speed, deg/s"] =
            fmt::format("{} to {}", cell(band, "speed_from_deg_s"), cell(band, "speed_to_deg_s"));
        for (const Json& notch : list_at(band, "notches")) {
            const std::string order = cell(notch, "order");
            row[fmt::format("order {}: centre, Hz", order)] = cell(notch, "center_hz");
            row[fmt::format("order {}: Q", order)] = cell(notch, "q");
        }
        row["delay at 0 Hz, ms"] = cell(band, "dc_delay_ms");
        row["settles, ms"] = cell(band, "settle_ms");
        if (const auto least = least_attenuation_db(band)) row["least attenuation, dB"] = coarse_text(*least);
        rows.push_back(std::move(row));
    }
    return table_of("notches", rows);
}

std::optional<Figure> switch_figure(const Json& switches) {
    if (!is_table(switches) || switches.size() < fewest_for_figure) return std::nullopt;
    double largest = 0.0;
    for (const Json& one : switches) largest = std::max(largest, jump_of(one));
    if (!(largest > 0.0)) return std::nullopt;
    std::vector<double> counts(bars, 0.0);
    for (const Json& one : switches) {
        const auto bar = static_cast<std::size_t>(jump_of(one) / largest * static_cast<double>(bars));
        counts[std::min(bar, bars - 1)] += 1.0;
    }
    Curve course{"", Ink::blue, CurveStyle::steps, {0.0}, {0.0}};
    for (std::size_t i = 0; i < bars; ++i) {
        course.x.push_back(largest * static_cast<double>(i) / static_cast<double>(bars));
        course.y.push_back(counts[i]);
    }
    course.x.push_back(largest);
    course.y.push_back(0.0);
    Panel panel{.title = "",
                .x = {"size of the jump", "Nm"},
                .y = {"switches", "", PlotScale::whole},
                .legend = false,
                .height = 0.7};
    panel.y.from = 0.0;
    panel.curves.push_back(std::move(course));
    return Figure{
        "switches", fmt::format("Jumps of the output at {} switches", switches.size()), "", {panel}};
}

PageTable largest_switches(const Json& switches) {
    std::vector<const Json*> sorted;
    for (const Json& one : switches) sorted.push_back(&one);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Json* a, const Json* b) { return jump_of(*a) > jump_of(*b); });
    sorted.resize(std::min(sorted.size(), most_switches));
    Json rows = Json::array();
    for (const Json* one : sorted) rows.push_back(*one);
    PageTable table = table_of("switches", rows);
    table.title = switches.size() > most_switches
                      ? fmt::format("The {} largest of {} switches", most_switches, switches.size())
                      : "Switches";
    return table;
}

namespace {

constexpr std::size_t most_numbers = 3;

// Smallest and largest of a field over the rows.
std::optional<std::pair<double, double>> extremes(const Json& rows, const char* pointer) {
    std::optional<std::pair<double, double>> found;
    for (const Json& row : rows) {
        const auto value = number_under(row, pointer);
        if (!value) continue;
        if (!found) found = {*value, *value};
        found->first = std::min(found->first, *value);
        found->second = std::max(found->second, *value);
    }
    return found;
}

std::string from_to(const std::pair<double, double>& ends) {
    return fmt::format("{:.4g} to {:.4g}", ends.first, ends.second);
}

// Empty where there is no text of this name.
std::string text_at(const Json& json, const char* name) {
    const auto found = json.find(name);
    return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

// The rounds of a diagnosis as a table that fits a page, which is not as wide as the JSON is deep: a round's
// gap as "0.435 to 0.0497" in one cell, and the most important items of its evidence.
PageTable rounds_table(const Json& rounds) {
    Json rows = Json::array();
    for (const Json& round : rounds) {
        Json& row = rows.emplace_back(Json::object());
        for (const char* name : {"effect", "status", "reason", "parameters"})
            if (round.contains(name)) row[name] = round[name];
        if (const auto share = number_under(round, "/evidence/noise_share"))
            row["times_the_noise"] = to_digits(*share, 4);
        for (const char* name : {"gap", "validation"}) {
            const auto before = number_under(round, fmt::format("/{}_before_nm", name).c_str()),
                       after = number_under(round, fmt::format("/{}_after_nm", name).c_str());
            if (before && after)
                row[fmt::format("{}_nm", name)] =
                    fmt::format("{} to {}", coarse_text(*before), coarse_text(*after));
        }
        const std::string rivals = joined(list_at(round, "alternatives"), ", ", [](const Json& rival) {
            return rival.is_object() ? text_at(rival, "effect") : "";
        });
        if (!rivals.empty()) row["rivals"] = rivals;
    }
    return table_of("rounds", rows);
}

// Empty for a word that names none of them.
template <class Enum>
std::optional<Enum> named(std::string_view word, std::string_view (*name_of)(Enum), Enum last) {
    for (int i = 0; i <= static_cast<int>(last); ++i)
        if (name_of(static_cast<Enum>(i)) == word) return static_cast<Enum>(i);
    return std::nullopt;
}

// A diagnosis as far as its sentence and the figure of its gap go.
Diagnosis gap_of(const Json& json, const std::string& source) {
    Diagnosis found;
    const auto verdict = named(text_at(json, "verdict"), verdict_name, DiagnosisVerdict::undecided);
    if (!verdict) raise<DataError>("{}: verdict is none of a diagnosis", source);
    found.verdict = *verdict;
    for (const Json& name : list_at(json, "named")) found.named.push_back(value_text(name));
    const auto nm = [](const Json& owner, const char* pointer) {
        return number_under(owner, pointer).value_or(not_a_number);
    };
    found.gap.before_nm = nm(json, "/gap/before_nm");
    found.gap.after_nm = nm(json, "/gap/after_nm");
    found.gap.noise_floor_nm = nm(json, "/gap/noise_floor_nm");
    for (const Json& round : list_at(json, "rounds")) {
        if (!round.is_object()) continue;
        const auto effects = catalogue();
        const auto effect = std::find_if(effects.begin(), effects.end(), [&](const Effect* one) {
            return one->name == text_at(round, "effect");
        });
        const auto status = named(text_at(round, "status"), status_name, FindingStatus::refused);
        if (effect == effects.end() || !status) continue;
        Finding& finding = found.rounds.emplace_back();
        finding.term.effect = *effect;
        finding.status = *status;
        finding.gap_before_nm = nm(round, "/gap_before_nm");
        finding.gap_after_nm = nm(round, "/gap_after_nm");
    }
    return found;
}

// A trend as far as its figure goes: the alerts, and the courses of the first.
Trend courses_of(const Json& json) {
    Trend trend;
    trend.joint_months = number_under(json, "/joint_months").value_or(0.0);
    std::map<std::pair<std::string, std::string>, std::size_t> places;
    const auto each = [&](const char* table, const auto& take) {
        for (const Json& row : list_at(json, table)) {
            if (!row.is_object()) continue;
            const std::pair name{text_at(row, "robot"), text_at(row, "joint")};
            const auto [place, is_new] = places.try_emplace(name, trend.joints.size());
            if (is_new) {
                JointTrend& joint = trend.joints.emplace_back();
                joint.robot = name.first;
                joint.joint = name.second;
            }
            take(row, trend.joints[place->second]);
        }
    };
    each("joints", [](const Json& row, JointTrend& joint) { joint.from = text_at(row, "from"); });
    each("alerts", [](const Json& row, JointTrend& joint) {
        JointChange& change = joint.changes.emplace_back();
        change.drift = text_at(row, "kind") == "drift";
        change.date = text_at(row, "date");
        change.descriptors.push_back({text_at(row, "descriptor"), 0.0, {}, {}});
    });
    each("courses", [](const Json& row, JointTrend& joint) {
        const auto value = number_under(row, "/value");
        for (JointChange& change : joint.changes)
            if (value && change.date == text_at(row, "alert") &&
                change.descriptors.front().name == text_at(row, "descriptor"))
                return change.course.push_back({text_at(row, "date"), *value, {}});
    });
    return trend;
}

class Numbers {
  public:
    explicit Numbers(const Json& json) : json_(json) {}

    void add(const char* name, const char* pointer, const char* unit) {
        if (const auto value = number_under(json_, pointer)) add_text(name, coarse_text(*value), unit);
    }
    void add_text(const std::string& name, const std::string& value, const char* unit) {
        if (facts_.size() < most_numbers)
            facts_.push_back({name, *unit == 0 ? value : fmt::format("{} {}", value, unit)});
    }
    [[nodiscard]] std::vector<PageFact> taken() { return std::move(facts_); }

  private:
    const Json& json_;
    std::vector<PageFact> facts_;
};

void of_joint(const Json& json, Numbers& numbers) {
    const auto ratio = json.find("gear_ratio");
    if (ratio != json.end() && number_under(*ratio, "/value"))
        numbers.add_text("gear ratio", field_text(*ratio, "value"), "");
    for (const Json& line : list_at(json, "lines")) {
        const auto order = number_under(line, "/order");
        const auto amplitude = number_under(line, "/amplitude_nm");
        if (order && amplitude)
            numbers.add_text(fmt::format("order {:.4g}, zero to peak", *order), coarse_text(*amplitude),
                             "Nm");
    }
}

void of_table(const Json& json, Numbers& numbers) {
    const Json& bands = list_at(json, "bands");
    if (!bands.empty()) numbers.add_text("bands", std::to_string(bands.size()), "");
    if (const auto delay = extremes(bands, "/dc_delay_ms"))
        numbers.add_text("delay at 0 Hz", from_to(*delay), "ms");
    std::optional<double> least;
    for (const Json& band : bands)
        if (const auto one = least_attenuation_db(band)) least = std::min(least.value_or(*one), *one);
    if (least) numbers.add_text("least attenuation", coarse_text(*least), "dB");
}

void of_metrics(const Json& json, Numbers& numbers) {
    numbers.add("ripple before, peak to peak", "/ripple_peak_to_peak_nm/raw", "Nm");
    numbers.add("ripple after, peak to peak", "/ripple_peak_to_peak_nm/filtered", "Nm");
    if (const auto delay = extremes(list_at(json, "delays"), "/dc_delay_ms"))
        numbers.add_text("delay at 0 Hz", from_to(*delay), "ms");
}

// The figures of the best method; without one, or where it is the control, of the first other.
void of_comparison(const Json& json, Numbers& numbers) {
    const Json::json_pointer best("/best/method");
    const Json wanted = json.contains(best) ? json[best] : Json("none");
    for (const Json& method : list_at(json, "methods")) {
        const Json name_of = method.is_object() ? method.value("method", Json("none")) : Json("none");
        if (name_of == "none" || (wanted != "none" && name_of != wanted)) continue;
        Numbers own(method);
        const std::string name = parted(value_text(method.value("method", Json("")))).first;
        own.add((name + ": settling time (0.5 %)").c_str(), "/settle_ms/0.5", "ms");
        own.add((name + ": delay of a ramp").c_str(), "/ramp_delay_ms", "ms");
        own.add((name + ": remaining ripple (rms)").c_str(), "/ripple_rms_nm", "Nm");
        for (const PageFact& fact : own.taken()) numbers.add_text(fact.name, fact.value, "");
        return;
    }
}

void of_diagnosis(const Json&, Numbers& numbers) {
    numbers.add("gap before, rms", "/gap/before_nm", "Nm");
    numbers.add("gap after, rms", "/gap/after_nm", "Nm");
    numbers.add("noise floor, rms", "/gap/noise_floor_nm", "Nm");
}

// The cross-validated ripple of each order of the map, before and after.
void of_map(const Json& json, Numbers& numbers) {
    for (const Json& line : list_at(json, "left_out")) {
        const auto order = number_under(line, "/order"), left = number_under(line, "/left_nm"),
                   was = number_under(line, "/ripple_nm");
        if (order && left && was)
            numbers.add_text(fmt::format("order {:.4g} before and after", *order),
                             fmt::format("{:.3g} to {:.3g}", *was, *left), "Nm");
    }
}

// The figures of the recommended method.
void of_recommendation(const Json& json, Numbers& numbers) {
    const auto take = json.find("take");
    for (const Json& method : list_at(json, "methods")) {
        if (take == json.end() || !method.is_object() || method.value("method", Json()) != *take) continue;
        if (const auto off = extremes(list_at(method, "attenuation_db"), "/db"))
            numbers.add_text("least attenuation", fmt::format("{:.1f}", off->first), "dB");
        if (const auto late = number_under(method, "/longest_delay_ms"))
            numbers.add_text("maximum delay", fmt::format("{:.1f}", *late), "ms");
        if (const auto left = number_under(method, "/ripple_rms_nm"))
            numbers.add_text("remaining ripple (rms)", coarse_text(*left), "Nm");
        return;
    }
}

void of_trend(const Json& json, Numbers& numbers) {
    numbers.add_text("alerts", std::to_string(list_at(json, "alerts").size()), "");
    numbers.add_text("joints", std::to_string(list_at(json, "joints").size()), "");
    numbers.add("alerts by chance alone, at most", "/expected_false_alarms", "");
}

// The first numbers of a kind without a section of its own.
void of_any(const Json& json, Numbers& numbers) {
    for (const auto& [name, entry] : json.items()) {
        const Spoken said = spoken(name);
        if (entry.is_number()) numbers.add_text(said.name, field_text(json, name), said.unit.c_str());
    }
}

struct Kind {
    const char *name, *heading;
    void (*numbers)(const Json&, Numbers&);
};
constexpr std::array<Kind, 13> kinds = {{{"info", "The log", of_any},
                                         {"joint", "Ripple lines and gear ratio", of_joint},
                                         {"spectrum", "Spectrum of the torque", of_any},
                                         {"track", "Orders over time", of_any},
                                         {"map", "Ripple map", of_map},
                                         {"recommendation", "Recommended method", of_recommendation},
                                         {"trend", "Changes of joints", of_trend},
                                         {"table", "Notch filters by speed", of_table},
                                         {"metrics", "Effect of the filter", of_metrics},
                                         {"comparison", "Comparison of methods", of_comparison},
                                         {"diagnosis", "Missing effects", of_diagnosis},
                                         {"simulation", "Simulation", of_any},
                                         {"export", "Export, and its rounding errors", of_any}}};

const Kind* kind_named(const std::string& name) {
    const auto* found =
        std::find_if(kinds.begin(), kinds.end(), [&](const Kind& kind) { return name == kind.name; });
    return found == kinds.end() ? nullptr : found;
}

}  // namespace

std::string heading_of(const std::string& kind) {
    const Kind* known = kind_named(kind);
    return known != nullptr ? known->heading : kind;
}

PageState state_of(const Json& result) {
    // An order that a filter amplifies is worse than any doubt: in whole decibels, as they are printed.
    constexpr double printed_db = -0.5;
    const auto amplifies = [](const Json& method) {
        const auto all = extremes(list_at(method, "attenuation_db"), "/db");
        return all && all->first < printed_db;
    };
    const auto take = result.find("take");
    for (const Json& method : list_at(result, "methods"))
        if (take != result.end() && method.is_object() && method.value("method", Json()) == *take &&
            amplifies(method))
            return PageState::bad;
    for (const Json& order : list_at(result, "orders"))
        if (const auto db = number_under(order, "/attenuation_db"); db && *db < printed_db)
            return PageState::bad;
    // Of a diagnosis: explained or matches; the others leave something open.
    if (const Json verdict = result.value("verdict", Json());
        result.contains("rounds") && verdict.is_string())
        return verdict == "explained" || verdict == "matches" ? PageState::good : PageState::doubtful;
    const auto conclusive = result.find("conclusive");
    if (conclusive == result.end() || !conclusive->is_boolean()) return PageState::none;
    return conclusive->get<bool>() ? PageState::good : PageState::doubtful;
}

std::string sentence_of(const std::string& kind, const Json& result) {
    if (kind == "table") {
        const Json& bands = list_at(result, "bands");
        const auto delay = extremes(bands, "/dc_delay_ms"), from = extremes(bands, "/speed_from_deg_s"),
                   to = extremes(bands, "/speed_to_deg_s");
        if (!delay || !from || !to) return "";
        return fmt::format("{} band{} of notches from {:.4g} to {:.4g} deg/s; the torque lags by {} ms.",
                           bands.size(), bands.size() == 1 ? "" : "s", from->first, to->second,
                           delay->first == delay->second ? coarse_text(delay->first) : from_to(*delay));
    }
    if (kind == "metrics") {
        const auto before = number_under(result, "/ripple_peak_to_peak_nm/raw"),
                   after = number_under(result, "/ripple_peak_to_peak_nm/filtered");
        if (!before || !after) return "";
        return fmt::format("The ripple is at most {:.3g} Nm peak to peak before the filter, {:.3g} Nm after.",
                           *before, *after);
    }
    return "";
}

std::vector<PageFact> key_numbers(const std::string& kind, const Json& result) {
    Numbers numbers(result);
    const Kind* known = kind_named(kind);
    (known != nullptr ? known->numbers : of_any)(result, numbers);
    return numbers.taken();
}

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

// The main tables of a kind are shown first; its other tables are ledgers.
bool is_ledger(const std::string& kind, const std::string& name) {
    struct Shown {
        std::string_view kind, name;
    };
    constexpr std::array shown = {
        Shown{"joint", "lines"},           Shown{"table", "bands"},         Shown{"metrics", "orders"},
        Shown{"metrics", "switches"},      Shown{"comparison", "methods"},  Shown{"diagnosis", "rounds"},
        Shown{"diagnosis", "faults"},      Shown{"diagnosis", "ambiguous"}, Shown{"diagnosis", "remaining"},
        Shown{"diagnosis", "undecidable"}, Shown{"trend", "alerts"}};
    const bool chosen =
        std::any_of(shown.begin(), shown.end(), [&](const Shown& s) { return s.kind == kind; });
    return chosen && std::none_of(shown.begin(), shown.end(),
                                  [&](const Shown& s) { return s.kind == kind && s.name == name; });
}

// Each method's ledgers, under the label that the comparison gives it.
void add_method_ledgers(PageSection& section, const Json& methods, const PageTable& compared) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
        for (const char* name : {"ledger", "switch_ledger"}) {
            const Json& ledger = list_at(methods[i], name);
            if (!is_table(ledger)) continue;
            section.tables.push_back(table_of(name, ledger));
            section.tables.back().title = fmt::format("{} of {}", spoken(name).name, compared.rows[i][0]);
            section.tables.back().folded = true;
        }
    }
}

// The best methods, the first of them; the others on demand.
void add_best(PageSection& section, PageTable methods) {
    constexpr std::size_t best = 5;
    const auto count = std::min(best, methods.rows.size());
    PageTable others = methods;
    methods.rows.resize(count);
    std::erase_if(methods.legend, [&](const PageFact& fact) {
        return std::none_of(methods.rows.begin(), methods.rows.end(),
                            [&](const auto& row) { return row[0] == fact.name; });
    });
    section.tables.push_back(std::move(methods));
    others.rows.erase(others.rows.begin(), others.rows.begin() + static_cast<std::ptrdiff_t>(count));
    if (others.rows.empty()) return;
    others.title = "The other methods";
    others.folded = true;
    section.tables.push_back(std::move(others));
}

// All of a list whose best columns stand above.
void add_every_value(PageSection& section, const std::string& name, const Json& rows) {
    section.tables.push_back(table_of(name, rows));
    section.tables.back().title = fmt::format("Every value of the {}", name);
    section.tables.back().folded = true;
}

// The tables that people read across have columns of their own choice; false for any other.
bool add_known_table(PageSection& section, const std::string& kind, const std::string& name,
                     const Json& rows) {
    if (!is_table(rows)) return false;
    if (kind == "comparison" && name == "methods") {
        section.tables.push_back(comparison_table(rows));
        add_method_ledgers(section, rows, PageTable(section.tables.back()));
    } else if (kind == "recommendation" && name == "methods") {
        add_best(section, comparison_table(rows));
        add_every_value(section, name, rows);
    } else if (kind == "joint" && name == "lines") {
        Json lines = rows;  // amplitudes at each speed are in the figure
        for (Json& line : lines) line.erase("amplitude_by_speed");
        section.tables.push_back(table_of(name, lines));
        add_every_value(section, name, rows);
    } else if (kind == "table" && name == "bands") {
        section.tables.push_back(notch_table(rows));
        add_every_value(section, name, rows);
    } else if (kind == "diagnosis" && name == "rounds") {
        section.tables.push_back(rounds_table(rows));
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
void add_fields(PageSection& section, const std::string& kind, const Json& json) {
    constexpr std::array told = {"schema", "tool", "version", "command", "inputs", "verdict"};
    for (const auto& [name, entry] : json.items()) {
        if (std::find(told.begin(), told.end(), name) != told.end()) continue;
        if (add_known_table(section, kind, name, entry)) continue;
        const std::size_t before = section.tables.size();
        add_field(section, name, json);
        for (std::size_t i = before; i < section.tables.size(); ++i)
            section.tables[i].folded = is_ledger(kind, name);
    }
}

// A page names a file without its folders.
std::string without_folders(const std::string& path) {
    return std::filesystem::path(path).filename().string();
}

PageSection section_of_figure(Figure figure, const std::vector<PageFact>& inputs) {
    PageSection section;
    for (const PageFact& input : inputs)
        if (const auto at = figure.title.find(input.name); at != std::string::npos)
            figure.title.replace(at, input.name.size(), without_folders(input.name));
    section.title = figure.title;
    section.verdict = std::exchange(figure.sentence, "");
    section.figures.push_back(std::move(figure));
    return section;  // its JSON is all in the figure
}

// `source` is for messages, `shown` for people.
PageSection section_of(const std::string& text, const std::string& source, const std::string& shown) {
    const auto [kind, json] = parse_any_document(text, source);
    std::vector<PageFact> inputs;
    for (const Json& input : json.value("inputs", Json::array()))
        inputs.push_back({text_at(input, "name"), text_at(input, "sha256")});
    PageSection section;
    if (kind == "figure") section = section_of_figure(figure_from_json(text, source), inputs);
    section.command = text_at(json, "command");
    section.inputs = std::move(inputs);
    if (kind == "figure") return section;
    section.title = fmt::format("{}: {}", heading_of(kind), shown);
    section.json = text;
    if (const auto verdict = json.find("verdict"); verdict != json.end())
        section.verdict = value_text(*verdict);
    if (section.verdict.empty()) section.verdict = sentence_of(kind, json);
    section.in_summary = true;
    section.state = state_of(json);
    section.key = key_numbers(kind, json);
    add_fields(section, kind, json);
    if (kind == "joint") {
        section.figures.push_back(identification_figure(shown, identification_from_json(text, source)));
        section.figures.back().sentence.clear();  // it is the verdict above
    } else if (kind == "map") {
        if (const MapFit fit = map_from_json(text, source); !fit.map.orders.empty())
            section.figures.push_back(map_figure(shown, fit));
    } else if (kind == "table") {
        section.figures.push_back(table_figure(table_from_json(text, source)));
    } else if (kind == "trend") {
        section.figures.push_back(trend_figure(courses_of(json)));
    } else if (kind == "diagnosis") {
        section.verdict = json.value("sentence", section.verdict);
        section.figures.push_back(
            gap_figure(fmt::format("How the gap shrank: {}", shown), gap_of(json, source)));
    }
    return section;
}

}  // namespace

std::vector<PageSection> sections_of_result(const std::string& text, const std::string& source) {
    const auto [kind, whole] = parse_any_document(text, source);
    // Lists of what a command gives of each joint of a log, and what each entry is.
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 6> lists = {
        {{"joints", "joint"},
         {"diagnoses", "diagnosis"},
         {"spectra", "spectrum"},
         {"tracks", "track"},
         {"comparisons", "comparison"},
         {"recommendations", "recommendation"}}};
    const auto list =
        std::find_if(lists.begin(), lists.end(), [&](const auto& known) { return known.first == kind; });
    if (list == lists.end()) return {section_of(text, source, without_folders(source))};
    const auto joints = whole.find("joints");
    if (joints == whole.end() || !joints->is_array())
        raise<DataError>("{}: joints: expected a list, each entry the {} of a joint", source, list->second);
    std::vector<PageSection> sections;
    for (const Json& joint : *joints) {
        // Each is what the command prints of one joint, under a head of its own.
        Json one{{"schema", fmt::format("ripplenotch/{}/1", list->second)}};
        for (const char* name : {"tool", "version", "command", "inputs"})
            if (whole.contains(name)) one[name] = whole[name];
        if (joint.is_object())
            for (const auto& [name, entry] : joint.items())
                if (name != "joint") one[name] = entry;
        const std::string name = joint.is_object() ? text_at(joint, "joint") : "";
        sections.push_back(section_of(one.dump(), fmt::format("{}, joint {}", source, name),
                                      fmt::format("{}, joint {}", without_folders(source), name)));
    }
    return sections;
}

}  // namespace ripplenotch
