// SPDX-License-Identifier: MIT
// A fitted map in words.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {
namespace {

double decibels_down(double from_nm, double to_nm) {
    return to_nm > 0.0 && from_nm > 0.0 ? 20.0 * portable::log10(from_nm / to_nm) : 0.0;
}

std::string orders_of(const std::vector<MapOrderScore>& scores) {
    std::string text;
    for (const MapOrderScore& score : scores) text += (text.empty() ? "" : ", ") + shortest(score.order);
    return (scores.size() == 1 ? "order " : "orders ") + text;
}

std::string disagreements(const MapFit& fit) {
    std::string text;
    for (const MapAgreement& one : fit.agreement) {
        if (one.agrees) continue;
        text += fmt::format("{}in log {} order {} is {:.2f} times as large and {:.0f} deg ahead",
                            text.empty() ? "" : ", ", one.log + 1, shortest(one.order), one.amplitude_ratio,
                            std::round(one.phase_deg) + 0.0);
    }
    return text;
}

std::string mapped_sentence(const MapFit& fit) {
    std::string text = "Cross-validated:";
    bool first = true;
    for (const MapOrderScore& score : fit.scores) {
        if (!score.in_map) continue;
        text += fmt::format("{} order {} falls from {:.3g} to {:.3g} Nm ({:.1f} dB; noise limit {:.1f} dB)",
                            first ? "" : ",", shortest(score.order), score.ripple_nm, score.left_nm,
                            decibels_down(score.ripple_nm, score.left_nm),
                            decibels_down(score.ripple_nm, score.noise_nm));
        first = false;
    }
    return text + fmt::format("; amplitudes {}.", map_form_words(fit.map.form));
}

std::string detectable_sentence(const MapFit& fit) {
    std::string text;
    for (const MapOrderScore& score : fit.scores) {
        if (score.in_map || !std::isfinite(score.detectable_nm) || !(score.detectable_nm > 0.0)) continue;
        text += fmt::format("{}{:.2g} Nm of order {}", text.empty() ? "" : ", ", score.detectable_nm,
                            shortest(score.order));
    }
    return text.empty() ? text : fmt::format("An amplitude of {} would have been found.", text);
}

}  // namespace

std::string_view map_finding_name(MapFinding finding) {
    switch (finding) {
        case MapFinding::mapped:
            return "mapped";
        case MapFinding::nothing:
            return "nothing";
        case MapFinding::unclear:
            return "unclear";
        case MapFinding::too_little:
            return "too-little";
    }
    return "";
}

std::string map_form_words(const MapForm& form) {
    const bool by_speed = form.speeds_deg_s.size() > 1, by_direction = form.directions > 1;
    std::string text = by_speed ? fmt::format("by speed ({} of them)", form.speeds_deg_s.size()) : "";
    if (by_direction) text += by_speed ? " and direction" : "by direction";
    if (text.empty()) text = "alike at every speed";
    if (form.second_comb != 0)
        text += fmt::format(", with the second comb at n (Kg {} 1)", form.second_comb > 0 ? '+' : '-');
    if (form.turn_harmonics > 0)
        text += fmt::format(", with {} harmonic{} of the joint's turn", form.turn_harmonics,
                            form.turn_harmonics == 1 ? "" : "s");
    if (form.by_load) text += ", and by load";
    return text + (form.by_temperature ? ", and by temperature" : "");
}

std::string map_column_words(const MapForm& form, std::size_t column) {
    const std::size_t each = form.columns_a_direction(), within = column % each;
    const std::size_t speeds = form.speeds_deg_s.size();
    std::string what;
    if (within < form.speed_columns()) {
        what = speeds > 1 ? fmt::format("{:.4g} deg/s", form.speeds_deg_s[within % speeds]) : "any speed";
        if (within >= speeds) what += ", second comb";
    } else if (within < form.load_column()) {
        const std::size_t at = within - form.speed_columns();
        what = fmt::format("{} of {} joint angle{}", at % 2 == 0 ? "cosine" : "sine", at / 2 + 1,
                           at / 2 == 0 ? "" : "s");
    } else {
        what = form.by_load && within == form.load_column() ? "per Nm of load" : "per degC beyond the middle";
    }
    if (form.directions == 1) return what;
    return (column < each ? "forward, " : "backward, ") + what;
}

std::string map_verdict(const MapFit& fit) {
    std::string text = fit.doubt;
    const auto add = [&text](const std::string& sentence) { text += (text.empty() ? "" : " ") + sentence; };
    switch (fit.finding) {
        case MapFinding::too_little:
            add(fmt::format(
                "Cannot tell: the motor turns 2.5 times in one direction in {} windows, and {} are "
                "needed to leave some out; the map is empty.",
                fit.windows, fewest_map_windows));
            break;
        case MapFinding::nothing:
            add(fmt::format("No ripple found of {} at gear ratio {:.6g} in {} windows: the map is empty.",
                            orders_of(fit.scores), fit.map.gear_ratio.value(), fit.windows));
            add(detectable_sentence(fit));
            break;
        case MapFinding::unclear:
            add(fmt::format(
                "Cannot tell: no regular ripple found of {} at gear ratio {:.6g} in {} windows, but "
                "amplitudes above the noise, or no bound; the map is empty.",
                orders_of(fit.scores), fit.map.gear_ratio.value(), fit.windows));
            add(detectable_sentence(fit));
            break;
        case MapFinding::mapped:
            add(mapped_sentence(fit));
            if (const std::string bound = detectable_sentence(fit); !bound.empty()) add(bound);
            break;
    }
    if (!fit.anchored && fit.finding == MapFinding::mapped)
        add("The log has no position: phases count from its first row.");
    if (const std::string apart = disagreements(fit); !apart.empty())
        add(fmt::format("The logs disagree: {}.", apart));
    return text;
}

}  // namespace ripplenotch
