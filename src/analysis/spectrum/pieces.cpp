// SPDX-License-Identifier: MIT
#include "analysis/spectrum/pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "core/functions/many_numbers.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

/// A clock counts as even when no sample is off it by more than this share of a step: then the plain
/// transform is the same sum.
constexpr double even_share = 1e-3;
constexpr double most_steps = 3.0;       // longest interval of one sample, next to a gap
constexpr std::size_t most_ahead = 8;    // pieces; those of usual lengths stay in the processor's cache
constexpr std::size_t side_by_side = 8;  // sums, so that an addition need not wait for the one before

using Sums = std::array<double, side_by_side>;

double total(const Sums& sums) { return std::accumulate(sums.begin(), sums.end(), 0.0); }

/// Angle whose cosine the window contains; position and length in the same unit.
double hann_angle(double place, double length) { return 2.0 * std::numbers::pi * place / length; }

double hann(double place, double length) { return 0.5 + 0.5 * portable::cos(hann_angle(place, length)); }

void remove_line(std::span<const double> t, std::vector<double>& x) {
    const auto n = static_cast<double>(x.size());
    const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
    const double t_mean = std::accumulate(t.begin(), t.end(), 0.0) / n;
    double tt = 0.0, tx = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        tt += (t[k] - t_mean) * (t[k] - t_mean);
        tx += (t[k] - t_mean) * (x[k] - mean);
    }
    const double slope = tt > 0.0 ? tx / tt : 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] -= mean + slope * (t[k] - t_mean);
}

}  // namespace

EvenPart look_at_even(std::span<const double> time, std::span<const double> values, double step,
                      std::size_t from) {
    const std::size_t n = time.size();
    const double begin = n > from ? time[0] : 0.0;
    const double middle = 0.5 * (static_cast<double>(n + from) - 1.0);
    Sums worst{}, sums{}, tilts{};
    const auto look = [&](std::size_t k, std::size_t i) {
        const auto at = static_cast<double>(k);
        const double off = std::abs(time[k] - begin - at * step);
        worst[i] = worst[i] < off ? off : worst[i];
        sums[i] += values[k];
        tilts[i] += (at - middle) * values[k];
    };
    std::size_t k = from;
    for (; k + side_by_side <= n; k += side_by_side)
        for (std::size_t i = 0; i < side_by_side; ++i) look(k + i, i);
    for (std::size_t i = 0; k + i < n; ++i) look(k + i, i);
    return {*std::max_element(worst.begin(), worst.end()), total(sums), total(tilts), n - from};
}

EvenPart together(const EvenPart& early, const EvenPart& late) {
    const auto before = static_cast<double>(early.count), behind = static_cast<double>(late.count);
    // Each part's middle lies half the other part away from the middle of both.
    return {std::max(early.worst, late.worst), early.sum + late.sum,
            early.tilt - 0.5 * behind * early.sum + late.tilt + 0.5 * before * late.sum,
            early.count + late.count};
}

EvenLine even_line(const EvenPart& values) {
    const auto count = static_cast<double>(values.count);
    const double squares = count * (count * count - 1.0) / 12.0;
    return {values.sum / count, squares > 0.0 ? values.tilt / squares : 0.0};
}

void subtract_line_and_window(std::span<const double> values, const EvenLine& line,
                              std::span<const double> window, std::span<double> to) {
    const double middle = 0.5 * (static_cast<double>(values.size()) - 1.0);
    for (std::size_t k = 0; k < values.size(); ++k)
        to[k] = (values[k] - ((static_cast<double>(k) - middle) * line.slope + line.mean)) * window[k];
}

PieceMaker::PieceMaker(std::size_t length, Hertz rate)
    : length_(length),
      hop_(std::max<std::size_t>(1, length / 2)),
      rate_(rate.value()),
      step_s_(1.0 / rate.value()),
      transform_(length) {
    const double middle = 0.5 * (static_cast<double>(length) - 1.0);
    even_time_s_.resize(length);
    even_window_.resize(length);
    for (std::size_t k = 0; k < length; ++k) {
        const double place = static_cast<double>(k) - middle;
        even_time_s_[k] = place * step_s_;
        even_window_[k] = hann_angle(place, static_cast<double>(length));
    }
    portable::cos(even_window_, even_window_);
    for (double& weight : even_window_) {
        weight = 0.5 + 0.5 * weight;
        even_sum_ += weight;
        even_square_sum_ += weight * weight;
    }
}

const Piece& PieceMaker::make(std::span<const double> time_s, std::span<const double> torque_nm) {
    const EvenPart both = look_at(time_s, torque_nm);
    piece_.middle_s = 0.5 * (time_s.front() + time_s.back());
    worst_s_ = std::max(worst_s_, both.worst);
    piece_.even = both.worst <= even_share * step_s_;
    if (piece_.even) {
        make_even(torque_nm, even_line(both));
    } else {
        late_.reset();
        make_uneven(time_s, torque_nm);
    }
    return piece_;
}

// Samples are read from memory much faster in one long go than between transforms.
void PieceMaker::look_ahead(std::span<const double> time_s, std::span<const double> torque_nm) {
    const std::size_t pieces = std::min(most_ahead, (time_s.size() - length_) / hop_ + 1);
    ahead_.resize(pieces);
    for (std::size_t k = 0; k < pieces; ++k) {
        ahead_[pieces - 1 - k] = look_at_even(time_s.subspan(k * hop_, length_),
                                              torque_nm.subspan(k * hop_, length_), step_s_, length_ / 2);
    }
}

EvenPart PieceMaker::look_at(std::span<const double> time_s, std::span<const double> torque_nm) {
    const std::size_t half = length_ / 2;
    // The result for an even piece is reused; its own beginning may be as far off as that, no more.
    const bool seen = late_ && late_->count == half;
    const EvenPart early = seen ? *late_ : look_at_even(time_s.first(half), torque_nm.first(half), step_s_);
    late_ = ahead_.back();
    ahead_.pop_back();
    return together(early, *late_);
}

void PieceMaker::make_even(std::span<const double> torque_nm, const EvenLine& line) {
    subtract_line_and_window(torque_nm, line, even_window_, transform_.in());
    piece_.time_s = even_time_s_;
    piece_.value = transform_.in();
    piece_.window_sum = even_sum_;
    piece_.window_square_sum = even_square_sum_;
}

void PieceMaker::make_uneven(std::span<const double> time_s, std::span<const double> torque_nm) {
    const std::size_t n = torque_nm.size();
    const double length_s = static_cast<double>(n) * step_s_;
    time_s_.resize(n);
    value_.assign(torque_nm.begin(), torque_nm.end());
    for (std::size_t k = 0; k < n; ++k) time_s_[k] = time_s[k] - piece_.middle_s;
    remove_line(time_s_, value_);
    piece_.window_sum = piece_.window_square_sum = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
        // Each sample stands for the time around it. Were all alike, a clock that stumbles in a pattern would
        // make lines of that pattern out of the slow motion, a hundred times stronger than any ripple.
        const double before = time_s_[k > 0 ? k - 1 : k], after = time_s_[std::min(k + 1, n - 1)];
        const double share = std::clamp(0.5 * (after - before) / step_s_, 0.0, most_steps);
        const double window = share * hann(time_s_[k], length_s);
        value_[k] *= window;
        piece_.window_sum += window;
        piece_.window_square_sum += window * window;
    }
    piece_.time_s = time_s_;
    piece_.value = value_;
}

bool PieceMaker::even_at(Hertz rate) const {
    // A grid with other steps is off by so much more at the end of a piece.
    const double step = 1.0 / rate.value(), drift = std::abs(step - step_s_) * static_cast<double>(length_);
    return (worst_s_ + drift) * (1.0 + 1e-9) <= even_share * std::min(step, step_s_);
}

std::span<const std::complex<double>> PieceMaker::sums() {
    if (piece_.even) return transform_.run();
    uneven_sums_ = nonuniform_fourier(piece_.time_s, piece_.value, rate_ / static_cast<double>(length_),
                                      length_ / 2 + 1);
    return uneven_sums_;
}

void PieceMaker::add_power(double scale, std::span<double> power) {
    const auto of_piece = sums();
    for (std::size_t k = 0; k < of_piece.size(); ++k)
        power[k] +=
            scale * (of_piece[k].real() * of_piece[k].real() + of_piece[k].imag() * of_piece[k].imag());
}

}  // namespace ripplenotch
