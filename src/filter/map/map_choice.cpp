// SPDX-License-Identifier: MIT
#include "filter/map/map_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "ripplenotch/core/phasor.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {
namespace {

constexpr double keep_factor = 1.05, keep_share = 0.01;           // of what is left; of the ripple's energy
constexpr double spreads_beyond = 3.0, spreads_beyond_too = 2.0;  // of logs without: one order, others
constexpr double least_gain = 12.0;                               ///< in squares over the noise
constexpr double least_warming_degc = 1.0;  ///< less tells nothing of what a degree does
constexpr int surrogates = 40;              // by hand: a mean to 16 % of its scatter
constexpr std::size_t most_harmonics = 3;   // by hand

std::vector<double> spread_speeds(const MapRange& range, std::size_t count) {
    if (count == 1 || !(range.to > range.from)) return {range.middle()};
    std::vector<double> speeds;
    for (std::size_t k = 0; k < count; ++k) {
        speeds.push_back(range.from +
                         (range.to - range.from) * static_cast<double>(k) / static_cast<double>(count - 1));
    }
    return speeds;
}

std::vector<HeldOut> held_out(const MapData& data, const MapForm& form) {
    const RippleMap frame = frame_of(data, form, 0.0);
    std::vector<HeldOut> scores;
    for (std::size_t i = 0; i < data.orders; ++i) scores.push_back(MapRegression(data, frame, i).held_out());
    return scores;
}

// What the map takes off the blocks left out, in squares over the noise.
double gain(const HeldOut& score) {
    return std::accumulate(score.there.begin(), score.there.end(), 0.0) -
           std::accumulate(score.left.begin(), score.left.end(), 0.0);
}

// The same log if nothing turned with the motor: each block's amplitudes from an angle of its own.
void turn_blocks(MapData& data, std::mt19937_64& engine) {
    std::vector<std::complex<double>> by_block;
    for (std::size_t b = 0; b < data.blocks; ++b) {
        const double share = static_cast<double>(engine() >> 11U) * 0x1p-53;
        by_block.push_back(portable::phasor(2.0 * std::numbers::pi * share));
    }
    for (MapWindow& window : data.windows)
        for (std::complex<double>& value : window.value) value *= by_block[window.block];
}

/// A form and what it leaves.
struct MapTrial {
    MapForm form;
    std::vector<HeldOut> scores;
    double left = 0.0;  ///< of the orders that have a say
};

std::vector<MapForm> forms_for(const MapData& data, bool tied) {
    std::vector<MapForm> forms;
    const bool loaded = data.loads_nm.to > data.loads_nm.from;
    const bool warms = data.temperatures_degc.to - data.temperatures_degc.from > least_warming_degc;
    for (const std::size_t speeds : {1U, 2U, 3U, 5U}) {
        const std::vector<double> knots = spread_speeds(data.speeds_deg_s, speeds);
        if (knots.size() != speeds) continue;
        for (const std::size_t directions : {1U, 2U}) {
            for (std::size_t harmonics = 0; harmonics <= (tied ? most_harmonics : 0); ++harmonics) {
                for (const bool by_load : {false, true}) {
                    if (by_load && !loaded) continue;
                    forms.push_back({knots, directions, harmonics, by_load});
                    if (warms) forms.push_back({knots, directions, harmonics, by_load, true});
                }
            }
        }
    }
    std::stable_sort(forms.begin(), forms.end(),
                     [](const MapForm& a, const MapForm& b) { return a.columns() < b.columns(); });
    return forms;
}

double total(const std::vector<HeldOut>& scores, const std::vector<std::size_t>& orders,
             std::vector<double> HeldOut::*member) {
    double sum = 0.0;
    for (const std::size_t i : orders)
        sum = std::accumulate((scores[i].*member).begin(), (scores[i].*member).end(), sum);
    return sum;
}

// The smallest form that leaves next to nothing more than the best one.
const MapTrial& smallest_good(const std::vector<MapTrial>& trials, double energy) {
    const auto best = std::min_element(trials.begin(), trials.end(),
                                       [](const MapTrial& a, const MapTrial& b) { return a.left < b.left; });
    const double enough = keep_factor * best->left + keep_share * energy;
    return *std::find_if(trials.begin(), trials.end(),
                         [enough](const MapTrial& trial) { return trial.left <= enough; });
}

// By how many of its own deviations each order's gain is beyond that of logs without ripple under the same
// form.
std::vector<double> beyond_chance(const MapData& data, const MapTrial& trial) {
    std::vector<double> sum(data.orders), squares(data.orders), beyond;
    std::mt19937_64 engine(20);
    const RippleMap frame = frame_of(data, trial.form, 0.0);
    for (int k = 0; k < surrogates; ++k) {
        MapData turned = data;
        turn_blocks(turned, engine);
        for (std::size_t i = 0; i < data.orders; ++i) {
            const double one = gain(MapRegression(turned, frame, i).held_out());
            sum[i] += one;
            squares[i] += one * one;
        }
    }
    for (std::size_t i = 0; i < data.orders; ++i) {
        const double mean = sum[i] / surrogates, own = gain(trial.scores[i]);
        const double spread = std::sqrt(std::max(squares[i] / surrogates - mean * mean, 1e-12));
        beyond.push_back(own > least_gain ? (own - mean) / spread : 0.0);
    }
    return beyond;
}

std::vector<std::string> notes_on(const std::vector<MapTrial>& trials, const MapTrial& chosen, double there) {
    const auto note = [there](const MapTrial& trial, std::string_view what) {
        return fmt::format("{}: {} leaves {:.1f} % of the squares on blocks left out", what,
                           map_form_words(trial.form), there > 0.0 ? 100.0 * trial.left / there : 0.0);
    };
    const auto best = std::min_element(trials.begin(), trials.end(),
                                       [](const MapTrial& a, const MapTrial& b) { return a.left < b.left; });
    return {note(trials.front(), "the simplest form"),
            note(*best, fmt::format("the best of {} forms", trials.size())), note(chosen, "taken")};
}

}  // namespace

// An order that is no ripple has no say in the form of those that are.
MapChoice choose_map(const MapData& data, bool tied) {
    std::vector<std::size_t> orders(data.orders);
    std::iota(orders.begin(), orders.end(), 0U);
    std::vector<MapTrial> trials;
    for (const MapForm& form : forms_for(data, tied)) trials.push_back({form, held_out(data, form), 0.0});
    for (;;) {
        for (MapTrial& trial : trials) trial.left = total(trial.scores, orders, &HeldOut::left);
        const double there = total(trials.front().scores, orders, &HeldOut::there);
        double noise = 0.0;
        for (const std::size_t i : orders) noise += trials.front().scores[i].noise;
        const MapTrial& chosen = smallest_good(trials, std::max(there - noise, 0.0));
        const std::vector<double> beyond = beyond_chance(data, chosen);
        std::vector<std::size_t> ripple;
        const bool any = std::any_of(orders.begin(), orders.end(),
                                     [&](std::size_t i) { return beyond[i] > spreads_beyond; });
        for (const std::size_t i : orders)
            if (any && beyond[i] > spreads_beyond_too) ripple.push_back(i);
        if (ripple.empty() || ripple.size() == orders.size())
            return {chosen.form, chosen.scores, ripple, beyond, notes_on(trials, chosen, there)};
        orders = ripple;
    }
}

}  // namespace ripplenotch
