// SPDX-License-Identifier: MIT
#pragma once
// What is noted of every row besides its filtering, four rows at a time.

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace ripplenotch {

/// Index of the first value whose step from the value before is not within low < step <= high, as no NaN is;
/// values.size() when all are. The first of all has no step.
[[nodiscard]] std::size_t first_step_outside(std::span<const double> values, double low,
                                             double high) noexcept;

/// Root mean square; 0 of no values.
[[nodiscard]] double rms(std::span<const double> values);

/// Standard deviation of the white noise in values, by the median size of their differences of an order (1:
/// of neighbours, 2: of neighbouring differences), of values so far apart: what is smooth, and a few jumps,
/// do not count. `counts`: whether the difference that ends at a value does; empty: all do. 0 of none, and
/// where half of the values are held.
[[nodiscard]] double noise_from_differences(std::span<const double> values, std::size_t order,
                                            std::size_t apart = 1,
                                            const std::function<bool(std::size_t)>& counts = {});

/// The range of |velocity|.
struct SpeedExtent {
    double slowest_deg_s, fastest_deg_s;
};
/// A velocity that is not a number widens nothing; a range that is none stays as it is.
void widen(SpeedExtent& range, std::span<const double> velocity_deg_s) noexcept;
/// The largest |velocity|; 0 of none.
[[nodiscard]] double fastest_of(std::span<const double> velocity_deg_s) noexcept;

/// Pairs of a row and the next by what is equal in them; counted where both rows move.
struct RepeatCounts {
    std::size_t moving = 0, velocity = 0, position = 0, torque = 0;
    std::size_t velocity_and_torque = 0, position_and_torque = 0, all = 0;

    RepeatCounts& operator+=(const RepeatCounts& more) noexcept;
};

/// Rows of one joint, one after another.
struct RowChannels {
    const double* velocity_deg_s;
    const double* torque_nm;
    const double* position_deg;  ///< or null; then no position repeats
};
/// Counts the repeats in `pairs` + 1 rows. Faster than `moving_deg_s` is moving.
[[nodiscard]] RepeatCounts count_repeats(const RowChannels& rows, std::size_t pairs,
                                         double moving_deg_s) noexcept;

// Series whose times are not regular.

/// The median of the steps between times.
[[nodiscard]] double usual_step_s(std::span<const double> time_s);

/// Values at rising places, linear between known ones; constant beyond the ends. `known` rises, equal places
/// are allowed.
[[nodiscard]] std::vector<double> interpolate(std::span<const double> known, std::span<const double> values,
                                              std::span<const double> places);

}  // namespace ripplenotch
