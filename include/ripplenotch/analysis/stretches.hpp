// SPDX-License-Identifier: MIT
#pragma once
// Stretches of a log in which the joint keeps its speed: where the paper's method, a DFT per speed, may be
// used.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

struct Stretch {
    std::size_t first = 0, count = 0;
    Seconds duration;
    /// Signed mean: the slope of position over time where there is one, else mean velocity, each weighed as
    /// the window of a spectrum weighs the torque.
    DegPerSec speed;
    double speed_error_deg_s = 0.0;  ///< standard error of that mean
    bool rest = false;               ///< standstill
    /// Mean and standard deviation of |speed| over the angle that is turned: standstill does not count, and
    /// white noise of the velocity is subtracted. 0 where hardly anything is turned.
    double turning_deg_s = 0.0, turning_spread_deg_s = 0.0;
    static constexpr double largest_spread =
        0.1;  ///< share of the mean, beyond which a line of an order is smeared
    /// True where the speed changes so much that what turns with the joint is no line over frequency.
    [[nodiscard]] bool smears_orders() const { return turning_spread_deg_s > largest_spread * turning_deg_s; }
};

/// Speeds up to this are standstill: 1 % of the log's highest smoothed speed, or the
/// noise of the velocity at standstill that remains after smoothing; all speeds in a log without motion.
[[nodiscard]] double standstill_deg_s(const TraceView& trace, std::span<const double> smoothed_speed);

/// Parts in which the speed, averaged over 0.1 s, stays within 5 % of its middle value to both sides, or is
/// standstill, for `at_least`: the longest stretch, then the longest that does not overlap it, and so on; in
/// time order. O(n log n).
[[nodiscard]] std::vector<Stretch> steady_stretches(const TraceView& trace, Seconds at_least = Seconds(1.0));

/// One stretch made of all samples, whatever the speed does.
[[nodiscard]] Stretch whole_log(const TraceView& trace);

/// whole_log() of rows that go by.
class StretchMeter {
  public:
    /// So many rows will come, with these mean values; the position's is 0 where there is none.
    StretchMeter(std::size_t count, Seconds mean_time, Degrees mean_position)
        : count_(count), mean_s_(mean_time.value()), mean_position_deg_(mean_position.value()) {}
    void add(const TraceView& rows);
    [[nodiscard]] Stretch stretch(Hertz rate) const;

  private:
    static constexpr std::size_t blocks = 10;  ///< chosen, not derived: block means, for the spread
    /// Sums for a line through weighed places in seconds and degrees.
    class Slope {
      public:
        void add(double t, double p, double weight);
        [[nodiscard]] double weight() const { return sum_; }
        [[nodiscard]] double tt() const { return tt_ - t_ * t_ / sum_; }
        [[nodiscard]] double tp() const { return tp_ - t_ * p_ / sum_; }
        [[nodiscard]] double pp() const { return pp_ - p_ * p_ / sum_; }
        [[nodiscard]] double square_t() const { return square_t_; }

      private:
        double sum_ = 0.0, t_ = 0.0, p_ = 0.0, tt_ = 0.0, tp_ = 0.0, pp_ = 0.0, square_t_ = 0.0;
    };
    [[nodiscard]] std::size_t end_of(std::size_t block) const { return count_ * (block + 1) / blocks; }
    void end_block();
    void speed_from_velocity(Stretch& stretch) const;
    void speed_from_position(Stretch& stretch) const;
    void turning_speed(Stretch& stretch, Hertz rate) const;

    std::size_t count_;
    double mean_s_, mean_position_deg_;
    bool has_position_ = false;
    std::size_t rows_ = 0, block_ = 0;
    double first_s_ = 0.0, last_s_ = 0.0;
    double block_weight_ = 0.0, block_sum_ = 0.0;  ///< sums of the current block
    double weight_ = 0.0, squared_weight_ = 0.0, sum_ = 0.0, square_ = 0.0;
    Slope slope_;
    double speeds_ = 0.0, squares_ = 0.0, cubes_ = 0.0;  ///< sums of powers of |speed|
    /// Velocity of the last row, and its change from the row before.
    double velocity_deg_s_ = 0.0, change_deg_s_ = 0.0;
    double bends_deg_s_ = 0.0;  ///< sum of the sizes of changes of that change
};

/// Mean of `values` over `width` samples around each (odd width; shorter at the ends). O(n).
[[nodiscard]] std::vector<double> moving_mean(std::span<const double> values, std::size_t width);

}  // namespace ripplenotch
