// SPDX-License-Identifier: MIT
#pragma once
#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

// Pieces of a log for spectra: straight line removed, Hann window, transform. One after another in the same
// memory.

/// The result of one pass over a part of an evenly sampled piece, its two columns interleaved: reading them
/// dominates the cost.
struct EvenPart {
    double worst = 0.0;  ///< largest distance of a time from its place, in the unit of time
    double sum = 0.0;
    double tilt = 0.0;  ///< sum of the values times their distance from the part's middle, in samples
    std::size_t count = 0;
};
/// The sums over the samples from `from` on; the even grid begins with time[0] and has steps of `step`.
[[nodiscard]] EvenPart look_at_even(std::span<const double> time, std::span<const double> values, double step,
                                    std::size_t from = 0);
/// Two parts, one behind the other, as one.
[[nodiscard]] EvenPart together(const EvenPart& early, const EvenPart& late);

/// Straight line through values at 0, 1, 2, ... by least squares: mean + slope * (k - (n - 1) / 2).
struct EvenLine {
    double mean = 0.0, slope = 0.0;
};
[[nodiscard]] EvenLine even_line(const EvenPart& values);

/// to[k] = (values[k] - line at k) * window[k].
void subtract_line_and_window(std::span<const double> values, const EvenLine& line,
                              std::span<const double> window, std::span<double> to);

struct Piece {
    std::span<const double> time_s;  ///< from the piece's middle
    std::span<const double> value;   ///< detrended and windowed, Nm
    bool even = false;               ///< time_s is PieceMaker::even_time_s()
    double middle_s = 0.0;
    double window_sum = 0.0, window_square_sum = 0.0;
};

/// Half-overlapping pieces of a log that is handed over a part at a time.
class PieceMaker {
  public:
    PieceMaker(std::size_t length, Hertz rate);

    /// Hands every whole piece of the samples (seconds and Nm) to `use`; a piece holds until the next one.
    /// Returns how many samples are done with: the others are to come again, in front of those that follow
    /// them.
    template <class Use>
    std::size_t for_each(std::span<const double> time_s, std::span<const double> torque_nm, Use use) {
        std::size_t done = 0;
        for (; done + length_ <= time_s.size(); done += hop_) {
            if (ahead_.empty()) look_ahead(time_s.subspan(done), torque_nm.subspan(done));
            use(make(time_s.subspan(done, length_), torque_nm.subspan(done, length_)));
        }
        return done;
    }
    /// The next piece does not follow the one before.
    void begin_again() { late_.reset(); }

    /// The last piece's sums at k * rate / length, 0 Hz to half the rate; valid until the next piece.
    [[nodiscard]] std::span<const std::complex<double>> sums();
    /// Adds to power[k] their squared magnitudes, times `scale`.
    void add_power(double scale, std::span<double> power);

    /// Whether all pieces were even, and surely would have been if the rate had been this one.
    [[nodiscard]] bool even_at(Hertz rate) const;

    [[nodiscard]] std::span<const double> even_time_s() const { return even_time_s_; }

  private:
    const Piece& make(std::span<const double> time_s, std::span<const double> torque_nm);
    void look_ahead(std::span<const double> time_s, std::span<const double> torque_nm);
    EvenPart look_at(std::span<const double> time_s, std::span<const double> torque_nm);
    void make_even(std::span<const double> torque_nm, const EvenLine& line);
    void make_uneven(std::span<const double> time_s, std::span<const double> torque_nm);

    std::size_t length_, hop_;
    double rate_, step_s_;
    RealTransform transform_;
    std::vector<double> even_time_s_, even_window_;
    double even_sum_ = 0.0, even_square_sum_ = 0.0;
    std::vector<double> time_s_, value_;
    std::vector<std::complex<double>> uneven_sums_;
    std::optional<EvenPart> late_;  // the last piece's second half, if that piece was even
    std::vector<EvenPart> ahead_;   // those of the next pieces, last one first
    double worst_s_ = 0.0;          // largest distance from its place of any sample
    Piece piece_;
};

}  // namespace ripplenotch
