// SPDX-License-Identifier: MIT
#include "cli/compare/comparison_view.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cli/design/design_text.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch {

namespace {

// A delay ledger as people read it.

std::string ledger_place(const LedgerEntry& entry) {
    if (entry.band > 0)
        return fmt::format("{}: {:.5g}-{:.5g}", entry.band, entry.from.value(), entry.to.value());
    return entry.to.value() > 0.0 ? fmt::format("{:g}", entry.from.value()) : "any";
}

std::vector<std::string> ledger_row(const LedgerEntry& entry, bool crossover) {
    std::vector<std::string> cells = {ledger_place(entry), rounded(1e3 * entry.dc_delay.value(), 1)};
    cells.push_back(entry.ramp_delay ? rounded(1e3 * entry.ramp_delay->value(), 1) : "-");
    for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
        cells.push_back(entry.step ? rounded(1e3 * entry.step->settle[i].value(), 0) : "-");
    cells.push_back(entry.step ? rounded(entry.step->overshoot_percent, 1) : "-");
    if (crossover) {
        cells.push_back(entry.phase_lag_deg ? rounded(*entry.phase_lag_deg, 1) : "-");
        cells.push_back(entry.crossover_db ? rounded(*entry.crossover_db, 1) : "-");
    }
    return cells;
}

std::string milliseconds(const std::optional<Seconds>& time) {
    return time ? rounded(1e3 * time->value(), 0) : "-";
}

std::string band_name(int band) { return band > 0 ? std::to_string(band) : "none"; }

// Errors are there where the true torque is known.
std::string switches_text(const MethodFigures& figures) {
    if (figures.switch_ledger.empty()) return "";
    const bool truth = figures.switch_ledger.front().peak_error_nm.has_value();
    std::vector<std::vector<std::string>> rows = {{"change", "from", "to", "speed", "jump"},
                                                  {"at s", "band", "band", "deg/s", "Nm"}};
    if (truth) {
        rows[0].insert(rows[0].end(), {"error, Nm", "", "peak after", "settles, ms"});
        rows[1].insert(rows[1].end(), {"before", "peak", "ms"});
        for (const double percent : settle_bands_percent) rows[1].push_back(fmt::format("to {} %", percent));
    }
    for (const SwitchEntry& entry : figures.switch_ledger) {
        rows.push_back({rounded(entry.time.value(), 3), band_name(entry.change.from_band),
                        band_name(entry.change.to_band), rounded(entry.change.speed_deg_s, 1),
                        rounded(entry.change.jump_nm, 3)});
        if (!truth) continue;
        auto& cells = rows.back();
        cells.push_back(entry.error_before_nm ? rounded(*entry.error_before_nm, 3) : "-");
        cells.push_back(rounded(entry.peak_error_nm.value_or(0.0), 3));
        cells.push_back(milliseconds(entry.peak_after));
        for (const auto& settle : entry.settle) cells.push_back(milliseconds(settle));
    }
    return "\n" + text_table(rows, "r");
}

// One table a method, a row for every band or speed, and for each method that has a limit the speed from
// which it keeps it. Empty when no ledger was asked for.
std::string ledger_text(const Comparison& comparison) {
    std::string text;
    for (const MethodFigures& figures : comparison.methods) {
        if (figures.within_from) {
            text += figures.within_from->value() > 0.0
                        ? fmt::format("{}: within the delay limit from {:.3g} deg/s on.\n", figures.method,
                                      figures.within_from->value())
                        : fmt::format("{}: within the delay limit at every speed.\n", figures.method);
        }
        if (figures.ledger.empty()) continue;
        std::vector<std::vector<std::string>> rows = {{"speed", "DC delay", "ramp delay", "settles, ms"},
                                                      {"deg/s", "ms", "ms"}};
        for (std::size_t i = 0; i < settle_bands_percent.size(); ++i) {
            if (i > 0) rows[0].push_back("");
            rows[1].push_back(fmt::format("to {} %", settle_bands_percent[i]));
        }
        rows[0].push_back("overshoot");
        rows[1].push_back("%");
        if (comparison.crossover) {
            rows[0].push_back(fmt::format("lag at {:g} Hz", comparison.crossover->value()));
            rows[0].push_back("gain");
            rows[1].insert(rows[1].end(), {"deg", "dB"});
        }
        for (const LedgerEntry& entry : figures.ledger)
            rows.push_back(ledger_row(entry, comparison.crossover.has_value()));
        text += fmt::format("\n{}\n", figures.method) + text_table(rows, "r") + switches_text(figures);
    }
    if (comparison.no_notch_below)
        text += "\n" + slowest_sentence(*comparison.max_delay, *comparison.no_notch_below) + "\n";
    return text;
}

constexpr std::size_t page_width = 100;

// A sentence wrapped to lines that a terminal shows whole.
std::string paragraph(const std::string& sentence) {
    std::string text;
    for (const std::string& line : wrapped(sentence, page_width)) text += line + "\n";
    return text;
}

struct ViewColumn {
    std::string title, unit;
    std::function<std::string(const MethodFigures&)> cell;  ///< empty text: not measured
    bool with_next = false;  ///< stands beside the next one: they share a title
};

std::string fixed_or_empty(const std::optional<double>& value, int decimals) {
    return value ? rounded(*value, decimals) : "";
}

std::string attenuation(const MethodFigures& figures, std::size_t line) {
    if (line >= figures.attenuation.size() || !figures.attenuation[line].db) return "";
    const double db = *figures.attenuation[line].db;
    if (db >= most_attenuation_db) return fmt::format(">{:.0f}", most_attenuation_db);
    return rounded(db, 1);
}

// What a method costs.
std::vector<ViewColumn> cost_columns(const Comparison& comparison) {
    std::vector<ViewColumn> columns;
    for (std::size_t b = 0; b < settle_bands_percent.size(); ++b) {
        columns.push_back(
            {b == 0 ? "settles, ms" : "", fmt::format("to {} %", settle_bands_percent[b]),
             [b](const MethodFigures& f) { return f.settle_ms ? fixed_or_empty((*f.settle_ms)[b], 0) : ""; },
             b + 1 < settle_bands_percent.size()});
    }
    columns.push_back(
        {"overshoot", "%", [](const MethodFigures& f) { return fixed_or_empty(f.overshoot_percent, 1); }});
    columns.push_back({"ramp delay", "ms",
                       [](const MethodFigures& f) { return fixed_or_empty(f.ramp_delay_ms, 1); }, true});
    columns.push_back(
        {"DC delay", "ms", [](const MethodFigures& f) { return fixed_or_empty(f.dc_delay_ms, 1); }});
    if (comparison.crossover) {
        columns.push_back({fmt::format("lag at {:g} Hz", comparison.crossover->value()), "deg",
                           [](const MethodFigures& f) { return fixed_or_empty(f.phase_lag_deg, 1); }, true});
        columns.push_back(
            {"", "dB", [](const MethodFigures& f) { return fixed_or_empty(f.crossover_db, 1); }});
    }
    return columns;
}

// What it leaves.
std::vector<ViewColumn> result_columns(const Comparison& comparison) {
    std::vector<ViewColumn> columns;
    for (std::size_t i = 0; comparison.lines && i < comparison.lines->orders.size(); ++i) {
        columns.push_back({fmt::format("order {}", shortest(comparison.lines->orders[i].value())), "dB",
                           [i](const MethodFigures& f) { return attenuation(f, i); }});
    }
    columns.push_back(
        {"ripple", "Nm rms", [](const MethodFigures& f) { return fixed_or_empty(f.ripple_rms_nm, 4); }});
    columns.push_back({"residual", "Nm rms",
                       [](const MethodFigures& f) { return fixed_or_empty(f.residual_rms_nm, 4); }, true});
    columns.push_back(
        {"", "Nm p-p", [](const MethodFigures& f) { return fixed_or_empty(f.residual_peak_to_peak_nm, 3); }});
    columns.push_back(
        {"error", "Nm rms", [](const MethodFigures& f) { return fixed_or_empty(f.error_rms_nm, 4); }});
    columns.push_back({"switches", "",
                       [](const MethodFigures& f) { return f.switches ? std::to_string(*f.switches) : ""; },
                       true});
    columns.push_back(
        {"largest", "jump, Nm", [](const MethodFigures& f) { return fixed_or_empty(f.largest_jump_nm, 3); }});
    return columns;
}

using Cells = std::vector<std::vector<std::string>>;  // rows of a table

// The names of the methods below two lines of head.
Cells names_of(const Comparison& comparison) {
    Cells rows = {{"method"}, {""}};
    for (const MethodFigures& figures : comparison.methods) rows.push_back({figures.method});
    return rows;
}

// The same with further columns; those that no method has a figure for are left out.
Cells with_columns(Cells rows, const Comparison& comparison, std::span<const ViewColumn> columns) {
    for (const ViewColumn& column : columns) {
        std::vector<std::string> cells;
        for (const MethodFigures& figures : comparison.methods) cells.push_back(column.cell(figures));
        if (std::all_of(cells.begin(), cells.end(), [](const std::string& cell) { return cell.empty(); }))
            continue;
        rows[0].push_back(column.title);
        rows[1].push_back(column.unit);
        for (std::size_t i = 0; i < cells.size(); ++i)
            rows[i + 2].push_back(cells[i].empty() ? "-" : cells[i]);
    }
    return rows;
}

bool fits(const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        if (end - at > page_width) return false;
        at = end + 1;
    }
    return true;
}

// Tables to stand one below the other, each as wide as the page at most.
std::vector<std::string> tables_of(const Comparison& comparison, std::span<const ViewColumn> columns) {
    std::vector<std::string> tables;
    for (std::size_t at = 0; at < columns.size();) {
        Cells rows = names_of(comparison);
        do {
            std::size_t end = at + 1;
            while (columns[end - 1].with_next) ++end;
            Cells wider = with_columns(rows, comparison, columns.subspan(at, end - at));
            if (rows[0].size() > 1 && !fits(text_table(wider, "lr"))) break;
            rows = std::move(wider);
            at = end;
        } while (at < columns.size());
        if (rows[0].size() > 1) tables.push_back(text_table(rows, "lr"));
    }
    return tables;
}

// All in one table where it fits on the page; else what the methods cost above what they leave, unless that
// takes more tables than need be.
std::string rows_of(const Comparison& comparison) {
    const std::vector<ViewColumn> costs = cost_columns(comparison), results = result_columns(comparison);
    std::vector<ViewColumn> all = costs;
    all.insert(all.end(), results.begin(), results.end());
    std::vector<std::string> tables = tables_of(comparison, all);
    if (tables.empty()) return text_table(names_of(comparison), "l");
    if (tables.size() > 1) {
        std::vector<std::string> apart = tables_of(comparison, costs);
        for (std::string& table : tables_of(comparison, results)) apart.push_back(std::move(table));
        if (apart.size() <= tables.size()) tables = std::move(apart);
    }
    return fmt::format("{}", fmt::join(tables, "\n"));
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
        return paragraph(fmt::format("All {} switching methods at this speed: {}.", switching.size(),
                                     switching.front()->note));
    std::string text;
    for (const MethodFigures* figures : switching)
        text += paragraph(fmt::format("{} at this speed: {}.", figures->method, figures->note));
    return text;
}

std::string conditions(const Comparison& comparison) {
    std::string text, on;
    if (comparison.on_log) {
        on = fmt::format("Log: {} rows at {:.6g} Hz.", comparison.rows, comparison.sample_rate.value());
        if (comparison.windows > 0) {
            on += fmt::format(
                " Orders, ripple and residual (torque minus its trend) are measured in {} window{}, "
                "{:.0f} % of the log.",
                comparison.windows, comparison.windows == 1 ? "" : "s", 100.0 * comparison.measured_share);
        }
        text = paragraph(on);
        on = fmt::format("Settling and delays: at {:.6g} deg/s, on", comparison.speed.value());
    } else {
        on = fmt::format("At {:.6g} deg/s, sampled at {:.6g} Hz, on", comparison.speed.value(),
                         comparison.sample_rate.value());
    }
    if (comparison.step_nm) on += fmt::format(" a step of {:.6g} Nm", *comparison.step_nm);
    if (comparison.step_nm && comparison.ramp_nm_s) on += " and";
    if (comparison.ramp_nm_s) on += fmt::format(" a ramp of {:.6g} Nm/s", *comparison.ramp_nm_s);
    return text + paragraph(on + ".") + notes_in_force(comparison);
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

}  // namespace

std::string comparison_view(const Comparison& comparison) {
    const Comparison named = with_short_names(comparison);
    std::string text = paragraph(verdict(comparison)) + "\n" + rows_of(named) + "\n" + conditions(named);
    if (comparison.match && !comparison.match->low_pass) {
        std::string sentence = comparison.match->clause;
        sentence.front() = 'N';  // all of them begin with "no low-pass"
        text += paragraph(sentence + ".");
    }
    return text + legend(comparison) + ledger_text(named);
}

}  // namespace ripplenotch
