// SPDX-License-Identifier: MIT
#include "analysis/track/window_fit.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "core/functions/many_numbers.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// Chosen, not derived: terms per turn of the joint, whose torque follows its angle.
constexpr double trend_terms_per_turn = 12.0;
constexpr double periods_per_trend_term = 2.0;  // periods of the slowest line: no term comes near it
constexpr double fewest_cosines = 3.0, fewest_polynomials = 2.0;  // the polynomials make a cubic

double cycles_of(const TrackedLine& line) {
    return line.order * std::abs(line.turns.back() - line.turns.front());
}

std::size_t curved_terms(double output_turns, std::span<const TrackedLine> lines, double fewest) {
    double most = trend_terms_per_turn * output_turns;
    for (const TrackedLine& line : lines) most = std::min(most, cycles_of(line) / periods_per_trend_term);
    return static_cast<std::size_t>(std::max(fewest, std::round(most)));
}

}  // namespace

std::vector<SampleRun> cut_windows(const SampleRun& run, std::span<const double> place, double length,
                                   double shortest, double hop) {
    const double start = place[run.first];
    const double whole = std::abs(place[run.end - 1] - start);
    if (whole < shortest) return {};
    if (whole <= length) return {run};
    // No more windows than samples, however far apart those are.
    const double hops =
        std::min(std::ceil((whole - length) / (hop * length)), static_cast<double>(run.size()));
    std::vector<SampleRun> windows;
    std::size_t from = run.first, to = run.first;
    for (double i = 0.0; i <= hops; i += 1.0) {
        const double begin = (whole - length) * i / hops;
        while (from < run.end && std::abs(place[from] - start) < begin) ++from;
        to = std::max(to, from);
        while (to < run.end && std::abs(place[to] - start) <= begin + length) ++to;
        windows.push_back({from, to});
    }
    return windows;
}

WindowFit::WindowFit(std::span<const double> place, std::span<const double> root_weight, double output_turns,
                     std::vector<TrackedLine> lines, int envelope_degree, Trend trend)
    : root_weight_(root_weight.begin(), root_weight.end()),
      lines_(std::move(lines)),
      degree_(static_cast<std::size_t>(envelope_degree)),
      cosines_(trend == Trend::cosines),
      trend_(2 + curved_terms(output_turns, lines_, cosines_ ? fewest_cosines : fewest_polynomials)) {
    root_weight_.resize(place.size(), 1.0);
    weight_ = dot(root_weight_.data(), root_weight_.data(), place.size());
    const double length = std::abs(place.back() - place.front());
    for (const double at : place)
        place_.push_back(std::clamp(std::abs(at - place.front()) / length, 0.0, 1.0));
}

void WindowFit::add_trend() {
    columns_.assign(trend_, std::vector<double>(place_.size()));
    for (std::size_t k = 0; k < place_.size(); ++k) {
        columns_[0][k] = root_weight_[k];
        columns_[1][k] = root_weight_[k] * (place_[k] - 0.5);
        // Chebyshev's recurrence gives the cosines of multiples of an angle, or polynomials of the place.
        const double s = 2.0 * place_[k] - 1.0;
        const double x = cosines_ ? portable::cos(std::numbers::pi * place_[k]) : s;
        double before = cosines_ ? 1.0 : s, now = cosines_ ? x : 2.0 * s * s - 1.0;
        for (std::size_t m = 2; m < trend_; ++m) {
            columns_[m][k] = root_weight_[k] * now;
            const double next = 2.0 * x * now - before;
            before = now;
            now = next;
        }
    }
}

void WindowFit::waves(const TrackedLine& line, std::vector<double>& cosine, std::vector<double>& sine) const {
    std::vector<double> angle(place_.size());
    for (std::size_t k = 0; k < angle.size(); ++k)
        angle[k] = 2.0 * std::numbers::pi * line.order * line.turns[k];
    cosine.resize(angle.size());
    sine.resize(angle.size());
    portable::phasors(angle, cosine, sine);
    for (std::size_t k = 0; k < angle.size(); ++k) {
        cosine[k] *= root_weight_[k];
        sine[k] *= root_weight_[k];
    }
}

void WindowFit::add_wave(const TrackedLine& line) {
    std::vector<double> cosine, sine;
    waves(line, cosine, sine);
    for (std::size_t degree = 0; degree <= degree_; ++degree) {
        columns_.push_back(cosine);
        columns_.push_back(sine);
        for (std::size_t k = 0; degree < degree_ && k < place_.size(); ++k) {
            cosine[k] *= 2.0 * place_[k] - 1.0;
            sine[k] *= 2.0 * place_[k] - 1.0;
        }
    }
}

Eigen::Index WindowFit::first_of(std::size_t line) const {
    return static_cast<Eigen::Index>(trend_ + 2 * (degree_ + 1) * line);
}

void WindowFit::factorise() {
    add_trend();
    for (const TrackedLine& line : lines_) add_wave(line);
    const auto n = static_cast<Eigen::Index>(columns_.size());
    Eigen::MatrixXd normal(n, n);
    scale_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double* const column = columns_[static_cast<std::size_t>(i)].data();
        for (Eigen::Index j = 0; j <= i; ++j)
            normal(i, j) = dot(column, columns_[static_cast<std::size_t>(j)].data(), place_.size());
        scale_[i] = 1.0 / std::sqrt(std::max(normal(i, i), 1e-300));
    }
    normal = scale_.asDiagonal() * normal * scale_.asDiagonal();
    factors_.compute(normal);
    Eigen::MatrixXd units = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(2 * lines_.size()));
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        const auto column = static_cast<Eigen::Index>(2 * i);
        units(first_of(i), column) = units(first_of(i) + 1, column + 1) = 1.0;
    }
    inverse_ = factors_.solve(units);
}

double WindowFit::inflation(std::size_t line) const {
    const auto column = static_cast<Eigen::Index>(2 * line);
    return 0.5 * (inverse_(first_of(line), column) + inverse_(first_of(line) + 1, column + 1));
}

double WindowFit::variance(std::size_t line, std::complex<double> along) const {
    const Eigen::Index first = first_of(line), column = static_cast<Eigen::Index>(2 * line);
    const double a = along.real() * scale_[first], b = -along.imag() * scale_[first + 1];
    return a * a * inverse_(first, column) + 2.0 * a * b * inverse_(first, column + 1) +
           b * b * inverse_(first + 1, column + 1);
}

WindowFit::Torque WindowFit::fit(std::span<const double> torque_nm) const {
    const std::size_t samples = place_.size();
    Torque found{Eigen::VectorXd(scale_.size()), std::vector<double>(samples)};
    for (std::size_t k = 0; k < samples; ++k) found.residual[k] = root_weight_[k] * torque_nm[k];
    for (Eigen::Index i = 0; i < scale_.size(); ++i)
        found.coefficients[i] =
            scale_[i] * dot(columns_[static_cast<std::size_t>(i)].data(), found.residual.data(), samples);
    const Eigen::VectorXd solved = factors_.solve(found.coefficients);
    found.coefficients = scale_.asDiagonal() * solved;
    for (Eigen::Index i = 0; i < scale_.size(); ++i)
        add_scaled(-found.coefficients[i], columns_[static_cast<std::size_t>(i)].data(),
                   found.residual.data(), samples);
    return found;
}

std::complex<double> WindowFit::amplitude(const Torque& torque, std::size_t line) const {
    return {torque.coefficients[first_of(line)], -torque.coefficients[first_of(line) + 1]};
}

std::vector<double> WindowFit::lines_in_sum(const Torque& torque) const {
    std::vector<double> sum(place_.size(), 0.0);
    for (std::size_t i = trend_; i < columns_.size(); ++i)
        add_scaled(torque.coefficients[static_cast<Eigen::Index>(i)], columns_[i].data(), sum.data(),
                   sum.size());
    return sum;
}

std::vector<double> WindowFit::middle_half(std::span<const double> weighted) const {
    std::vector<double> values;
    for (std::size_t k = 0; k < weighted.size(); ++k)
        if (std::abs(place_[k] - 0.5) <= 0.25) values.push_back(weighted[k] / root_weight_[k]);
    return values;
}

double WindowFit::power_beside(const Torque& torque, const TrackedLine& line, double clear_cycles) const {
    const double cycles = cycles_of(line);
    bool taken = cycles < 0.5 * static_cast<double>(trend_ - 2) + clear_cycles;
    for (const TrackedLine& other : lines_)
        taken = taken || std::abs(cycles - cycles_of(other)) < 0.99 * clear_cycles;
    if (taken) return not_a_number;
    std::vector<double> cosine, sine;
    waves(line, cosine, sine);
    const double c = dot(cosine.data(), torque.residual.data(), place_.size());
    const double s = dot(sine.data(), torque.residual.data(), place_.size());
    return 4.0 * (c * c + s * s) / (weight_ * weight_);
}

}  // namespace ripplenotch
