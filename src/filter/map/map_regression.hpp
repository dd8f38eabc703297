// SPDX-License-Identifier: MIT
#pragma once
// What a map is fitted to, and one order's amplitudes regressed on the columns of a form, with any blocks of
// windows left out.

#include <complex>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/matrices/linear_algebra.hpp"
#include "filter/ripple_keys.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

// The amplitudes of every few periods of the lowest order of all logs, in blocks.

/// Amplitudes of all orders in a window, in the form of RippleMap.
struct MapWindow {
    MapState state;  ///< means
    std::vector<std::complex<double>> value;
    std::vector<double> noise;  ///< by order: mean square of the noise in `value`
    std::size_t block = 0, log = 0;
    SampleRun rows;
    bool scored = true;  ///< it shares no sample with another block
};

/// Blocks are windows in a row, of one log each.
struct MapData {
    std::vector<MapWindow> windows;
    RippleMap frame;       ///< gear ratio, orders, zero and the ranges of the windows, without values
    RippleOrders counted;  ///< the orders by which windows are cut and their turns count
    std::size_t blocks = 0;
};

/// Angles count from `zero_deg`.
[[nodiscard]] MapData map_data(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg);

/// Finding, scores, notes and the form of the map, of data that have a window. `false_alarm`: probability
/// that a log without ripple has a map. Where `fit` is not anchored the joint's own angle is not known, and a
/// second comb means nothing.
void choose_map(const MapData& data, double false_alarm, MapFit& fit);

/// Sums of squares over the scored windows, in units of the noise variance.
struct MapSquares {
    double total = 0.0;    ///< sum of squares of the amplitudes
    double noise = 0.0;    ///< expected of noise alone
    double weights = 0.0;  ///< a sum of 1 is 1 / weights Nm^2, as a mean over the windows
};

/// The amplitudes of one order by window, Nm.
[[nodiscard]] Eigen::VectorXcd amplitudes_of(const MapData& data, std::size_t order);

/// Ridge regression. Its prior is a random walk: from the slowest to the fastest speed, and from one
/// direction to the other, an amplitude changes by about the order's own amplitude, however many speeds there
/// are in between.
class MapRegression {
  public:
    MapRegression(const MapData& data, const MapForm& form, std::size_t order);
    /// The same of other amplitudes, one for each window.
    MapRegression(const MapData& data, const MapForm& form, std::size_t order,
                  const Eigen::VectorXcd& values);

    /// By column, from all blocks but those `left_out` (by number; nothing: from all).
    [[nodiscard]] Eigen::VectorXcd values(const std::vector<bool>& left_out = {}) const;
    /// Standard errors of both parts: the larger of the error from noise and that from the spread of blocks.
    [[nodiscard]] std::vector<std::complex<double>> errors() const;
    [[nodiscard]] MapSquares squares(std::size_t block) const { return blocks_[block].squares; }
    /// Products with the prediction of `values` in a block: weighted with the amplitudes, and with itself.
    [[nodiscard]] std::pair<std::complex<double>, double> products(std::size_t block,
                                                                   const Eigen::VectorXcd& values) const;
    /// Residual squares of block `column` when it and block `row` are left out of the fit. The diagonal is
    /// cross-validation; the other columns of a row choose a form for block `row` without having seen it.
    [[nodiscard]] Eigen::MatrixXd residuals() const;
    /// The Hermitian form Q for which u* Q u is the reduction of the squares of left-out blocks, all
    /// amplitudes of block b turned by the unit phasor u_b.
    [[nodiscard]] Eigen::MatrixXcd reduction() const;
    /// The reduction with all phases as they are, the sum of that form's entries, of each column of
    /// amplitudes that are as large as this regression's, one row for each window.
    [[nodiscard]] Eigen::VectorXd reductions(const Eigen::MatrixXcd& values) const;
    [[nodiscard]] double noise() const { return noise_; }    ///< mean over the windows, Nm^2
    [[nodiscard]] double energy() const { return energy_; }  ///< the same of the squared amplitudes

  private:
    using Matrix = Eigen::MatrixXcd;
    using Vector = Eigen::VectorXcd;
    struct Block {
        Matrix gram, scored_gram;
        Vector right, scored_right;
        MapSquares squares;
        std::vector<Eigen::Index> windows = {}, scored = {};  ///< by number
    };
    [[nodiscard]] Eigen::MatrixXd penalty(const RippleMap& frame) const;

    double noise_ = 0.0, energy_ = 0.0;
    Matrix weighted_;  ///< the form's columns at each window, times its weight: a column for each window
    Matrix gram_;
    Vector right_;
    std::vector<Block> blocks_;
};

}  // namespace ripplenotch
