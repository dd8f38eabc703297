// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: what looks like an order by accident. Of fixed tones that are multiples of
// one frequency, the third and fourth look like one order at two speeds of which one is 4/3 of the other.

#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/steady_lines.hpp"

namespace ripplenotch {

/// Half the width of what counts as one order, in hertz at the second of the two.
[[nodiscard]] double order_allowance_hz(const Sighting& first, const Sighting& second);

/// The tones of a family that explains its sightings better than the orders among `lines` do, and marks them
/// as used; none where no family does.
[[nodiscard]] std::vector<SteadyLine> tones_instead(std::span<const Sighting> all,
                                                    std::span<const StretchLines> stretches,
                                                    std::span<const SteadyLine> lines,
                                                    std::vector<bool>& used);

/// An order of two speeds that unrelated lines would share as likely is none: each sighting stays alone.
void part_accidents(std::span<const Sighting> all, std::vector<SteadyLine>& lines);

struct Tone {
    double hz = 0.0, error_hz = 0.0;
};
/// The best family among tones; empty where chance does as well.
[[nodiscard]] std::optional<ToneFamily> family_of(std::span<const Tone> tones);

}  // namespace ripplenotch
