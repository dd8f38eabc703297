// SPDX-License-Identifier: MIT
#include "cli/compare/ledger_text.hpp"

#include <fmt/format.h>

#include <vector>

#include "cli/design/frontier_text.hpp"
#include "cli/text_table.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

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

}  // namespace

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

}  // namespace ripplenotch
