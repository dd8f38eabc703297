// SPDX-License-Identifier: MIT
#include "filter/map/map_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {
namespace {

constexpr double worth_it = 1.05, not_worth_it = 0.01;  // of what is left; of the ripple's energy
constexpr double ripple_beyond = 3.0;                   ///< errors of the mean contrast of a block
constexpr double least_gain = 12.0;                     ///< in squares over the noise
constexpr std::size_t most_harmonics = 3;

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

/// What a form gains over another, or over no map: the sum, and how many errors the mean contrast of a
/// block's squares is above nothing. Contrasts count, from -1 to 1, because a few blocks may hold most of the
/// ripple, or what no map can know.
struct Gain {
    double sum = 0.0, beyond = 0.0;
};

Gain gain(const std::vector<double>& before, const std::vector<double>& after) {
    Gain found;
    double mean = 0.0, square = 0.0, blocks = 0.0;
    for (std::size_t b = 0; b < before.size(); ++b) {
        if (!(before[b] > 0.0)) continue;
        const double share = (before[b] - after[b]) / (before[b] + after[b]);
        found.sum += before[b] - after[b];
        mean += share;
        square += share * share;
        blocks += 1.0;
    }
    if (blocks < 3.0) return {found.sum, 0.0};
    mean /= blocks;
    const double variance = std::max(square / blocks - mean * mean, 1e-12) / (blocks - 1.0);
    found.beyond = mean / std::sqrt(variance);
    return found;
}

/// A form and what it leaves.
struct Trial {
    MapForm form;
    std::vector<HeldOut> scores;
    double left = 0.0;  ///< of the orders that have a say
};

std::vector<MapForm> forms_for(const MapData& data, bool tied) {
    std::vector<MapForm> forms;
    const bool loaded = data.loads_nm.to > data.loads_nm.from;
    for (const std::size_t speeds : {1U, 2U, 3U, 5U}) {
        const std::vector<double> knots = spread_speeds(data.speeds_deg_s, speeds);
        if (knots.size() != speeds) continue;
        for (const std::size_t directions : {1U, 2U}) {
            for (std::size_t harmonics = 0; harmonics <= (tied ? most_harmonics : 0); ++harmonics) {
                forms.push_back({knots, directions, harmonics, false});
                if (loaded) forms.push_back({knots, directions, harmonics, true});
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
const Trial& smallest_good(const std::vector<Trial>& trials, double energy) {
    const auto best = std::min_element(trials.begin(), trials.end(),
                                       [](const Trial& a, const Trial& b) { return a.left < b.left; });
    const double enough = worth_it * best->left + not_worth_it * energy;
    return *std::find_if(trials.begin(), trials.end(),
                         [enough](const Trial& trial) { return trial.left <= enough; });
}

std::vector<std::size_t> ripple_of(const std::vector<HeldOut>& scores,
                                   const std::vector<std::size_t>& orders) {
    std::vector<std::size_t> found;
    for (const std::size_t i : orders) {
        const Gain by = gain(scores[i].there, scores[i].left);
        if (by.sum > least_gain && by.beyond > ripple_beyond) found.push_back(i);
    }
    return found;
}

std::vector<std::string> notes_on(const std::vector<Trial>& trials, const Trial& chosen, double there) {
    const auto note = [there](const Trial& trial, std::string_view what) {
        return fmt::format("{}: {} leaves {:.1f} % of the squares on blocks left out", what,
                           map_form_words(trial.form), there > 0.0 ? 100.0 * trial.left / there : 0.0);
    };
    const auto best = std::min_element(trials.begin(), trials.end(),
                                       [](const Trial& a, const Trial& b) { return a.left < b.left; });
    return {note(trials.front(), "the simplest form"),
            note(*best, fmt::format("the best of {} forms", trials.size())), note(chosen, "taken")};
}

}  // namespace

// An order that is no ripple has no say in the form of those that are.
MapChoice choose_map(const MapData& data, bool tied) {
    std::vector<std::size_t> orders(data.orders);
    std::iota(orders.begin(), orders.end(), 0U);
    std::vector<Trial> trials;
    for (const MapForm& form : forms_for(data, tied)) trials.push_back({form, held_out(data, form), 0.0});
    for (;;) {
        for (Trial& trial : trials) trial.left = total(trial.scores, orders, &HeldOut::left);
        const double there = total(trials.front().scores, orders, &HeldOut::there);
        double noise = 0.0;
        for (const std::size_t i : orders) noise += trials.front().scores[i].noise;
        const Trial& chosen = smallest_good(trials, std::max(there - noise, 0.0));
        const std::vector<std::size_t> ripple = ripple_of(chosen.scores, orders);
        if (ripple.empty() || ripple.size() == orders.size())
            return {chosen.form, chosen.scores, ripple, notes_on(trials, chosen, there)};
        orders = ripple;
    }
}

}  // namespace ripplenotch
