// SPDX-License-Identifier: MIT
#pragma once
// Filters as firmware and drives describe them: by frequency, width and depth instead of coefficients.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/export/filter_set.hpp"

namespace ripplenotch {

/// Q of a notch with its centre and lower -3 dB frequency: f fc / (f^2 - fc^2) (Betaflight), and back.
[[nodiscard]] double q_from_cutoff(double center_hz, double cutoff_hz);
[[nodiscard]] double cutoff_from_q(double center_hz, double q);

/// Q of a notch whose -3 dB band begins half `bandwidth_hz` below its centre, over the octaves from there
/// (ArduPilot); the same number as q_from_cutoff(f, f - bandwidth / 2). And back.
[[nodiscard]] double q_from_bandwidth(double center_hz, double bandwidth_hz);
[[nodiscard]] double bandwidth_from_q(double center_hz, double q);

/// What all notches of a set share where a target has one width and one depth for all.
struct SharedShape {
    double q = 1.0;
    double gain = 0.0;  ///< at the centre; 0 for a full null
};
/// Throws UsageError, naming `target`, for low-passes, for Q or depth that differ, and for the digital width
/// rule, whose notches are no analogue prototypes.
[[nodiscard]] SharedShape shared_shape(const FilterSet& filters, std::string_view target);

/// Orders as whole numbers from 1 to `highest`, for a table; throws UsageError for others.
[[nodiscard]] std::vector<int> whole_orders(const FilterSet& filters, int highest, std::string_view target);

/// Whether the ranges of the firmware's own parameters are kept.
inline constexpr std::array<std::string_view, 2> limit_choices = {"firmware", "none"};
inline constexpr Key limits_key = {.name = "limits",
                                   .kind = KeyKind::choice,
                                   .default_text = "firmware",
                                   .choices = limit_choices,
                                   .help =
                                       "firmware: refuse what its own parameters cannot hold; none: for "
                                       "other firmware in this style"};
/// Throws UsageError when `value` is outside lowest..highest and the limits are the firmware's.
void check_range(const Settings& settings, std::string_view parameter, double value, double lowest,
                 double highest, std::string_view remedy);

}  // namespace ripplenotch
