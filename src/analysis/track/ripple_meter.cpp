// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/ripple_meter.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/track/ripple_segments.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_rows_held = 65536;  // chosen, not derived: a minute of motion and more

double root_mean_square(std::span<const SegmentResidual> segments, double SegmentResidual::*square_nm2) {
    double sum = 0.0, weight = 0.0;
    for (const SegmentResidual& one : segments) {
        sum += one.weight * one.*square_nm2;
        weight += one.weight;
    }
    return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

}  // namespace

struct RippleMeter::State {
    Hertz rate;
    std::vector<double> orders;
    RippleSegments segments;
    std::size_t rows = 0;  ///< handed over in all

    // Rows held, which belong to one run; the first `seen_before` have been measured.
    std::vector<double> time_s = {}, velocity_deg_s = {}, position_deg = {};
    std::vector<std::vector<double>> torque_nm = {};  ///< per signal
    std::size_t seen_before = 0;

    std::size_t measure(RippleSegments& into) const {
        const std::vector<std::span<const double>> all(torque_nm.begin(), torque_nm.end());
        return into.add({rate, time_s, velocity_deg_s, all.front(), position_deg}, std::span(all).subspan(1),
                        seen_before);
    }
    /// Keeps the rows from one on.
    void keep_from(std::size_t row) {
        const auto cut = [row](std::vector<double>& values) {
            if (!values.empty())
                values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(row));
        };
        cut(time_s);
        cut(velocity_deg_s);
        cut(position_deg);
        for (std::vector<double>& signal : torque_nm) cut(signal);
        seen_before = time_s.size();
    }
};

RippleMeter::RippleMeter(GearRatio ratio, std::span<const Order> orders, Hertz sample_rate,
                         std::size_t signals, LineGains gains) {
    if (!(sample_rate.value() > 0.0)) {
        raise<UsageError>("sample rate {} Hz is not above 0 Hz", shortest(sample_rate.value()));
    }
    if (orders.empty() || signals == 0)
        raise<UsageError>("measuring ripple needs at least one order and one signal");
    RippleSegments segments(ratio, orders,
                            {.signals = signals, .residuals = true, .gains = std::move(gains)});
    state_ = std::make_unique<State>(State{sample_rate, {}, std::move(segments)});
    for (const Order order : orders) state_->orders.push_back(order.value());
    state_->torque_nm.resize(signals);
}

RippleMeter::~RippleMeter() = default;
RippleMeter::RippleMeter(RippleMeter&&) noexcept = default;
RippleMeter& RippleMeter::operator=(RippleMeter&&) noexcept = default;

void RippleMeter::add(Seconds time, double velocity_deg_s, const double* position_deg,
                      std::span<const double> torque_nm) {
    State& state = *state_;
    // Where the joint's position ends or begins, the angle starts anew.
    if (!state.time_s.empty() && state.position_deg.empty() == (position_deg != nullptr)) split();
    ++state.rows;
    state.time_s.push_back(time.value());
    state.velocity_deg_s.push_back(velocity_deg_s);
    if (position_deg != nullptr) state.position_deg.push_back(*position_deg);
    for (std::size_t j = 0; j < state.torque_nm.size(); ++j) state.torque_nm[j].push_back(torque_nm[j]);
    if (state.time_s.size() < most_rows_held) return;
    // A run that fills the buffer is too slow to be one segment.
    const std::size_t from = state.measure(state.segments);
    state.keep_from(from < most_rows_held / 2 ? most_rows_held : from);
}

void RippleMeter::split() {
    static_cast<void>(state_->measure(state_->segments));
    state_->keep_from(state_->time_s.size());
}

RippleLevels RippleMeter::levels() const {
    RippleSegments all = state_->segments;
    static_cast<void>(state_->measure(all));
    RippleLevels levels;
    for (const double value : state_->orders) {
        OrderLevel level;
        level.order = value;
        double weight = 0.0, turns = 0.0, seconds = 0.0, expected = 0.0;
        std::vector<double> power(state_->torque_nm.size(), 0.0);
        for (const SegmentAmplitude& one : all.of(Order(value)).segments) {
            weight += one.place.weight;
            turns += one.place.turns;
            seconds += one.place.seconds;
            expected += one.place.weight * one.expected_gain * one.expected_gain;
            for (std::size_t j = 0; j < power.size(); ++j)
                power[j] += one.place.weight * std::norm(one.value[j]);
        }
        level.windows = all.of(Order(value)).segments.size();
        levels.windows = std::max(levels.windows, level.windows);
        if (seconds > 0.0) level.mean_hz = value * turns / seconds;
        for (const double sum : power)
            level.amplitude_nm.push_back(weight > 0.0 ? std::sqrt(sum / weight) : not_a_number);
        if (all.has_gains() && weight > 0.0) level.expected_gain = std::sqrt(expected / weight);
        levels.orders.push_back(std::move(level));
    }
    for (const std::vector<SegmentResidual>& signal : all.residuals()) {
        levels.residual_rms_nm.push_back(root_mean_square(signal, &SegmentResidual::square_nm2));
        std::vector<double> peaks;
        double ripple = 0.0;
        for (const SegmentResidual& one : signal) {
            peaks.push_back(one.peak_to_peak_nm);
            ripple = std::max(ripple, one.ripple_peak_to_peak_nm);
        }
        levels.residual_peak_to_peak_nm.push_back(median_in(peaks));
        levels.ripple_peak_to_peak_nm.push_back(ripple);
    }
    levels.windows_too_few_samples = all.too_few_samples();
    if (state_->rows > 0)
        levels.measured_share = static_cast<double>(all.rows()) / static_cast<double>(state_->rows);
    return levels;
}

}  // namespace ripplenotch
