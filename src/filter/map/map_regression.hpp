// SPDX-License-Identifier: MIT
#pragma once
// One order's amplitudes regressed on the columns of a form, with any block of windows left out.

#include <complex>
#include <cstddef>
#include <vector>

#include "core/matrices/linear_algebra.hpp"
#include "filter/map/map_data.hpp"

namespace ripplenotch {

/// Squares by block, each over the noise: of what is there, and of what is left beside the map.
struct HeldOut {
    std::vector<double> there, left;
    double noise = 0.0;     ///< the same of the noise, all blocks
    double unit_nm2 = 0.0;  ///< what a sum of 1 is in Nm^2, as a mean over the windows
};

/// Ridge regression: of the amplitudes the prior knows that those of neighbouring speeds and of the two
/// directions differ by about the order's own amplitude, and that those of the joint's turn, of the load and
/// of the temperature are half of it.
class MapRegression {
  public:
    MapRegression(const MapData& data, const RippleMap& frame, std::size_t order);

    /// By column, from all windows.
    [[nodiscard]] std::vector<std::complex<double>> values() const;
    /// Standard errors of both parts: the larger of what noise makes and of what the spread of blocks shows.
    [[nodiscard]] std::vector<std::complex<double>> errors() const;
    /// Each block foretold from the others.
    [[nodiscard]] HeldOut held_out() const;
    [[nodiscard]] std::complex<double> foretold(std::size_t window,
                                                const std::vector<std::complex<double>>& values) const;
    [[nodiscard]] double weight(std::size_t window) const { return weight_[window]; }

  private:
    using Matrix = Eigen::MatrixXd;  ///< a right side has two columns: cosine and sine parts
    [[nodiscard]] Matrix penalty(const RippleMap& frame) const;

    const MapData& data_;
    std::size_t order_;
    Matrix columns_;  ///< by window
    std::vector<double> weight_;
    Matrix gram_, right_;
    std::vector<Matrix> block_gram_, block_right_;
};

}  // namespace ripplenotch
