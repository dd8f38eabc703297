// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: fixed tones that are multiples of one frequency.

#include <optional>
#include <span>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

/// A fixed tone and the standard error of its frequency.
struct Tone {
    double hz = 0.0, error_hz = 0.0;
};

/// The family that explains most of the tones: three multiples or more of one frequency, up to 12, that meet
/// so many tones by chance less than once in 150 cases.
[[nodiscard]] std::optional<ToneFamily> family_of(std::span<const Tone> tones);

}  // namespace ripplenotch
