// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: how the power of ripple lines depends on what the velocity is off by.

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

/// A sweep's torque at one order: demodulated, and averaged over short cells. The three columns are what the
/// order's own place, the offset and the delay add to the angle, in turns for one unit of each, about their
/// means.
struct DemodulatedSweep {
    std::size_t sweep = 0, order = 0;  ///< which
    double cycles = 0.0;               ///< per turn
    double noise = 0.0;                ///< power of it in the sum
    std::vector<std::complex<double>> value;
    std::vector<double> weight, weight_square, seconds;
    std::array<std::vector<double>, 3> column;
    double variance_per_s = 0.0;  ///< of the angle, in turns^2: what noise of the velocity adds up to
    double weights = 0.0, weight_squares = 0.0;
};

/// `noise` and `variance_per_s` are left to the caller. Cost O(samples).
[[nodiscard]] DemodulatedSweep demodulated(const TraceView& log, const Sweep& sweep, double cycles_per_turn);

/// Half of the summed power over noise at some values of the unknowns: one for each order (its place, as a
/// share), the offset in deg/s, the delay in seconds. With what the unknowns may be beforehand.
class RipplePower {
  public:
    /// `beforehand`: its errors are how far offset and delay may be from 0.
    RipplePower(std::vector<DemodulatedSweep> all, std::size_t orders, const VelocityError& beforehand)
        : all_(std::move(all)),
          orders_(orders),
          certainty_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(orders) + 2)) {
        const double off = beforehand.offset_error.value(), late = beforehand.delay_error.value();
        certainty_[offset()] = 1.0 / (off * off);
        certainty_[delay()] = 1.0 / (late * late);
    }

    struct At {
        double value = 0.0;
        Eigen::VectorXd slope;
        Eigen::MatrixXd curve;     ///< of the power itself, and
        Eigen::MatrixXd expected;  ///< what it is where the cells are in phase: never indefinite
    };

    [[nodiscard]] Eigen::Index unknowns() const { return static_cast<Eigen::Index>(orders_) + 2; }
    [[nodiscard]] Eigen::Index offset() const { return static_cast<Eigen::Index>(orders_); }
    [[nodiscard]] Eigen::Index delay() const { return static_cast<Eigen::Index>(orders_) + 1; }

    [[nodiscard]] At at(const Eigen::VectorXd& unknown) const {
        At sum{-0.5 * unknown.dot(certainty_.cwiseProduct(unknown)), -certainty_.cwiseProduct(unknown),
               -Eigen::MatrixXd(certainty_.asDiagonal()), Eigen::MatrixXd(certainty_.asDiagonal())};
        for (const DemodulatedSweep& cells : all_) add(cells, unknown, sum);
        return sum;
    }

    /// Covariance of the slope at the maximum: of noise of the torque, and of what the orders have in common,
    /// noise of the velocity and what was believed beforehand.
    struct SlopeVariance {
        Eigen::MatrixXd own, common;
    };
    [[nodiscard]] SlopeVariance slope_variance(const Eigen::VectorXd& unknown) const;

    /// How far offset and delay move a cell within its sweep, at most, in cycles of its order.
    [[nodiscard]] double most_cycles(const Eigen::VectorXd& unknown) const;

  private:
    [[nodiscard]] std::array<Eigen::Index, 3> places_of(const DemodulatedSweep& cells) const {
        return {static_cast<Eigen::Index>(cells.order), offset(), delay()};
    }

    void add(const DemodulatedSweep& cells, const Eigen::VectorXd& unknown, At& sum) const;

    std::vector<DemodulatedSweep> all_;
    std::size_t orders_;
    Eigen::VectorXd certainty_;
};

}  // namespace ripplenotch
