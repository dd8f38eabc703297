// SPDX-License-Identifier: MIT
#include "page/result_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "page/json_table.hpp"

namespace ripplenotch {

namespace {

std::string text_in(const Json& row, const char* name) {
    const auto found = row.find(name);
    return found != row.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string joint_in(const Json& row) {
    const std::string robot = text_in(row, "robot"), joint = text_in(row, "joint");
    return robot.empty() ? joint : robot + " " + joint;
}

std::string day_in(const Json& row, const char* name) { return text_in(row, name).substr(0, 10); }

std::string number_in(const Json& row, const char* name, const char* format) {
    const auto found = row.find(name);
    return found != row.end() && found->is_number() ? fmt::format(fmt::runtime(format), found->get<double>())
                                                    : "-";
}

// One day, or the days between which it lies.
std::string since(const Json& row) {
    const std::string day = day_in(row, "date"), early = day_in(row, "earliest"),
                      late = day_in(row, "latest");
    if (text_in(row, "kind") == "drift") return "all the time";
    return early == late ? day : fmt::format("{} ({} to {})", day, early, late);
}

void add_log(PageTable& table, std::vector<std::string>& cells, const Json& row, const char* log,
             const char* page) {
    const std::string address = text_in(row, page);
    if (!address.empty()) table.links.push_back({table.rows.size(), cells.size(), address});
    cells.push_back(text_in(row, log));
}

}  // namespace

PageTable alert_table(const Json& alerts) {
    PageTable table{"Alerts",
                    {"joint", "alert", "since", "surest sign", "change", "%", "p", "of its kind",
                     "last log before", "first log after"},
                    {}};
    for (const Json& row : alerts) {
        const std::string drift = text_in(row, "kind") == "drift" ? "drift: " : "";
        std::vector<std::string> cells = {joint_in(row),
                                          drift + text_in(row, "cause"),
                                          since(row),
                                          text_in(row, "descriptor"),
                                          number_in(row, "size", "{:+.3g}"),
                                          number_in(row, "percent", "{:+.1f}"),
                                          number_in(row, "p", "{:.1g}"),
                                          number_in(row, "kin", "{:g}")};
        add_log(table, cells, row, "last_log_before", "last_page_before");
        add_log(table, cells, row, "first_log_after", "first_page_after");
        table.rows.push_back(std::move(cells));
    }
    return table;
}

PageTable course_table(const Json& courses) {
    PageTable table{"Logs of the joints that are drawn", {"joint", "descriptor", "date", "value", "log"}, {}};
    for (const Json& row : courses) {
        std::vector<std::string> cells = {joint_in(row), text_in(row, "descriptor"), day_in(row, "date"),
                                          number_in(row, "value", "{:.4g}")};
        add_log(table, cells, row, "log", "page");
        table.rows.push_back(std::move(cells));
    }
    table.folded = true;
    return table;
}

namespace {

constexpr std::size_t most_letters = 26, most_switches = 10, fewest_for_figure = 20, bars = 20;

std::string label_of(std::size_t i) {
    return i < most_letters ? std::string(1, static_cast<char>('A' + i)) : fmt::format("M{}", i + 1);
}

// A number, or a dash; attenuation without bound is null in a document.
std::string cell(const Json& row, const char* name) {
    const auto found = row.find(name);
    if (found == row.end() || !found->is_number()) return "-";
    return coarse_text(found->get<double>());
}

std::vector<std::pair<std::string, std::string>> method_cells(const Json& method) {
    std::vector<std::pair<std::string, std::string>> cells;
    if (const auto meets = method.find("meets"); meets != method.end() && meets->is_boolean())
        cells.emplace_back("fits", meets->get<bool>() ? "yes" : "no");
    cells.emplace_back("late at most, ms", cell(method, "longest_delay_ms"));
    if (const auto settle = method.find("settle_ms"); settle != method.end() && settle->is_object())
        cells.emplace_back("settles to 0.5 %, ms", cell(*settle, "0.5"));
    cells.emplace_back("overshoot, %", cell(method, "overshoot_percent"));
    cells.emplace_back("ramp delay, ms", cell(method, "ramp_delay_ms"));
    cells.emplace_back("delay at 0 Hz, ms", cell(method, "dc_delay_ms"));
    cells.emplace_back("lag at the crossover, deg", cell(method, "phase_lag_deg"));
    if (const auto lines = method.find("attenuation_db"); lines != method.end() && is_table(*lines))
        for (const Json& line : *lines)
            cells.emplace_back(fmt::format("attenuation of order {}, dB", cell(line, "order")),
                               cell(line, "db"));
    cells.emplace_back("ripple left, Nm rms", cell(method, "ripple_rms_nm"));
    cells.emplace_back("residual, Nm rms", cell(method, "residual_rms_nm"));
    cells.emplace_back("switches", cell(method, "switches"));
    cells.emplace_back("largest jump, Nm", cell(method, "largest_jump_nm"));
    cells.emplace_back("error, Nm rms",
                       cell(method, method.contains("error_nm") ? "error_nm" : "error_rms_nm"));
    return cells;
}

// What a label stands for, and why a method is not recommended.
std::string legend_of(const Json& method, const std::string& spec) {
    std::string words = spec;
    if (const auto reasons = method.find("shortfalls"); reasons != method.end() && reasons->is_array())
        for (const Json& reason : *reasons) words += "; " + value_text(reason);
    return words;
}

void drop_empty_columns(PageTable& table) {
    for (std::size_t c = table.header.size(); c-- > 1;) {
        if (!std::all_of(table.rows.begin(), table.rows.end(),
                         [c](const auto& row) { return row[c] == "-"; }))
            continue;
        table.header.erase(table.header.begin() + static_cast<std::ptrdiff_t>(c));
        for (auto& row : table.rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(c));
    }
}

double jump_of(const Json& one) {
    const auto found = one.find("jump_nm");
    return found != one.end() && found->is_number() ? std::abs(found->get<double>()) : 0.0;
}

}  // namespace

PageTable comparison_table(const Json& methods) {
    PageTable table{"The methods", {"method"}, {}};
    std::vector<std::vector<std::pair<std::string, std::string>>> all;
    std::size_t labels = 0;
    for (const Json& method : methods) {
        const auto found = method.find("method");
        const std::string spec = found != method.end() ? value_text(*found) : "-";
        const std::string label = spec == "none" ? spec : label_of(labels++);
        if (spec != "none") table.legend.push_back({label, legend_of(method, spec)});
        table.rows.push_back({label});
        all.push_back(method_cells(method));
        for (const auto& [column, value] : all.back())
            if (std::find(table.header.begin(), table.header.end(), column) == table.header.end())
                table.header.push_back(column);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        table.rows[i].resize(table.header.size(), "-");
        for (const auto& [column, value] : all[i]) {
            const auto at = std::find(table.header.begin(), table.header.end(), column);
            table.rows[i][static_cast<std::size_t>(at - table.header.begin())] = value;
        }
    }
    drop_empty_columns(table);
    return table;
}

PageTable notch_table(const Json& bands) {
    Json rows = Json::array();
    for (const Json& band : bands) {
        Json row{{"band", band.value("number", Json())}};
        row["speed, deg/s"] =
            fmt::format("{} to {}", cell(band, "speed_from_deg_s"), cell(band, "speed_to_deg_s"));
        const auto notches = band.find("notches");
        if (notches != band.end() && is_table(*notches)) {
            for (const Json& notch : *notches) {
                const std::string order = cell(notch, "order");
                row[fmt::format("order {}: centre, Hz", order)] = cell(notch, "center_hz");
                row[fmt::format("order {}: Q", order)] = cell(notch, "q");
            }
        }
        row["delay at 0 Hz, ms"] = cell(band, "dc_delay_ms");
        row["settles, ms"] = cell(band, "settle_ms");
        row["least attenuation, dB"] = cell(band, "held_attenuation_db");
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

}  // namespace ripplenotch
