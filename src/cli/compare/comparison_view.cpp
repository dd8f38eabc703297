// SPDX-License-Identifier: MIT
#include "cli/compare/comparison_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "cli/compare/ledger_text.hpp"
#include "cli/text_table.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/evaluate/bench.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t page_width = 110;

struct ViewColumn {
    std::string title, unit;
    std::function<std::string(const MethodFigures&)> cell;  ///< empty text: not measured
};

std::string fixed(const std::optional<double>& value, int decimals) {
    return value ? rounded(*value, decimals) : "";
}

std::string attenuation(const MethodFigures& figures, std::size_t line) {
    if (line >= figures.attenuation.size() || !figures.attenuation[line].db) return "";
    const double db = *figures.attenuation[line].db;
    if (db >= most_attenuation_db) return fmt::format(">{:.0f}", most_attenuation_db);
    return rounded(db, 1);
}

std::vector<ViewColumn> columns_of(const Comparison& comparison) {
    std::vector<ViewColumn> columns;
    for (std::size_t b = 0; b < settle_bands_percent.size(); ++b) {
        columns.push_back(
            {b == 0 ? "settles, ms" : "", fmt::format("to {} %", settle_bands_percent[b]),
             [b](const MethodFigures& f) { return f.settle_ms ? fixed((*f.settle_ms)[b], 0) : ""; }});
    }
    columns.push_back(
        {"overshoot", "%", [](const MethodFigures& f) { return fixed(f.overshoot_percent, 1); }});
    columns.push_back({"ramp delay", "ms", [](const MethodFigures& f) { return fixed(f.ramp_delay_ms, 1); }});
    columns.push_back({"DC delay", "ms", [](const MethodFigures& f) { return fixed(f.dc_delay_ms, 1); }});
    if (comparison.crossover) {
        columns.push_back({fmt::format("lag at {:g} Hz", comparison.crossover->value()), "deg",
                           [](const MethodFigures& f) { return fixed(f.phase_lag_deg, 1); }});
        columns.push_back({"", "dB", [](const MethodFigures& f) { return fixed(f.crossover_db, 1); }});
    }
    for (std::size_t i = 0; comparison.lines && i < comparison.lines->orders.size(); ++i) {
        columns.push_back({fmt::format("order {}", shortest(comparison.lines->orders[i].value())), "dB",
                           [i](const MethodFigures& f) { return attenuation(f, i); }});
    }
    columns.push_back({"ripple", "Nm rms", [](const MethodFigures& f) { return fixed(f.ripple_rms_nm, 4); }});
    columns.push_back(
        {"residual", "Nm rms", [](const MethodFigures& f) { return fixed(f.residual_rms_nm, 4); }});
    columns.push_back(
        {"", "Nm p-p", [](const MethodFigures& f) { return fixed(f.residual_peak_to_peak_nm, 3); }});
    columns.push_back({"switches", "",
                       [](const MethodFigures& f) { return f.switches ? std::to_string(*f.switches) : ""; }});
    columns.push_back(
        {"largest", "jump, Nm", [](const MethodFigures& f) { return fixed(f.largest_jump_nm, 3); }});
    columns.push_back({"error", "Nm rms", [](const MethodFigures& f) { return fixed(f.error_rms_nm, 4); }});
    return columns;
}

std::string rows_of(const Comparison& comparison) {
    std::vector<std::vector<std::string>> rows = {{"method"}, {""}};
    for (const MethodFigures& figures : comparison.methods) rows.push_back({figures.method});
    for (const ViewColumn& column : columns_of(comparison)) {
        std::vector<std::string> cells;
        for (const MethodFigures& figures : comparison.methods) cells.push_back(column.cell(figures));
        if (std::all_of(cells.begin(), cells.end(), [](const std::string& cell) { return cell.empty(); }))
            continue;
        rows[0].push_back(column.title);
        rows[1].push_back(column.unit);
        for (std::size_t i = 0; i < cells.size(); ++i)
            rows[i + 2].push_back(cells[i].empty() ? "-" : cells[i]);
    }
    return text_table(rows, "lr");
}

// The band that switching methods have in force, said once where it is the same for all of them.
std::string notes_in_force(const Comparison& comparison) {
    std::vector<const MethodFigures*> switching;
    for (const MethodFigures& figures : comparison.methods) {
        if (figures.switches && !figures.note.empty()) switching.push_back(&figures);
    }
    const bool alike = std::all_of(switching.begin(), switching.end(), [&](const MethodFigures* figures) {
        return figures->note == switching.front()->note;
    });
    if (switching.size() > 1 && alike)
        return fmt::format("All {} switching methods at this speed: {}.\n", switching.size(),
                           switching.front()->note);
    std::string text;
    for (const MethodFigures* figures : switching)
        text += fmt::format("{} at this speed: {}.\n", figures->method, figures->note);
    return text;
}

std::string conditions(const Comparison& comparison) {
    std::string text;
    if (comparison.on_log) {
        text += fmt::format("Log: {} rows at {:.6g} Hz.", comparison.rows, comparison.sample_rate.value());
        if (comparison.windows > 0) {
            text += fmt::format(
                " Orders, ripple and residual (torque minus its trend) are measured in {} window{}, "
                "{:.0f} % of the log.",
                comparison.windows, comparison.windows == 1 ? "" : "s", 100.0 * comparison.measured_share);
        }
        text += fmt::format("\nSettling and delays: at {:.6g} deg/s, on", comparison.speed.value());
    } else {
        text += fmt::format("At {:.6g} deg/s, sampled at {:.6g} Hz, on", comparison.speed.value(),
                            comparison.sample_rate.value());
    }
    if (comparison.step_nm) text += fmt::format(" a step of {:.6g} Nm", *comparison.step_nm);
    if (comparison.step_nm && comparison.ramp_nm_s) text += " and";
    if (comparison.ramp_nm_s) text += fmt::format(" a ramp of {:.6g} Nm/s", *comparison.ramp_nm_s);
    text += ".\n";
    return text + notes_in_force(comparison);
}

// The same with short names for its methods.
Comparison with_short_names(const Comparison& comparison) {
    Comparison named = comparison;
    for (std::size_t i = 0; i < named.methods.size(); ++i)
        named.methods[i].method = short_name(comparison.methods[i], comparison);
    return named;
}

// The methods with short names, as they would be typed.
std::string legend(const Comparison& comparison) {
    std::string text;
    for (const MethodFigures& figures : comparison.methods) {
        const std::string name = short_name(figures, comparison);
        if (name != figures.method) text += fmt::format("{} is --method {}\n", name, figures.method);
    }
    return text.empty() ? text : "\n" + text;
}

// A sentence wrapped to lines that a terminal shows whole.
std::string paragraph(const std::string& sentence) {
    std::string text;
    for (const std::string& line : wrapped(sentence, page_width)) text += line + "\n";
    return text;
}

}  // namespace

std::string comparison_view(const Comparison& comparison) {
    const Comparison named = with_short_names(comparison);
    std::string text = paragraph(verdict(comparison)) + "\n" + rows_of(named) + "\n" + conditions(named);
    if (comparison.match && !comparison.match->low_pass) {
        std::string sentence = comparison.match->clause;
        sentence.front() = 'N';  // all of them begin with "no low-pass"
        text += sentence + ".\n";
    }
    return text + legend(comparison) + ledger_text(named);
}

}  // namespace ripplenotch
