// SPDX-License-Identifier: MIT
#pragma once
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "analysis/spectrum/pieces.hpp"

namespace ripplenotch {

// One line of a spectrum, measured piece by piece: pieces share its frequency, each has its own phase.

class LineMeter {
  public:
    /// The line is looked for within one bin of `start_hz`, in each piece by Newton's method on the sum
    /// itself.
    LineMeter(double start_hz, double bin_hz) : start_hz_(start_hz), bin_hz_(bin_hz) {}

    /// For many pieces: the parts common to even ones are computed once. Their maxima are then found from the
    /// sum's moments about the start, accurate to 1e-5 of the amplitude and of a bin.
    void expect_even_pieces(std::span<const double> even_time_s);

    void add(const Piece& piece);

    [[nodiscard]] double hz() const;            ///< mean of the pieces' maxima, weighted by their power
    [[nodiscard]] double amplitude_nm() const;  ///< zero to peak, rms over pieces
    [[nodiscard]] double phase_rad()
        const;  ///< phase in cos(2 pi hz t + phase) in the strongest piece, t as in the log

  private:
    struct Maximum {
        double hz = 0.0;
        std::complex<double> sum;
    };
    [[nodiscard]] Maximum search(const Piece& piece) const;
    [[nodiscard]] bool search_moments(const Piece& piece, Maximum& found) const;

    double start_hz_, bin_hz_;
    double half_s_ = 0.0;  // half an even piece; 0 when none are expected
    std::vector<double> place_, cosine_, sine_;
    std::size_t pieces_ = 0;
    double power_ = 0.0, weighted_hz_ = 0.0;
    std::complex<double> strongest_;
    double strongest_middle_s_ = 0.0;
};

}  // namespace ripplenotch
