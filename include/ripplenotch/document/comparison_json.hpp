// SPDX-License-Identifier: MIT
#pragma once
// What compare found, as JSON.

#include <string>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {

/// The whole text; schema ripplenotch/comparison/1. A figure that was not measured is null.
[[nodiscard]] std::string comparison_text(const Comparison& comparison, const Provenance& provenance);

}  // namespace ripplenotch
