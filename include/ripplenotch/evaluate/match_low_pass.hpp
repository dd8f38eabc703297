// SPDX-License-Identifier: MIT
#pragma once
// The low-pass that takes out as much ripple as a method does, so that their delays can be compared like for
// like. The paper compares its notch with one.

#include <optional>

#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {

/// Without a log. `gain` (0 < gain < 1) is output over input rms of the ripple, all lines together at one
/// speed; the cut-off that gives it, or empty when no cut-off above 1e-5 sample rates does. Lines not below
/// half the sample rate are left out. Throws UsageError when none is left.
[[nodiscard]] std::optional<Hertz> cutoff_for_gain(double gain, int order, const GearAccount& lines,
                                                   Hertz sample_rate, DegPerSec speed);

/// Root of the sum over lines of (amplitude times gain of the cascade)^2, over the same without the cascade.
/// Empty when no line is below half the sample rate.
[[nodiscard]] std::optional<double> ripple_gain(std::span<const Biquad> cascade, const GearAccount& lines,
                                                Hertz sample_rate, DegPerSec speed);

/// On a log: the cut-off of the low-pass that leaves `ripple_rms_nm` of the lines' ripple over the measured
/// windows, to one part in 1e5; found by filtering the log again and again. Empty when even the lowest or
/// highest cut-off tried (1e-5 and 0.49 sample rates) leaves more or less than that.
[[nodiscard]] std::optional<Hertz> cutoff_for_ripple(double ripple_rms_nm, int order, const ComparedLog& log,
                                                     const GearAccount& lines);

/// "lowpass,cutoff=2.069Hz,order=1": seven digits, so that the printed method is the one measured.
[[nodiscard]] Spec low_pass_spec(Hertz cutoff, int order);

/// Output over input rms of all lines together, from attenuations that were measured one by one; empty when
/// none was.
[[nodiscard]] std::optional<double> combined_gain(const MethodFigures& figures, const GearAccount& lines);

/// Gains below this (140 dB) count as a complete null, which no low-pass equals.
inline constexpr double complete_null_gain = 1e-7;

/// What --match-lowpass says: the low-pass, or why there is none. `subject` is for the text.
[[nodiscard]] LowPassMatch match_at_speed(const std::string& subject, double gain, int order,
                                          const GearAccount& lines, Hertz sample_rate, DegPerSec speed);
[[nodiscard]] LowPassMatch match_on_log(const std::string& subject, double ripple_rms_nm, int order,
                                        const ComparedLog& log, const GearAccount& lines);

}  // namespace ripplenotch
