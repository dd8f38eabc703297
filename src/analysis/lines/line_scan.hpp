// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: is there a line of an order, or of a frequency, in the sweeps of a log?
// One test over all sweeps, at a stated rate of false alarms (docs/decisions/0040-lines-and-ratios.md).

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "core/matrices/linear_algebra.hpp"

#include "analysis/motion/line_evidence.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Half width of a line and of what is left of it, in 1 / longest sweep: nearer, two lines are one.
inline constexpr double line_cells = 2.5;

/// A line on one of the axes.
struct KnownLine {
    Axis axis = Axis::angle;
    double place = 0.0;  ///< cycles per output turn, or hertz
};

struct ScanRange {
    double lowest = 0.0, highest = 0.0;
    /// The sweeps' smooth part is taken off up to a fifth of this place.
    double smooth = 0.0;
    /// Orders above half the sample rate are searched up to here, in sweeps whose speed distinguishes them
    /// from their images below.
    double highest_folded = 0.0;
};

/// The sweeps of a log on one axis. Each sweep's trend, speed and acceleration are taken off first.
class LineScan {
  public:
    LineScan(std::span<const Sweep> sweeps, std::span<const TraceView> logs, Axis axis, ScanRange range);

    [[nodiscard]] bool empty() const { return count_ == 0; }
    [[nodiscard]] double place(std::size_t k) const { return first_ + step_ * static_cast<double>(k); }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] double lowest() const { return lowest_; }
    [[nodiscard]] double highest() const { return highest_; }
    [[nodiscard]] double longest() const { return longest_; }  ///< sweep, in turns or seconds
    /// The sweeps with what is left of their torque; on the axis of time all have no length in angle.
    [[nodiscard]] std::span<const Sweep> sweeps() const { return sweeps_; }
    /// The evidence that one in 1 / false_alarm logs without a line reaches anywhere.
    [[nodiscard]] double threshold(double false_alarm) const;
    /// Standard deviation of what is left.
    [[nodiscard]] double deviation_nm() const;

    /// -ln of the probability that noise alone shows as much at a place, by the best of three tests: any
    /// phase in each sweep, one phase in all sweeps of a direction, any phase in each half of a sweep.
    [[nodiscard]] const std::vector<double>& score();
    /// After the last score(): how much the noise scatters, which what follows asks for.
    void measure_scatter();
    /// How much the level of the noise may scatter from place to place (variance of its logarithm), and the
    /// evidence of a line under each.
    static constexpr std::array excesses{0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8};
    using Evidences = std::array<double, excesses.size()>;
    [[nodiscard]] Evidences evidences_at(double place) const;
    /// The chance that noise alone gives as much anywhere, where it scatters as that of the last score()
    /// does.
    [[nodiscard]] double false_alarm_of(double place, const Evidences& evidences) const;
    struct Sum {
        double place = 0.0, gain = 0.0;
    };
    /// Where between two places the power summed over a noise of each sweep is largest.
    [[nodiscard]] Sum largest_sum(double from, double to, const LineNoise& noise) const;
    /// The same within a line's width, over the noise of that place.
    [[nodiscard]] double peak_near(double place) const;
    /// The sweep that shows most power over noise at a place.
    [[nodiscard]] const Sweep& strongest_at(double place) const;
    /// As of the last score().
    [[nodiscard]] LineNoise noise_at(double place) const;
    /// The amplitude that is found in 95 of 100 such logs between two places, away from `lines`: lines of
    /// many phases are added to the sums of the last score(), and the test is made again.
    [[nodiscard]] double detectable_nm(double from, double to, double false_alarm,
                                       std::span<const double> lines) const;
    /// The largest amplitude that one sweep shows, and the others do not, between two orders; 0: none does.
    /// What is clear over time is of the orders that the speeds of its sweep make of it.
    [[nodiscard]] double once_nm(double from, double to, double false_alarm) const;
    /// Takes a line of either axis off every sweep, fitted along with the trend.
    void remove(const KnownLine& line);
    /// All lines and the trend fitted to the measured torque of each sweep together, under its window, so
    /// that neighbours do not leak into each other.
    struct Together {
        std::vector<std::vector<std::complex<double>>> nm;  ///< by line and sweep: zero to peak; 0: not shown
        std::vector<Sweep> rest;                            ///< what is left
    };
    [[nodiscard]] Together together(std::span<const KnownLine> lines) const;
    /// Whether noise alone gives a line's amplitudes in less than one of a hundred, given the others.
    [[nodiscard]] bool shows(const KnownLine& line, std::span<const std::complex<double>> nm) const;
    /// Place of a line in what is left and itself.
    [[nodiscard]] double refined_alone(const Together& fit, std::span<const KnownLine> lines,
                                       std::size_t line) const;

  private:
    struct Piece {
        std::vector<double> speed, bend, corner;  ///< scaled to 1; empty at rest
        double start = 0.0, length = 0.0;
        double bottom = 0.0, top = 0.0;             ///< places at which the sweep counts
        double folded_from = 0.0, folded_to = 0.0;  ///< and those above half the sample rate
        double origin = 0.0;                        ///< of the places, where all sweeps of a log have one
        [[nodiscard]] bool shows(double place) const {
            return (place >= bottom && place < top) || (place >= folded_from && place < folded_to);
        }
        std::size_t splines = 0;
        bool forward = true, in_halves = false;
    };
    /// The mean power of the noise at each place, from what is within 20 cells; by how much (ln) what is
    /// within 5 rises above it; and the variances of the logarithms of both.
    struct Noise {
        std::vector<double> power, variance, rise, rise_variance;
    };
    /// Of a sweep, or of one half of it: the sum at each place, its weight and the noise.
    struct Spectrum {
        std::vector<std::complex<double>> sum;
        std::vector<double> power;
        Noise noise;
        double weight = 0.0;
    };
    /// Some spectra, each with its noise and the piece that it is of.
    struct Listed {
        std::vector<std::span<const double>> powers;
        std::vector<Noise*> noises;
        std::vector<const Piece*> pieces;
    };
    /// How probable it is at each place that the noise of some spectra has a hump there; its height (ln).
    struct Humps {
        std::vector<double> chance, rise, variance;
    };
    /// Sum of the scores of some spectra, where they are high all around divided by their median.
    struct Summed {
        std::vector<double> scores, best, sweeps, level, excess;
        Humps humps;
    };
    struct OnePhase {
        std::vector<double> score;
        std::array<std::vector<double>, 2> power;
        std::array<Noise, 2> noise;  ///< by direction; empty without
        std::array<Humps, 2> humps;
        std::array<std::vector<double>, 2> excess;
    };

    /// Least squares of splines, speed and acceleration and of the columns together, with a weight for each
    /// row. Leaves the residual in `torque_nm` and returns the coefficients of the columns.
    Eigen::VectorXd fit_out(std::size_t piece, std::span<const std::vector<double>> columns,
                            std::span<const double> weight, std::span<double> torque_nm) const;
    void take_off(std::size_t piece, std::span<const std::vector<double>> line);
    [[nodiscard]] Spectrum spectrum_of(std::size_t piece, std::size_t begin, std::size_t end) const;
    [[nodiscard]] Noise noise_of(std::span<const double> power, double length, double bottom) const;
    /// By octaves of place: what of the scatter of the noise is not explained by its estimation.
    [[nodiscard]] std::vector<double> excess_of(const Listed& list, const Humps& humps) const;
    [[nodiscard]] std::size_t octave(std::size_t k) const;
    [[nodiscard]] Humps humps_of(const Listed& list) const;
    /// -ln of the probability that noise has that power at a place, with a hump there or without.
    [[nodiscard]] static double score_at(double power, const Noise& noise, const Humps& humps, std::size_t k,
                                         double excess = 0.0);
    [[nodiscard]] std::vector<double> scores(std::span<const double> power, const Noise& noise,
                                             const Humps& humps) const;
    [[nodiscard]] Listed listed(std::span<Spectrum> spectra, bool halves) const;
    [[nodiscard]] Summed summed(std::span<Spectrum> spectra, bool halves) const;
    [[nodiscard]] OnePhase of_one_phase() const;
    [[nodiscard]] std::size_t bin_of(double place) const;
    [[nodiscard]] std::complex<double> turned_to_origin(std::size_t piece, std::size_t k) const;
    struct Excess {
        double free = 0.0, varying = 0.0;
        std::array<double, 2> locked{};
    };
    [[nodiscard]] double evidence_with(std::size_t k, std::complex<double> added_nm,
                                       const Excess& excess) const;
    [[nodiscard]] Excess excess_at(std::size_t k) const;

    Axis axis_;
    std::vector<Sweep> sweeps_;
    std::vector<Piece> pieces_;
    Piece everywhere_;  ///< stands for all pieces where their sums are added
    double lowest_ = 0.0, highest_ = 0.0, longest_ = 0.0;
    double usual_ = 0.0;  ///< length of a sweep: three of four are longer
    double first_ = 0.0, step_ = 0.0;
    std::size_t count_ = 0, first_bin_ = 0;
    std::vector<double> ln_place_;  ///< logarithm of each place
    std::vector<Spectrum> whole_, halves_;
    Summed free_, varying_;
    OnePhase locked_;
    std::vector<double> evidence_;
};

}  // namespace ripplenotch
