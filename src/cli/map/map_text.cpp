// SPDX-License-Identifier: MIT
#include "cli/map/map_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/text_table.hpp"
#include "core/matrices/normal_errors.hpp"
#include "ripplenotch/core/how_many.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using MapRows = std::vector<std::vector<std::string>>;

std::string without_decimals(double value) { return fmt::format("{:.0f}", std::round(value) + 0.0); }

std::string decibels(double from_nm, double to_nm) {
    if (!(from_nm > 0.0 && to_nm > 0.0)) return "-";
    return fmt::format("{:.1f}", 20.0 * portable::log10(from_nm / to_nm) + 0.0);
}

MapRows scores_of(const MapFit& fit) {
    MapRows rows = {{"order", "ripple Nm", "left Nm", "dB", "noise allows dB", "predicted %", ""}};
    for (const MapOrderScore& score : fit.scores) {
        rows.push_back({shortest(score.order), fmt::format("{:.3f}", score.ripple_nm),
                        fmt::format("{:.3f}", score.left_nm), decibels(score.ripple_nm, score.left_nm),
                        decibels(score.ripple_nm, score.noise_nm),
                        without_decimals(100.0 * score.predicted_share),
                        score.in_map ? "" : "follows no map"});
    }
    return rows;
}

MapRows map_values(const MapFit& fit) {
    MapRows rows = {{"order", "at", "cosine Nm", "+/-", "sine Nm", "+/-", "amplitude Nm", "phase deg"}};
    for (std::size_t i = 0; i < fit.map.orders.size(); ++i) {
        for (std::size_t c = 0; c < fit.map.values[i].size(); ++c) {
            const std::complex<double> z = fit.map.values[i][c], error = normal_95_errors * fit.errors[i][c];
            rows.push_back({shortest(fit.map.orders[i].value()), map_column_words(fit.map.form, c),
                            rounded(z.real(), 3), fmt::format("{:.3f}", error.real()), rounded(z.imag(), 3),
                            fmt::format("{:.3f}", error.imag()),
                            fmt::format("{:.3f}", portable::hypot(z.real(), z.imag())),
                            without_decimals(-portable::arg(z) * degrees_per_radian)});
        }
    }
    return rows;
}

MapRows agreement_of(const MapFit& fit, const std::vector<std::string>& logs) {
    MapRows rows = {{"order", "times as large", "+/-", "deg ahead", "+/-", "", "log"}};
    for (const MapAgreement& one : fit.agreement) {
        rows.push_back({shortest(one.order), fmt::format("{:.2f}", one.amplitude_ratio),
                        fmt::format("{:.2f}", normal_95_errors * one.amplitude_error),
                        without_decimals(one.phase_deg),
                        without_decimals(std::min(normal_95_errors * one.phase_error_deg, 180.0)),
                        one.agrees ? "" : "disagrees",
                        one.log < logs.size() ? logs[one.log] : fmt::format("log {}", one.log + 1)});
    }
    return rows;
}

}  // namespace

std::string map_report(const MapFit& fit, const std::vector<std::string>& logs) {
    std::string text = map_verdict(fit) + "\n";
    if (fit.finding != MapFinding::too_little) {
        text += fmt::format("\non {} of 2.5 motor turns, {} blocks left out in turn\n",
                            how_many(fit.windows, "window"), fit.blocks);
        text += text_table(scores_of(fit), "rrrrrrl");
    }
    if (fit.finding == MapFinding::mapped) {
        text += "\nripple = cosine cos(order motor angle) + sine sin(order motor angle), 95 % intervals\n";
        text += text_table(map_values(fit), "rlrrrrrr");
        text += fmt::format(
            "\nseen: {:.3g} to {:.3g} deg/s, joint at {:.4g} to {:.4g} deg; beyond, the edge "
            "holds\n",
            fit.map.speeds_deg_s.from, fit.map.speeds_deg_s.to, fit.map.positions_deg.from,
            fit.map.positions_deg.to);
    }
    if (!fit.agreement.empty()) {
        text += "\neach log against a map of the others\n";
        text += text_table(agreement_of(fit, logs), "rrrrrll");
    }
    return text;
}

}  // namespace ripplenotch
