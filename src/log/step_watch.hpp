// SPDX-License-Identifier: MIT
#pragma once
// The steps of a clock, without holding them: what its rate is and where it has gaps.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "log/timebase_warnings.hpp"

namespace ripplenotch {

/// A gap is a step of more than `gap_steps` usual ones, and the usual one is the median, known when all steps
/// have gone by. So gaps are told by a guess of it, and whether the median would have told the same is known
/// in the end: steps that are nearly as long as the limit are rare.
class StepWatch {
  public:
    /// With a guess of the usual step; empty: that of the first times that come.
    explicit StepWatch(double gap_steps, std::optional<double> guess_s = std::nullopt)
        : gap_steps_(gap_steps), guess_s_(guess_s) {}

    /// Times in order, seconds.
    void take(std::span<const double> time_s);

    /// Whether gaps are those that the usual step of all the steps makes.
    [[nodiscard]] bool settled() const;
    /// The usual step has so many advancing steps below it.
    [[nodiscard]] std::size_t usual_rank() const;
    [[nodiscard]] bool advances() const { return zeros_ < count_; }

    [[nodiscard]] double gap_s() const { return gap_steps_ * guess_s_.value_or(0.0); }
    [[nodiscard]] Hertz sample_rate() const;  ///< 0 when no time passes
    /// Rows that gaps and repeated times are shares of; how many are held is not known here.
    [[nodiscard]] const ClockTroubles& troubles() const { return troubles_; }

  private:
    void take(double time_s);
    void take_step(double time_s);

    double gap_steps_;
    std::optional<double> guess_s_, before_s_;
    std::vector<double> early_s_;                               ///< until there is a guess
    std::size_t count_ = 0, zeros_ = 0, below_ = 0, near_ = 0;  ///< steps; near the guess, or below that
    double duration_s_ = 0.0;
    std::size_t counted_ = 0;
    double longest_counted_s_ = 0.0, shortest_gap_s_ = std::numeric_limits<double>::infinity();
    ClockTroubles troubles_;
};

/// The advancing step with so many below it, exactly, from four passes over the times: each finds the next
/// sixteen bits of the number.
class StepOfRank {
  public:
    explicit StepOfRank(std::size_t rank) : rank_(rank), counts_(std::size_t{1} << digit_bits) {}

    void take(std::span<const double> time_s);
    /// After each pass; true when it takes another one.
    bool next_digit();
    [[nodiscard]] double value() const;

  private:
    static constexpr unsigned digit_bits = 16;
    std::size_t rank_;
    std::vector<std::size_t> counts_;
    std::uint64_t known_ = 0;  ///< the digits found, as low bits
    unsigned unknown_bits_ = 64;
    std::optional<double> before_s_;
};

}  // namespace ripplenotch
