// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/map_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "filter/map/map_choice.hpp"
#include "filter/map/map_regression.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double errors_apart = 3.0;       // by hand: three standard errors
constexpr double share_apart = 0.15;       ///< less is no reason to doubt a map
constexpr double ripple_over_noise = 2.0;  ///< squares of an order that an oscillator may follow

// The factor by which the ripple of one log is what a map of the others says, and its error by blocks.
MapAgreement agreement_of(const MapRegression& fit, const std::vector<bool>& of_log, std::size_t log,
                          double order) {
    const Eigen::VectorXcd others = fit.values(of_log);
    std::complex<double> alike = 0.0;
    double expected = 0.0, square = 0.0;
    const auto each_block = [&](const auto& take) {
        for (std::size_t b = 0; b < of_log.size(); ++b)
            if (of_log[b]) take(fit.products(b, others));
    };
    each_block([&](const auto& block) {
        alike += block.first;
        expected += block.second;
    });
    MapAgreement found{log, order};
    if (!(expected > 0.0)) return found;
    const std::complex<double> factor = alike / expected;
    each_block([&](const auto& block) { square += 0.5 * std::norm(block.first - factor * block.second); });
    // Not below what noise alone makes of each part.
    const double error = std::sqrt(1.0 / expected + square / (expected * expected));
    const double size = portable::hypot(factor.real(), factor.imag());
    found.amplitude_ratio = size;
    found.amplitude_error = error;
    // z = A exp(-i phase): a phase that is ahead turns z backward.
    found.phase_deg = -portable::arg(factor) * degrees_per_radian;
    found.phase_error_deg = size > error ? portable::asin(error / size) * degrees_per_radian : 180.0;
    const double apart = portable::hypot(factor.real() - 1.0, factor.imag());
    found.agrees = apart <= std::max(errors_apart * std::numbers::sqrt2 * error, share_apart);
    return found;
}

void hold_logs_together(const MapData& data, const MapForm& form, std::size_t logs, MapFit& fit) {
    for (std::size_t l = 0; logs > 1 && l < logs; ++l) {
        std::vector<bool> of_log(data.blocks);
        for (const MapWindow& window : data.windows) of_log[window.block] = window.log == l;
        if (std::adjacent_find(of_log.begin(), of_log.end(), std::not_equal_to<>()) == of_log.end()) continue;
        for (std::size_t i = 0; i < fit.scores.size(); ++i) {
            if (!fit.scores[i].in_map) continue;
            fit.agreement.push_back(
                agreement_of(MapRegression(data, form, i), of_log, l, fit.scores[i].order));
        }
    }
}

// An order whose ripple is there and follows no form stays in the map with no amplitude, for who follows it.
void fill_map(const MapData& data, const MapForm& form, MapFit& fit) {
    fit.map = data.frame;
    fit.map.form = form;
    fit.map.orders.clear();
    for (std::size_t i = 0; i < fit.scores.size(); ++i) {
        const MapOrderScore& score = fit.scores[i];
        const double noise = score.noise_nm * score.noise_nm;
        const double all = score.ripple_nm * score.ripple_nm;
        if (!score.in_map && all < ripple_over_noise * noise) continue;
        const double left = score.in_map ? score.left_nm * score.left_nm : all;
        const MapRegression regression(data, form, i);
        fit.map.orders.push_back(data.frame.orders[i]);
        fit.map.spread_nm.push_back(std::sqrt(std::max(left - noise, 0.01 * left)));
        fit.errors.push_back(regression.errors());
        const Eigen::VectorXcd values = regression.values();
        fit.map.values.emplace_back(values.begin(), values.end());
        if (!score.in_map) fit.map.values.back().assign(form.columns(), 0.0);
    }
}

double decibels_down(double from_nm, double to_nm) {
    return to_nm > 0.0 && from_nm > 0.0 ? 20.0 * portable::log10(from_nm / to_nm) : 0.0;
}

// What `words` has of each, but for those of which it has nothing.
template <typename Each, typename Words>
std::string listed(const std::vector<Each>& all, const Words& words) {
    std::string text;
    for (const Each& one : all)
        if (const std::string part = words(one); !part.empty()) text += (text.empty() ? "" : ", ") + part;
    return text;
}

std::string orders_of(const std::vector<MapOrderScore>& scores) {
    return (scores.size() == 1 ? "order " : "orders ") +
           listed(scores, [](const MapOrderScore& score) { return shortest(score.order); });
}

std::string disagreement(const MapAgreement& one) {
    if (one.agrees) return "";
    return fmt::format("in log {} order {} is {:.2f} times as large and {:.0f} deg ahead", one.log + 1,
                       shortest(one.order), one.amplitude_ratio, std::round(one.phase_deg) + 0.0);
}

std::string mapped_order(const MapOrderScore& score) {
    if (!score.in_map) return "";
    return fmt::format("order {} falls from {:.3g} to {:.3g} Nm ({:.1f} dB; noise limit {:.1f} dB)",
                       shortest(score.order), score.ripple_nm, score.left_nm,
                       decibels_down(score.ripple_nm, score.left_nm),
                       decibels_down(score.ripple_nm, score.noise_nm));
}

std::string bound_of(const MapOrderScore& score) {
    if (score.in_map || !std::isfinite(score.detectable_nm) || !(score.detectable_nm > 0.0)) return "";
    return fmt::format("{:.2g} Nm of order {}", score.detectable_nm, shortest(score.order));
}

}  // namespace

MapFit fit_ripple_map(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg,
                      std::span<const std::vector<double>> temperatures_degc) {
    if (logs.empty()) raise<UsageError>("a map needs a log");
    MapFit fit;
    fit.anchored =
        std::all_of(logs.begin(), logs.end(), [](const TraceView& log) { return log.has_position(); });
    if (!fit.anchored && logs.size() > 1) {
        raise<DataError>(
            "a log without a position of the joint has no angle that another log shares; map it alone");
    }
    const MapData data = map_data(logs, gear, zero_deg, temperatures_degc);
    fit.windows = data.windows.size();
    fit.blocks = data.blocks;
    fit.map.gear_ratio = gear.ratio;
    fit.map.zero_deg = zero_deg;
    if (fit.windows < fewest_map_windows || gear.orders.empty()) {
        for (const Order order : gear.orders) fit.scores.push_back({order.value()});
        return fit;
    }
    choose_map(data, fit);
    const MapForm form = fit.map.form;
    if (fit.finding == MapFinding::mapped) fill_map(data, form, fit);
    hold_logs_together(data, form, logs.size(), fit);
    const bool agree = std::all_of(fit.agreement.begin(), fit.agreement.end(),
                                   [](const MapAgreement& one) { return one.agrees; });
    fit.conclusive = fit.anchored && fit.finding != MapFinding::unclear && agree;
    return fit;
}

std::string_view map_finding_name(MapFinding finding) {
    constexpr std::array<std::string_view, 4> names = {"mapped", "nothing", "unclear", "too-little"};
    return names[static_cast<std::size_t>(finding)];
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
    std::vector<std::string> sentences = {fit.doubt};
    const std::string ratio = fmt::format("{} at gear ratio {:.6g} in {} windows", orders_of(fit.scores),
                                          fit.map.gear_ratio.value(), fit.windows);
    if (fit.finding == MapFinding::too_little) {
        sentences.push_back(
            fmt::format("Cannot tell: the motor turns 2.5 times in one direction in {} windows, and {} are "
                        "needed to leave "
                        "some out; the map is empty.",
                        fit.windows, fewest_map_windows));
    } else if (fit.finding == MapFinding::nothing) {
        sentences.push_back(fmt::format("No ripple found of {}: the map is empty.", ratio));
    } else if (fit.finding == MapFinding::unclear) {
        sentences.push_back(
            fmt::format("Cannot tell: no regular ripple found of {}, but amplitudes above the noise, or no "
                        "bound; the map is "
                        "empty.",
                        ratio));
    } else {
        sentences.push_back(fmt::format("Cross-validated: {}; amplitudes {}.",
                                        listed(fit.scores, mapped_order), map_form_words(fit.map.form)));
    }
    if (const std::string bounds = listed(fit.scores, bound_of); !bounds.empty())
        sentences.push_back(fmt::format("An amplitude of {} would have been found.", bounds));
    if (!fit.anchored && fit.finding == MapFinding::mapped)
        sentences.emplace_back("The log has no position: phases count from its first row.");
    if (const std::string apart = listed(fit.agreement, disagreement); !apart.empty())
        sentences.push_back(fmt::format("The logs disagree: {}.", apart));
    if (fit.doubt.empty()) sentences.erase(sentences.begin());
    return fmt::format("{}", fmt::join(sentences, " "));
}

}  // namespace ripplenotch
