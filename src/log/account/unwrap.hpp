// SPDX-License-Identifier: MIT
#pragma once
// Angles that start again at a full turn.

#include <array>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// Removes jumps of whole periods in place, from one angle to the next.
class Unwrapper {
  public:
    explicit Unwrapper(double period) : period_(period) {}
    /// Goes on behind `before_deg`, an angle that was continuous so far.
    Unwrapper(double period, double before_deg) : period_(period), before_(before_deg) {}

    [[nodiscard]] double next(double position_deg);
    void apply(std::span<double> position_deg) {
        for (double& angle : position_deg) angle = next(angle);
    }

  private:
    double period_, turns_ = 0.0;
    std::optional<double> before_;
};

/// Finds out, from angles that go by, whether they start again at a full turn: 360 deg, or what that becomes
/// when the unit is mistaken (2 pi, 360 * 180 / pi). Says also what they are once made continuous.
class WrapWatch {
  public:
    void follow(std::span<const double> position_deg);

    /// Empty when nothing jumps, or when jumps are no full turn.
    [[nodiscard]] std::optional<double> period() const;
    /// Of the angles made continuous, one after another.
    [[nodiscard]] double sum() const { return made().sum; }
    [[nodiscard]] double largest() const { return made().largest; }  ///< magnitude

  private:
    struct Continuous {
        double sum = 0.0, largest = 0.0;
        void add(double angle);
    };
    struct Turn {
        double period;
        bool ruled_out = false;
        std::optional<Unwrapper> unwrapper = std::nullopt;  ///< from the first jump on
        Continuous made = {};
    };
    void look_at(double step, Turn& turn) const;
    [[nodiscard]] const Turn* found() const;
    [[nodiscard]] const Continuous& made() const { return found() != nullptr ? found()->made : raw_; }

    std::array<Turn, 3> turns_ = {{{360.0}, {2.0 * std::numbers::pi}, {360.0 * degrees_per_radian}}};
    std::size_t count_ = 0;
    double low_ = std::numeric_limits<double>::infinity(), high_ = -low_, before_ = 0.0;
    bool jumped_ = false;  ///< some turn has an unwrapper
    Continuous raw_;
};

/// A sentence for the warnings of a log.
[[nodiscard]] std::string wrap_in_words(double period_deg);

[[nodiscard]] std::optional<double> wrap_period(std::span<const double> position_deg);

}  // namespace ripplenotch
