// SPDX-License-Identifier: MIT
#include "analysis/spectrum/line_meter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double reach_bins = 0.5;     // reach of the moments
constexpr int most_rounds = 8;         // chosen, not derived
constexpr double settled_bins = 1e-9;  // bins

/// sum over k of value[k] place[k]^d exp(i angle) for d = 0 .. 7, by the angles' cosines and sines.
using Moments = std::array<std::complex<double>, 8>;

Moments turned_moments(std::span<const double> value, std::span<const double> place,
                       std::span<const double> cosine, std::span<const double> sine) {
    constexpr std::size_t orders = std::tuple_size_v<Moments>;
    std::array<double, orders> real{}, imaginary{};
    for (std::size_t k = 0; k < value.size(); ++k) {
        double weight = value[k];
        for (std::size_t d = 0; d < orders; ++d, weight *= place[k]) {
            real[d] += weight * cosine[k];
            imaginary[d] += weight * sine[k];
        }
    }
    Moments moments;
    for (std::size_t d = 0; d < orders; ++d) moments[d] = {real[d], imaginary[d]};
    return moments;
}

/// S(x) = sum over d of (-i x)^d / d! M_d with its first two derivatives; x is 2 pi (f - start) half a piece.
struct Point {
    std::complex<double> value, first, second;

    Point(const Moments& moments, double x) {
        std::complex<double> term =
            1.0;  // (-i)^d x^(d - j) / (d - j)! for j = 0; shifted for the derivatives
        const std::complex<double> turn(0.0, -1.0);
        for (std::size_t d = 0; d < moments.size(); ++d) {
            value += term * moments[d];
            if (d + 1 < moments.size()) first += turn * term * moments[d + 1];
            if (d + 2 < moments.size()) second += turn * turn * term * moments[d + 2];
            term *= turn * (x / static_cast<double>(d + 1));
        }
    }
};

}  // namespace

void LineMeter::expect_even_pieces(std::span<const double> even_time_s) {
    half_s_ = 0.5 / bin_hz_;
    for (const double t : even_time_s) {
        place_.push_back(t / half_s_);
        cosine_.push_back(portable::cos(full_turn * start_hz_ * t));
        sine_.push_back(-portable::sin(full_turn * start_hz_ * t));
    }
}

bool LineMeter::search_moments(const Piece& piece, Maximum& found) const {
    const Moments moments = turned_moments(piece.value, place_, cosine_, sine_);
    const double bin = full_turn * bin_hz_ * half_s_;
    double x = 0.0;
    for (int round = 0; round < most_rounds; ++round) {
        const Point at(moments, x);
        const double curve = std::norm(at.first) + std::real(std::conj(at.value) * at.second);
        if (!(curve < 0.0)) break;
        const double step = std::real(std::conj(at.value) * at.first) / curve;
        x -= step;
        if (std::abs(x) > reach_bins * bin) return false;
        if (std::abs(step) < settled_bins * bin) break;
    }
    found = {start_hz_ + x / (full_turn * half_s_), Point(moments, x).value};
    return true;
}

LineMeter::Maximum LineMeter::search(const Piece& piece) const {
    Maximum found;
    if (piece.even && half_s_ > 0.0 && search_moments(piece, found)) return found;
    found.hz = refine_peak(piece.time_s, piece.value, {.frequency = start_hz_, .reach = bin_hz_});
    found.sum = fourier_point(piece.time_s, piece.value, found.hz).value;
    return found;
}

void LineMeter::add(const Piece& piece) {
    const Maximum found = search(piece);
    const std::complex<double> amplitude = 2.0 * found.sum / piece.window_sum;
    const double weight = std::norm(amplitude);
    ++pieces_;
    power_ += weight;
    weighted_hz_ += weight * found.hz;
    if (weight <= std::norm(strongest_)) return;
    strongest_ = amplitude;
    strongest_middle_s_ = piece.middle_s;
}

double LineMeter::hz() const { return power_ > 0.0 ? weighted_hz_ / power_ : start_hz_; }

double LineMeter::amplitude_nm() const { return std::sqrt(power_ / static_cast<double>(pieces_)); }

double LineMeter::phase_rad() const {
    return portable::arg(strongest_) - full_turn * hz() * strongest_middle_s_;
}

}  // namespace ripplenotch
