// SPDX-License-Identifier: MIT
#pragma once
// Which effects of the catalogue a diagnosis tries, and what becomes of faults that it must not name.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnose/case/case.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

[[nodiscard]] bool is_among(std::span<const std::string> names, std::string_view name);

/// Whether effects take part that need the joint's position, the gear ratio, or motion in both directions.
struct Examinable {
    bool of_position = true, of_motor = true, of_direction = true;
};

/// Effects that a fit can find; those of the converter are found in the log itself (find_faults).
[[nodiscard]] std::vector<const Effect*> examined(std::span<const std::string> without, Examinable some);

/// Faults whose effect is not among those tried have no name: the samples that they invalidate are
/// unexplained. They are removed from `faults`.
[[nodiscard]] std::vector<ResidualRegion> nameless(std::vector<Fault>& faults,
                                                   std::span<const std::string> without);

/// Measures the residual in invalidated samples, once there is a model of the others.
void measure_at_samples(std::vector<ResidualRegion>& nameless, const Case& c, const Model& stated);

}  // namespace ripplenotch
