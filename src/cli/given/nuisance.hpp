// SPDX-License-Identifier: MIT
#pragma once
// What mends a simulation and is nobody's name, as a model states it.

#include <string_view>
#include <vector>

#include "ripplenotch/document/simulated_term.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/model/given_term.hpp"

namespace ripplenotch {

inline constexpr std::string_view nuisance_name = "nuisance";

/// Terms of the inertia and gravity that the model states, and of its offset, which nothing carries. None
/// where all are 0.
void add_nuisance(std::vector<GivenTerm>& terms, const SimulatedTerm& simulated, const Log& log,
                  Seconds smoothing);

}  // namespace ripplenotch
