// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/order_track.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "analysis/shared_limits.hpp"
#include "analysis/track/cut_windows.hpp"
#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/phasor.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

/// Smallest pivot of the normal equations with unit columns. Below, a line is what the others already say, to
/// within rounding times the torque's range.
constexpr double least_pivot = 1e-9;

/// A window of half the turns may last so many times WindowRule::longest, as in RippleMeter.
constexpr double slowest_halves = 4.0;

void check_signal(const TrackedSignal& signal, const WindowRule& rule) {
    if (signal.lines.empty()) raise<UsageError>("there is no order to track");
    for (const TrackedLine& line : signal.lines) {
        if (!(line.order > 0.0)) raise<UsageError>("order {} is not above 0", shortest(line.order));
    }
    if (rule.seconds.value() < 0.0 || (rule.seconds.value() == 0.0 && !(rule.turns > 0.0))) {
        raise<UsageError>("a window of {} turns is not above 0", shortest(rule.turns));
    }
    if (!(rule.hop > 0.0) || rule.hop > 1.0 || rule.envelope_degree < 0 || rule.envelope_degree > 2) {
        raise<UsageError>("windows are 0 to 1 length apart and their envelopes of degree 0 to 2");
    }
}

/// The middle of a window, of so much of its length.
SampleRun middle_of(const SampleRun& window, std::span<const double> place, double length) {
    const double middle = 0.5 * (place[window.first] + place[window.end - 1]);
    SampleRun part = window;
    while (part.first + 2 < part.end && std::abs(place[part.first] - middle) > 0.5 * length) ++part.first;
    while (part.first + 2 < part.end && std::abs(place[part.end - 1] - middle) > 0.5 * length) --part.end;
    return part;
}

class WindowFit {
  public:
    WindowFit(const TrackedSignal& signal, const WindowRule& rule)
        : signal_(signal), degree_(rule.envelope_degree) {}

    [[nodiscard]] Eigen::Index unknowns() const {
        return window_trend_terms + 2 * (degree_ + 1) * static_cast<Eigen::Index>(signal_.lines.size());
    }

    /// False when the lines cannot be told apart within the window.
    bool fit(const SampleRun& window) {
        fill_basis(window);
        const Eigen::VectorXd scale = basis_.colwise().norm().cwiseMax(1e-300).cwiseInverse();
        normal_.setZero(unknowns(), unknowns());
        normal_.selfadjointView<Eigen::Lower>().rankUpdate(basis_.transpose());
        normal_ =
            scale.asDiagonal() * normal_.selfadjointView<Eigen::Lower>().toDenseMatrix() * scale.asDiagonal();
        solver_.compute(normal_);
        if (!(solver_.least_pivot() > least_pivot)) return false;
        const Eigen::VectorXd right = scale.asDiagonal() * (basis_.transpose() * torque_);
        const Eigen::VectorXd scaled = solver_.solve(right);
        coefficients_ = scale.asDiagonal() * scaled;
        const double freedom = static_cast<double>(basis_.rows() - unknowns());
        residual_square_ = (torque_ - basis_ * coefficients_).squaredNorm();
        covariance_ = solver_.solve(Eigen::MatrixXd(scale.asDiagonal()));
        covariance_ = (residual_square_ / freedom) * (scale.asDiagonal() * covariance_);
        return true;
    }

    [[nodiscard]] double residual_square() const { return residual_square_; }

    void report(std::size_t line, LineTrack& track) const {
        const Eigen::Index c = window_trend_terms + 2 * (degree_ + 1) * static_cast<Eigen::Index>(line);
        const double a = coefficients_[c], b = coefficients_[c + 1];
        const double amplitude = portable::hypot(a, b);
        const double ua = amplitude > 0.0 ? a / amplitude : 1.0, ub = amplitude > 0.0 ? b / amplitude : 0.0;
        const double variance = ua * ua * covariance_(c, c) + 2.0 * ua * ub * covariance_(c, c + 1) +
                                ub * ub * covariance_(c + 1, c + 1);
        track.amplitude_nm.push_back(amplitude);
        track.standard_error_nm.push_back(std::sqrt(std::max(variance, 0.0)));
        track.phase_deg.push_back(portable::atan2(-b, a) * degrees_per_radian);
    }

  private:
    void fill_basis(const SampleRun& window) {
        const auto n = static_cast<Eigen::Index>(window.size());
        const double start = signal_.time_s[window.first], end = signal_.time_s[window.end - 1];
        basis_.resize(n, unknowns());
        torque_.resize(n);
        for (Eigen::Index k = 0; k < n; ++k) {
            const std::size_t at = window.first + static_cast<std::size_t>(k);
            const double s = (2.0 * signal_.time_s[at] - start - end) / (end - start);
            torque_[k] = signal_.torque_nm[at];
            double power = 1.0;
            for (Eigen::Index i = 0; i < window_trend_terms; ++i, power *= s) basis_(k, i) = power;
            Eigen::Index column = window_trend_terms;
            for (const TrackedLine& line : signal_.lines) {
                const double angle = 2.0 * std::numbers::pi * line.order * line.turns[at];
                const std::complex<double> phasor = portable::phasor(angle);
                const double cosine = phasor.real(), sine = phasor.imag();
                power = 1.0;
                for (int i = 0; i <= degree_; ++i, power *= s) {
                    basis_(k, column++) = cosine * power;
                    basis_(k, column++) = sine * power;
                }
            }
        }
    }

    const TrackedSignal& signal_;
    int degree_;
    Eigen::MatrixXd basis_, normal_, covariance_;
    Eigen::VectorXd torque_, coefficients_;
    SymmetricFactors solver_;
    double residual_square_ = 0.0;
};

void add_row(const TrackedSignal& signal, const SampleRun& window, const WindowFit& fit,
             OrderTracks& tracks) {
    const double start = signal.time_s[window.first], end = signal.time_s[window.end - 1];
    const double middle = 0.5 * (start + end);
    const auto first = signal.time_s.begin() + static_cast<std::ptrdiff_t>(window.first);
    const auto nearest =
        std::lower_bound(first, signal.time_s.begin() + static_cast<std::ptrdiff_t>(window.end), middle);
    tracks.time_s.push_back(middle);
    tracks.speed_deg_s.push_back(
        signal.speed_deg_s[static_cast<std::size_t>(nearest - signal.time_s.begin())]);
    bool folded = false;
    for (std::size_t i = 0; i < signal.lines.size(); ++i) {
        const TrackedLine& line = signal.lines[i];
        const double hz =
            line.order * std::abs(line.turns[window.end - 1] - line.turns[window.first]) / (end - start);
        fit.report(i, tracks.lines[i]);
        tracks.lines[i].hz.push_back(hz);
        folded = folded || hz > 0.5 * signal.sample_rate.value();
    }
    tracks.rows_folded += folded ? 1 : 0;
}

}  // namespace

double separating_window_turns(std::span<const double> orders) {
    constexpr double periods = 8.0, beats = 2.0;  // by hand: of the lowest line, and of the slowest beat
    std::vector<double> sorted(orders.begin(), orders.end());
    std::sort(sorted.begin(), sorted.end());
    if (sorted.empty() || !(sorted.front() > 0.0)) raise<UsageError>("orders must be above 0");
    double turns = periods / sorted.front();
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i] == sorted[i - 1]) raise<UsageError>("order {} is listed twice", shortest(sorted[i]));
        turns = std::max(turns, beats / (sorted[i] - sorted[i - 1]));
    }
    return turns;
}

OrderTracks track_orders(const TrackedSignal& signal, const WindowRule& rule) {
    check_signal(signal, rule);
    OrderTracks tracks;
    tracks.lines.resize(signal.lines.size());
    const bool by_time = rule.seconds.value() > 0.0;
    const auto place = by_time ? signal.time_s : signal.reference_turns;
    const double length = by_time ? rule.seconds.value() : rule.turns;
    WindowFit fit(signal, rule);
    double squares = 0.0;
    std::size_t samples = 0;
    for (const SampleRun& run : directed_runs(signal.speed_deg_s, signal.run_starts, {})) {
        for (const SampleRun& whole : cut_windows(run, place, length, 0.5 * length, rule.hop)) {
            const auto lasts_longer = [&](const SampleRun& window, double seconds) {
                return !by_time && signal.time_s[window.end - 1] - signal.time_s[window.first] > seconds;
            };
            const SampleRun window =
                lasts_longer(whole, rule.longest.value()) ? middle_of(whole, place, 0.5 * length) : whole;
            if (lasts_longer(window, slowest_halves * rule.longest.value())) {
                ++tracks.windows_too_slow;
            } else if (window.size() < 2 * static_cast<std::size_t>(fit.unknowns())) {
                ++tracks.windows_too_few_samples;
            } else if (!fit.fit(window)) {
                ++tracks.rows_not_separable;
            } else {
                add_row(signal, window, fit, tracks);
                squares += fit.residual_square();
                samples += window.size() - static_cast<std::size_t>(fit.unknowns());
            }
        }
    }
    if (samples > 0) tracks.residual_rms_nm = std::sqrt(squares / static_cast<double>(samples));
    return tracks;
}

}  // namespace ripplenotch
