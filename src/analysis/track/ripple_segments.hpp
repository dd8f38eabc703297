// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <complex>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "analysis/track/window_fit.hpp"
#include "ripplenotch/analysis/ripple_meter.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

// Internal to the analysis module: the ripple of a known gear in segments of motion, which estimate_ripple()
// and RippleMeter sum up.

/// Bins on each side of an order at which its noise is measured.
inline constexpr std::size_t probes_a_side = 6;

/// Where one segment lies and what all its orders share.
struct SegmentPlace {
    double weight = 0.0;  ///< angle under the window, up to a factor that all rows of a log share
    double turns = 0.0, seconds = 0.0;
    double slowest_deg_s = 0.0, fastest_deg_s = 0.0;
    double mean_deg_s = 0.0;  ///< as the window weighs its rows; signed
};

/// What one segment has at one order.
struct SegmentAmplitude {
    SegmentPlace place;
    std::vector<std::complex<double>> value;  ///< per signal: a - ib of a cos + b sin
    double inflation = 1.0;      ///< variance inflation, since neighbours and trend are fitted along
    double expected_gain = 0.0;  ///< gain from LineGains; 0 without
    /// Power near the order, first signal; nan where it was not measured.
    std::array<double, 2 * probes_a_side> noise{};
};

struct OrderSegments {
    std::vector<SegmentAmplitude> segments;
    bool collinear = false, few_samples = false;  ///< in a segment that holds enough periods
    bool absolute_angle = true;                   ///< in all segments
};

/// What one segment has of one torque signal, whatever the order.
struct SegmentResidual {
    double weight = 0.0;
    double square_nm2 = 0.0;  ///< torque minus trend, weighted mean
    /// Peak to peak of that and of the lines, middle half.
    double peak_to_peak_nm = 0.0, ripple_peak_to_peak_nm = 0.0;
};

class RippleSegments {
  public:
    struct Options {
        std::size_t signals = 1;
        bool noise = false;      ///< SegmentAmplitude::noise is wanted ...
        bool residuals = false;  ///< ... and residuals() are
        bool courses = false;    ///< courses() are wanted
        LineGains gains = {};
    };
    /// Throws UsageError for a ratio or an order that is not above 0.
    RippleSegments(GearRatio ratio, std::span<const Order> orders, Options options);

    /// The amplitude of one order row by row: the fits of the windows, weighted as they weigh their rows.
    struct Course {
        std::vector<std::complex<double>> amplitude;  ///< sum of weighted SegmentAmplitude::value
        std::vector<double> weight;                   ///< sum of weights: 0 where no window lies
    };

    /// Measures a log, or a part of one whose first rows `seen_before` were in the part before, with its own
    /// torque as the first signal and further ones after it. Returns the row from which a part that follows
    /// has to begin: that of half a segment before the end where the joint still moves, else the end.
    std::size_t add(const TraceView& rows, std::span<const std::span<const double>> further = {},
                    std::size_t seen_before = 0);

    [[nodiscard]] const OrderSegments& of(Order order) const;
    /// Per signal, of all segments that hold the most orders.
    [[nodiscard]] const std::vector<std::vector<SegmentResidual>>& residuals() const { return residuals_; }
    /// Per order, rising, of the latest add(); every window counts.
    [[nodiscard]] const std::vector<Course>& courses() const { return courses_; }
    [[nodiscard]] std::size_t orders() const { return orders_.size(); }
    [[nodiscard]] double order(std::size_t i) const { return orders_[i]; }  ///< rising
    [[nodiscard]] bool has_gains() const { return static_cast<bool>(options_.gains); }
    /// Rows in segments that hold the lowest order.
    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t too_few_samples() const { return too_few_samples_; }
    /// Speed below which an order stayed under half the sample rate; above all speeds where it always did.
    [[nodiscard]] double limit_deg_s(Order order) const { return 0.5 * rate_turns_deg_s_ / order.value(); }
    [[nodiscard]] double fastest_deg_s() const { return fastest_deg_s_; }

  private:
    struct Part;
    [[nodiscard]] bool keeps(std::size_t samples);
    void measure(const Part& part, const SampleRun& window, std::size_t last, bool shared);
    void measure_residuals(const WindowFit& fit, std::span<const WindowFit::Torque> torques);
    /// Per order.
    [[nodiscard]] std::vector<double> expected_gains(const Part& part, const SampleRun& window) const;

    double ratio_;
    std::vector<double> asked_, orders_;  ///< as handed over; rising
    Options options_;
    double longest_turns_;
    std::vector<OrderSegments> gathered_;
    std::vector<std::vector<SegmentResidual>> residuals_;
    std::vector<Course> courses_;
    std::size_t stride_ = 1, seen_ = 0, samples_ = 0, rows_ = 0, too_few_samples_ = 0;
    double fastest_deg_s_ = 0.0, rate_turns_deg_s_ = std::numeric_limits<double>::max();
};

}  // namespace ripplenotch
