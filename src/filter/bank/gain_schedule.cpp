// SPDX-License-Identifier: MIT
#include "filter/bank/gain_schedule.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// From a motor turn in 30 000 samples, where the ripple's gain is next to nothing, to half a turn a sample of
// the lowest order.
constexpr double slowest_turns = 0x1p-15;
constexpr int points_an_octave = 8;  ///< evenly from an octave's beginning to twice it

// Orders beyond half the sample rate are not looked at and have no gain.
std::vector<double> gain_of(const RippleModel& model, double step_turns) {
    RippleModel seen = model;
    std::erase_if(seen.orders, [&](double order) { return model.share(order, step_turns) == 0.0; });
    const bool turns = !seen.orders.empty() && step_turns > 0.0;
    if (!turns) seen.orders.clear();
    auto found = settled_gain(seen, turns ? step_turns : 1.0);
    std::vector<double> gain(model.states());
    if (found.empty()) return gain;
    std::copy_n(found.begin(), 2, gain.begin());
    for (std::size_t i = 0, from = 2; i < model.orders.size() && from < found.size(); ++i) {
        if (model.share(model.orders[i], step_turns) == 0.0) continue;
        gain[2 + 2 * i] = found[from];
        gain[3 + 2 * i] = found[from + 1];
        from += 2;
    }
    return gain;
}

int last_point(const RippleModel& model) {
    const double lowest = *std::min_element(model.orders.begin(), model.orders.end());
    const auto octaves =
        static_cast<int>(std::ceil(std::max(portable::log2(0.5 / lowest / slowest_turns), 1.0)));
    return octaves * points_an_octave;
}

std::vector<double> gain_at_point(const RippleModel& model, int point) {
    const double within = 1.0 + static_cast<double>(point % points_an_octave) / points_an_octave;
    return gain_of(model, slowest_turns * std::ldexp(within, point / points_an_octave));
}

// Between which points a speed lies; before the first one there is standstill.
struct Place {
    std::optional<std::size_t> before;
    std::size_t after;
    double share;
};

Place place_of(double step_turns, std::size_t last) noexcept {
    const double share = std::abs(step_turns) / slowest_turns;
    if (!(share >= 1.0)) return {std::nullopt, 0, share};
    // The number's own exponent is its octave, its mantissa the place in it.
    const auto bits = std::bit_cast<std::uint64_t>(share);
    const auto octave = static_cast<std::size_t>((bits >> 52U) - 1023U);
    const double within = (share / std::bit_cast<double>(bits & (0x7ffULL << 52U)) - 1.0) * points_an_octave;
    const auto point = static_cast<std::size_t>(within);
    const std::size_t at = octave * points_an_octave + point;
    const std::size_t before = std::min(at, last - 1);
    return {before, before + 1, at < last ? within - static_cast<double>(point) : 1.0};
}

void between(const double* before, const double* after, const Place& place, double step_turns,
             std::span<double> gain) noexcept {
    for (std::size_t i = 0; i < gain.size(); ++i) gain[i] = before[i] + place.share * (after[i] - before[i]);
    if (step_turns < 0.0) {
        for (std::size_t i = 3; i < gain.size(); i += 2) gain[i] = -gain[i];
    }
}

}  // namespace

GainSchedule::GainSchedule(const RippleModel& model)
    : states_(model.states()), standing_(gain_of(model, 0.0)) {
    for (int i = 0; i <= last_point(model); ++i) {
        const auto gain = gain_at_point(model, i);
        gains_.insert(gains_.end(), gain.begin(), gain.end());
    }
}

void GainSchedule::at(double step_turns, std::span<double> gain) const noexcept {
    const Place place = place_of(step_turns, gains_.size() / states_ - 1);
    between(place.before ? gains_.data() + *place.before * states_ : standing_.data(),
            gains_.data() + place.after * states_, place, step_turns, gain.first(states_));
}

std::vector<double> scheduled_gain(const RippleModel& model, double step_turns) {
    const Place place = place_of(step_turns, static_cast<std::size_t>(last_point(model)));
    const auto before =
        place.before ? gain_at_point(model, static_cast<int>(*place.before)) : gain_of(model, 0.0);
    const auto after = gain_at_point(model, static_cast<int>(place.after));
    std::vector<double> gain(model.states());
    between(before.data(), after.data(), place, step_turns, gain);
    return gain;
}

}  // namespace ripplenotch
