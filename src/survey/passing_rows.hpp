// SPDX-License-Identifier: MIT
#pragma once
// Internal to the survey room: what is said of a joint's rows, found out while they go by.

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "ripplenotch/log/passes.hpp"
#include "ripplenotch/survey/survey.hpp"

namespace ripplenotch {

class PassingRows {
  public:
    /// `facts` of the log that will go by; the means are of as few rows as `most_means` allow.
    PassingRows(const LogFacts& facts, std::size_t most_means);
    void add(const TraceView& rows);

    [[nodiscard]] std::optional<Range> speed_deg_s() const { return speed_.range(); }
    [[nodiscard]] std::optional<Range> torque_nm() const { return torque_.range(); }
    /// Of the joint, both directions added up.
    [[nodiscard]] double turns() const;
    /// Means of so many consecutive rows each, as a trace of its own, at a rate that is as much lower.
    [[nodiscard]] Trace take_means();

  private:
    /// Of a signal whose first value is a number.
    struct Extremes {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        bool any = false, known = false;
        void add(double value);
        [[nodiscard]] std::optional<Range> range() const;
    };
    struct Sums {
        std::size_t rows = 0;
        double time_s = 0.0, velocity_deg_s = 0.0, torque_nm = 0.0, position_deg = 0.0;
    };
    void add_turns(const TraceView& rows, std::size_t k);
    void end_mean();

    std::size_t rows_, in_mean_, stride_, at_ = 0;
    double rate_hz_;
    Extremes speed_, torque_;
    double moved_deg_ = 0.0, strode_from_deg_ = 0.0;
    bool by_position_ = false, begins_run_ = false;
    Sums sums_;
    Trace means_;
};

}  // namespace ripplenotch
