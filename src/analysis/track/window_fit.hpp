// SPDX-License-Identifier: MIT
#pragma once
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

// Internal to the analysis module: windows of a run of motion, and the least squares of a trend and lines in
// one of them, the basis of every ripple estimate.

/// Windows of one length, evenly spread from the start to the end of a run in `place` (turns or time, one
/// value a sample, in one direction), at most `hop` of the length apart. A run between the shortest and one
/// window long is one window, a shorter one none.
[[nodiscard]] std::vector<SampleRun> cut_windows(const SampleRun& run, std::span<const double> place,
                                                 double length, double shortest, double hop);

/// Weighted least squares in one window: a trend, and of each line a cosine and a sine whose amplitudes are
/// polynomials of the place. The trend is a line and cosines of the place: 12 per turn of the joint, but no
/// more than one for two periods of the slowest line, and never fewer than three; or as many polynomials,
/// which do not bend at the ends, and never fewer than make a cubic.
class WindowFit {
  public:
    enum class Trend { cosines, polynomials };
    /// `place` rises or falls along the window. Of each line the turns at the window's samples. Each sample
    /// counts by the square of its root weight; without any, all count alike.
    WindowFit(std::span<const double> place, std::span<const double> root_weight, double output_turns,
              std::vector<TrackedLine> lines, int envelope_degree, Trend trend = Trend::cosines);

    [[nodiscard]] std::size_t unknowns() const { return trend_ + 2 * (degree_ + 1) * lines_.size(); }
    [[nodiscard]] bool has_enough_samples() const { return place_.size() >= 2 * unknowns(); }
    /// Once, before what follows. Cost O(n unknowns^2).
    void factorise();
    /// The smallest pivot of the normal equations with unit columns: near 0 where a line is a sum of other
    /// terms.
    [[nodiscard]] double least_pivot() const { return factors_.least_pivot(); }
    /// Factor of the variance of a line's amplitude due to the other terms, with a constant envelope.
    [[nodiscard]] double inflation(std::size_t line) const;
    /// Variance of the part of a line's amplitude along a phase, per variance of the torque, all samples
    /// counting alike.
    [[nodiscard]] double variance(std::size_t line, std::complex<double> along) const;

    struct Torque {
        Eigen::VectorXd coefficients;
        std::vector<double> residual;  ///< times the root weights
    };
    [[nodiscard]] Torque fit(std::span<const double> torque_nm) const;
    /// a - ib of a cos + b sin at the middle of the window.
    [[nodiscard]] std::complex<double> amplitude(const Torque& torque, std::size_t line) const;
    /// The torque of all lines, times the root weights.
    [[nodiscard]] std::vector<double> lines_in_sum(const Torque& torque) const;
    /// Values of the samples between a quarter and three quarters of the window, without their root weights.
    [[nodiscard]] std::vector<double> middle_half(std::span<const double> weighted) const;
    /// Squared amplitude of the residual at a line that was not fitted; nan within `clear_cycles` of a fitted
    /// line, or of the trend, since their fit removed the noise there.
    [[nodiscard]] double power_beside(const Torque& torque, const TrackedLine& line,
                                      double clear_cycles) const;
    /// Sum of the weights.
    [[nodiscard]] double weight() const { return weight_; }

  private:
    [[nodiscard]] Eigen::Index first_of(std::size_t line) const;
    void add_trend();
    void add_wave(const TrackedLine& line);
    void waves(const TrackedLine& line, std::vector<double>& cosine, std::vector<double>& sine) const;

    std::vector<double> place_;  ///< 0 to 1
    std::vector<double> root_weight_;
    std::vector<TrackedLine> lines_;
    std::size_t degree_ = 0;
    bool cosines_ = true;
    std::size_t trend_ = 0;
    double weight_ = 0.0;
    std::vector<std::vector<double>> columns_;  ///< times the root weights
    Eigen::VectorXd scale_;
    /// Inverse of the normal equations with unit columns: columns of the lines' constants.
    Eigen::MatrixXd inverse_;
    SymmetricFactors factors_;
};

}  // namespace ripplenotch
