// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/map_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <span>

#include "analysis/track/window_fit.hpp"
#include "core/vectors/dot.hpp"
#include "filter/map/map_regression.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

namespace {

// Parts that are left out in turn. More of them make the rotation test stronger and cost their square: on the
// six joints of a robot, 32 find the map of a joint that carries the arm's weight and 16 do not.
constexpr std::size_t most_blocks = 32;
constexpr std::size_t least_block = 3;  ///< windows, of which the middle one shares none of its samples

RippleOrders counted_orders(const GearAccount& gear) {
    RippleOrders stated{gear.ratio.value(), {}};
    for (const Order order : gear.orders) stated.orders.push_back(order.value());
    return gear.orders.empty() ? stated : stated.by_lowest();
}

// Windows in periods of the lowest order: an amplitude that depends on speed hardly changes in one.
constexpr double window_turns = 2.5, fewest_window_turns = 2.0;
constexpr double longest_window_s = 2.5;  // a cubic follows the torque no longer
constexpr double samples_a_period = 3.0;  // of the highest order
constexpr double beside_turns = 0.5;      // to both sides of an order, where no ripple is
constexpr double clear_of_others = 0.35;  // nearer to another order its ripple counts as noise

// The rows of a log between two reversals in windows, each with a cubic and all orders fitted at once, the
// middle counting most. The angle is that of a position, counted from the map's zero.
void add_windows(const TraceView& log, std::size_t number, MapData& data) {
    const RippleOrders& counted = data.counted;
    const double ratio = counted.gear_ratio, deg_a_turn = 360.0 / ratio,
                 zero = data.frame.zero_deg / deg_a_turn;
    std::vector<double> all_turns = output_angle(log).turns;
    for (double& turns : all_turns) turns = turns * ratio - zero;
    const double highest = *std::max_element(counted.orders.begin(), counted.orders.end());
    for (const SampleRun& run : directed_runs(smoothed_speed(log), log.run_starts, {})) {
        for (const SampleRun& rows : cut_windows(run, all_turns, window_turns, fewest_window_turns, 0.5)) {
            const auto turns = std::span(all_turns).subspan(rows.first, rows.size());
            const double turned = turns.back() - turns.front(), size = std::abs(turned);
            const double seconds = log.time_s[rows.end - 1] - log.time_s[rows.first];
            if (seconds > longest_window_s ||
                !(static_cast<double>(rows.size()) > samples_a_period * highest * size))
                continue;
            std::vector<double> root_weight;
            double squares = 0.0, sum = 0.0;
            for (const double at : turns) {
                const double along = std::clamp((at - turns.front()) / turned, 0.0, 1.0);
                const double weight = portable::sin(std::numbers::pi * along);
                root_weight.push_back(std::sqrt(weight));
                squares += weight * weight;
                sum += weight * at;
            }
            std::vector<TrackedLine> lines;
            for (const double order : counted.orders) lines.push_back({order, turns});
            WindowFit fit(turns, root_weight, 0.0, lines, 0, WindowFit::Trend::polynomials);
            if (!fit.has_enough_samples()) continue;
            fit.factorise();
            const WindowFit::Torque torque = fit.fit(log.torque_nm.subspan(rows.first, rows.size()));
            MapWindow& window = data.windows.emplace_back();
            window.log = number;
            window.rows = rows;
            window.state = {deg_a_turn * turned / seconds, deg_a_turn * (sum / fit.weight() + zero)};
            const auto samples = static_cast<double>(rows.size());
            const double variance = dot(torque.residual.data(), torque.residual.data(), rows.size()) /
                                    fit.weight() * samples / (samples - static_cast<double>(fit.unknowns()));
            const double of_fit = 4.0 * variance * squares / (fit.weight() * fit.weight());
            for (std::size_t i = 0; i < lines.size(); ++i) {
                double near = 0.0, places = 0.0;
                for (const double aside : {-beside_turns, beside_turns}) {
                    const double power =
                        fit.power_beside(torque, {lines[i].order + aside, turns}, clear_of_others * size);
                    if (std::isnan(power)) continue;
                    near += power;
                    places += 1.0;
                }
                window.value.push_back(std::conj(fit.amplitude(torque, i)));
                window.noise.push_back(std::max(places > 0.0 ? near / places : 0.0, of_fit));
            }
        }
    }
}

template <typename Value>
MapRange range_seen(const std::vector<MapWindow>& windows, const Value& value) {
    if (windows.empty()) return {};
    MapRange range{value(windows.front().state), value(windows.front().state)};
    for (const MapWindow& window : windows)
        range = {std::min(range.from, value(window.state)), std::max(range.to, value(window.state))};
    return range;
}

// Blocks of a log are alike in size. Windows half overlap: those at the ends of a block may share samples
// with the next one.
void number_blocks(MapData& data) {
    std::vector<MapWindow>& windows = data.windows;
    const std::size_t size = std::max(least_block, (windows.size() + most_blocks - 1) / most_blocks);
    for (std::size_t from = 0, to = 0; from < windows.size(); from = to) {
        while (to < windows.size() && windows[to].log == windows[from].log) ++to;
        const std::size_t count = to - from, blocks = (count + size - 1) / size;
        for (std::size_t i = from; i < to; ++i) windows[i].block = data.blocks + (i - from) * blocks / count;
        data.blocks += blocks;
    }
    for (std::size_t i = 1; i < windows.size(); ++i) {
        MapWindow &before = windows[i - 1], &after = windows[i];
        if (after.log == before.log && after.block != before.block && after.rows.first < before.rows.end)
            before.scored = after.scored = false;
    }
}

}  // namespace

MapData map_data(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg) {
    MapData data;
    data.counted = counted_orders(gear);
    data.frame.gear_ratio = gear.ratio;
    data.frame.orders = gear.orders;
    data.frame.zero_deg = zero_deg;
    for (std::size_t l = 0; l < logs.size() && !gear.orders.empty(); ++l) add_windows(logs[l], l, data);
    data.frame.speeds_deg_s =
        range_seen(data.windows, [](const MapState& at) { return std::abs(at.speed_deg_s); });
    data.frame.positions_deg = range_seen(data.windows, [](const MapState& at) { return at.position_deg; });
    number_blocks(data);
    return data;
}

namespace {

constexpr double errors_apart = 3.0;       // chosen, not derived: three standard errors
constexpr double share_apart = 0.15;       ///< a smaller difference is no reason against a map
constexpr double ripple_over_noise = 2.0;  ///< squares of an order that an oscillator may follow

// The factor between the ripple of one log and its prediction by a map of the others, and its error by
// blocks.
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
    // Not below the error of each part from noise alone.
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

std::string scored_orders(const MapFit& fit) {
    std::vector<Order> orders;
    for (const MapOrderScore& score : fit.scores) orders.emplace_back(score.order);
    const GearRatio ratio = fit.map.gear_ratio;
    return (orders.size() == 1 ? "order " : "orders ") + orders_text(orders, ratio, ", ") +
           (ratio == no_ratio ? " of the joint" : fmt::format(" at gear ratio {:.6g}", ratio.value()));
}

// The sentences about the orders of a map of this ratio.
struct OrderWords {
    GearRatio ratio;

    [[nodiscard]] std::string name(double order) const { return order_in_words(Order(order), ratio); }
    [[nodiscard]] std::string disagreement(const MapAgreement& one) const {
        if (one.agrees) return "";
        return fmt::format("in log {} {} is {:.2f} times as large and {:.0f} deg ahead", one.log + 1,
                           name(one.order), one.amplitude_ratio, std::round(one.phase_deg) + 0.0);
    }
    [[nodiscard]] std::string mapped(const MapOrderScore& score) const {
        if (!score.in_map) return "";
        return fmt::format("{} falls from {:.3g} to {:.3g} Nm ({:.1f} dB; noise limit {:.1f} dB)",
                           name(score.order), score.ripple_nm, score.left_nm,
                           decibels_down(score.ripple_nm, score.left_nm),
                           decibels_down(score.ripple_nm, score.noise_nm));
    }
    [[nodiscard]] std::string bound(const MapOrderScore& score) const {
        if (score.in_map || !std::isfinite(score.detectable_nm) || !(score.detectable_nm > 0.0)) return "";
        return fmt::format("{:.2g} Nm of {}", score.detectable_nm, name(score.order));
    }
    /// One of the sentences of all orders, with commas or full stops between them.
    template <class Entries, class Sentence>
    [[nodiscard]] std::string of_all(const Entries& entries, Sentence sentence,
                                     std::string_view between = ", ") const {
        return joined(entries, between, [&](const auto& one) { return (this->*sentence)(one); });
    }
};

}  // namespace

MapFit fit_ripple_map(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg,
                      double false_alarm) {
    if (logs.empty()) raise<UsageError>("a map needs a log");
    MapFit fit;
    fit.anchored =
        std::all_of(logs.begin(), logs.end(), [](const TraceView& log) { return log.has_position(); });
    if (!fit.anchored && logs.size() > 1) {
        raise<DataError>(
            "a log without a position of the joint has no angle that another log shares; map it alone");
    }
    const MapData data = map_data(logs, gear, zero_deg);
    fit.windows = data.windows.size();
    fit.blocks = data.blocks;
    fit.map.gear_ratio = gear.ratio;
    fit.map.zero_deg = zero_deg;
    if (fit.windows < fewest_map_windows || gear.orders.empty()) {
        for (const Order order : gear.orders) fit.scores.push_back({order.value()});
        return fit;
    }
    choose_map(data, false_alarm, fit);
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
    if (text.empty()) text = "the same at every speed";
    if (form.second_comb != 0)
        text += fmt::format(", with the second comb at n (Kg {} 1)", form.second_comb > 0 ? '+' : '-');
    return text;
}

std::string map_column_words(const MapForm& form, std::size_t column) {
    const std::size_t each = form.columns_a_direction(), within = column % each;
    const std::size_t speeds = form.speeds_deg_s.size();
    std::string what =
        speeds > 1 ? fmt::format("{:.4g} deg/s", form.speeds_deg_s[within % speeds]) : "any speed";
    if (within >= speeds) what += ", second comb";
    if (form.directions == 1) return what;
    return (column < each ? "forward, " : "backward, ") + what;
}

namespace {

std::string other_in_words(const MapFit& other) {
    if (other.finding != MapFinding::mapped) return "";
    if (!other.doubt.empty()) return other.doubt;
    std::vector<MapOrderScore> found = other.scores;
    std::erase_if(found, [](const MapOrderScore& score) { return !score.in_map; });
    return fmt::format("The torque also holds ripple of the motor of {}: {}.", other.map.joint,
                       OrderWords{other.map.gear_ratio}.of_all(found, &OrderWords::mapped));
}

}  // namespace

std::string map_verdict(const MapFit& fit) {
    std::vector<std::string> sentences = {fit.doubt};
    const OrderWords words{fit.map.gear_ratio};
    const std::string searched = fmt::format("{} in {} windows", scored_orders(fit), fit.windows);
    if (fit.finding == MapFinding::too_little) {
        sentences.push_back(fmt::format(
            "Cannot tell: the motion holds 2.5 periods of the lowest order in one direction in {} "
            "windows, and {} are needed to leave some out; the map is empty.",
            fit.windows, fewest_map_windows));
    } else if (fit.finding == MapFinding::nothing) {
        sentences.push_back(fmt::format("No ripple found of {}: the map is empty.", searched));
    } else if (fit.finding == MapFinding::unclear) {
        sentences.push_back(
            fmt::format("Cannot tell: no regular ripple found of {}, but amplitudes above the noise, or no "
                        "bound; the map is "
                        "empty.",
                        searched));
    } else {
        sentences.push_back(fmt::format("Cross-validated: {}. Amplitudes {}.",
                                        words.of_all(fit.scores, &OrderWords::mapped, ". Then "),
                                        map_form_words(fit.map.form)));
    }
    if (const std::string bounds = words.of_all(fit.scores, &OrderWords::bound); !bounds.empty())
        sentences.push_back(fmt::format("An amplitude of {} would have been found.", bounds));
    for (const MapFit& other : fit.others)
        if (const std::string found = other_in_words(other); !found.empty()) sentences.push_back(found);
    if (!fit.anchored && fit.finding == MapFinding::mapped)
        sentences.emplace_back("The log has no position: phases count from its first row.");
    if (const std::string apart = words.of_all(fit.agreement, &OrderWords::disagreement); !apart.empty())
        sentences.push_back(fmt::format("The logs disagree: {}.", apart));
    if (fit.doubt.empty()) sentences.erase(sentences.begin());
    return fmt::format("{}", fmt::join(sentences, " "));
}

}  // namespace ripplenotch
