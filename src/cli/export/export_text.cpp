// SPDX-License-Identifier: MIT
#include "cli/export/export_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/text_table.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// A rounded zero has no sign: -0.0000 would differ from machine to machine.
std::string fixed(const std::optional<double>& value, int decimals) {
    if (!value) return "-";
    const std::string text = fmt::format("{:.{}f}", *value, decimals);
    const bool is_zero = text.find_first_of("123456789") == std::string::npos;
    return is_zero && text.front() == '-' ? text.substr(1) : text;
}

std::string depth_text(const SectionCheck& check) {
    if (!check.is_notch) return "-";
    const double depth = check.depth_db.value_or(check.response_depth_db);
    return depth >= deepest_measured_db ? fmt::format(">{:.0f}", deepest_measured_db) : fixed(depth, 1);
}

std::vector<std::string> row(const SectionCheck& check, bool bands) {
    std::vector<std::string> cells;
    if (bands) cells.push_back(std::to_string(check.band));
    cells.push_back(check.order ? shortest(check.order->value()) : std::to_string(check.section));
    cells.push_back(fmt::format("{:.6g}", check.center.value()));
    cells.push_back(check.shift_percent ? fixed(check.shift_percent, 4) : "none");
    cells.push_back(fmt::format("{:.4g}", check.q));
    cells.push_back(depth_text(check));
    cells.push_back(fixed(check.dc_error_db, 5));
    cells.push_back(fixed(check.mean_error_nm ? std::optional(1e3 * *check.mean_error_nm) : std::nullopt, 4));
    cells.push_back(fixed(check.pole_radius, 7));
    return cells;
}

}  // namespace

std::string export_report_to_text(const ExportReport& report) {
    const bool bands = !report.checks.empty() && report.checks.front().band > 0;
    std::string text = fmt::format("{}: {}, read back and run at {} Hz in {}.\n\n",
                                   report.file == "-" ? "standard output" : report.file, report.target,
                                   shortest(report.sample_rate.value()), report.arithmetic);
    const bool orders = !report.checks.empty() && report.checks.front().order.has_value();
    std::vector<std::vector<std::string>> rows = {{orders ? "order" : "section", "centre Hz", "shift %", "Q",
                                                   "depth dB", "DC error dB", "mean error mNm",
                                                   "pole radius"}};
    if (bands) rows.front().insert(rows.front().begin(), "band");
    for (const SectionCheck& check : report.checks) rows.push_back(row(check, bands));
    text += text_table(rows, "r");
    text += fmt::format("\nThe torque it ran on: {} Nm, and 1 Nm of ripple at the designed centre.\n",
                        shortest(verify_load_nm));
    return text;
}

}  // namespace ripplenotch
