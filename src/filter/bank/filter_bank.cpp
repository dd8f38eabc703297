// SPDX-License-Identifier: MIT
#include "filter/bank/filter_bank.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "filter/kernels/bank_sections.hpp"
#include "filter/kernels/block_sections.hpp"
#include "filter/run/engine.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

Candidates::Candidates(std::span<const Band> bands) {
    for (const Band& band : bands) {
        cascades.push_back(band.cascade());
        sections = std::max(sections, cascades.back().size());
    }
    for (Cascade& cascade : cascades) cascade.resize(sections);  // a default Biquad is neutral
    for (const Cascade& cascade : cascades) {
        const auto first = std::find(cascades.begin(), cascades.end(), cascade);
        same_as.push_back(static_cast<int>(first - cascades.begin()));
    }
}

bool Candidates::same(int a, int b) const noexcept {
    if (a == b) return true;
    if (a == no_candidate || b == no_candidate) return false;
    return same_as[static_cast<std::size_t>(a)] == same_as[static_cast<std::size_t>(b)];
}

CascadeFilter::CascadeFilter(Cascade cascade) : cascade_(std::move(cascade)), states_(cascade_.size()) {}

std::string CascadeFilter::hurry() {
    if (!block_form_serves(cascade_)) {
        return fmt::format(
            "sample by sample: in blocks of eight the output could differ by more than {} of the largest "
            "torque",
            most_block_difference);
    }
    blocks_.emplace(cascade_);
    return fmt::format(
        "in blocks of eight samples, within {} of the largest torque; --exact goes sample by sample",
        most_block_difference);
}

void CascadeFilter::process(const Samples& in, std::span<double> out) {
    if (out.empty()) return;
    if (!started_) {
        origin_nm_ = in.torque_nm.front();
        std::fill(states_.begin(), states_.end(), BiquadState{});
        if (blocks_) blocks_->start(origin_nm_);
        started_ = true;
    }
    if (blocks_) {
        blocks_->run(in.torque_nm, out);
        return;
    }
    run_serial(cascade_, states_, in.torque_nm, origin_nm_, out);
}

namespace {

// From a motor turn in 30 000 samples, where the ripple's gain is next to nothing, to half a turn a sample of
// the lowest order.
constexpr double slowest_turns = 0x1p-15;
constexpr int points_an_octave = 8;  ///< evenly from an octave's beginning to twice it

// Orders beyond half the sample rate are ignored and have no gain.
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

FilterBank::FilterBank(const Candidates& candidates)
    : groups_((candidates.cascades.size() + lanes - 1) / lanes),
      sections_(groups_ * candidates.sections),
      outputs_(groups_ * stride) {
    for (std::size_t filter = 0; filter < groups_ * lanes; ++filter) {
        for (std::size_t s = 0; s < candidates.sections; ++s) {
            // Lanes without a candidate run the last one once more.
            const Biquad& f = candidates.cascades[std::min(filter, candidates.cascades.size() - 1)][s];
            mirrored_ = mirrored_ && f.b0 == f.b2;
            BankSection& section = sections_[filter / lanes * candidates.sections + s];
            const std::size_t lane = filter % lanes;
            section.b0[lane] = f.b0;
            section.b1[lane] = f.b1;
            section.b2[lane] = f.b2;
            section.a1[lane] = f.a1;
            section.a2[lane] = f.a2;
        }
    }
}

void FilterBank::start(double torque_nm) {
    origin_nm_ = torque_nm;
    for (BankSection& section : sections_) section.s1 = section.s2 = {};
}

void FilterBank::run(std::span<const double> torque_nm) {
    std::array<double, capacity()> signal;
    for (std::size_t k = 0; k < torque_nm.size(); ++k) signal[k] = torque_nm[k] - origin_nm_;
    const BankRun bank{sections_, groups_, outputs_, stride, mirrored_};
    run_bank(bank, std::span(signal).first(torque_nm.size()));
}

void FilterBank::outputs(int candidate, std::span<const double> torque_nm,
                         std::span<double> out) const noexcept {
    if (candidate == no_candidate) {
        std::copy(torque_nm.begin(), torque_nm.end(), out.begin());
        return;
    }
    const auto filter = static_cast<std::size_t>(candidate);
    const BankOutput* from = &outputs_[filter / lanes * stride];
    const std::size_t lane = filter % lanes;
    const double origin = origin_nm_;  // a copy, which `out` cannot change
    for (double& value : out) value = origin + (from++)->lanes[lane];
}

}  // namespace ripplenotch
