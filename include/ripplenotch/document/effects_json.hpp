// SPDX-License-Identifier: MIT
#pragma once
// The catalogue of effects for programs: what ripplenotch effects --json prints.

#include <span>
#include <string>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

/// {"schema": "ripplenotch/effects/1", "effects": [...]}; docs/commands/effects.md names the fields.
[[nodiscard]] std::string write_catalogue(std::span<const Effect* const> effects,
                                          const Provenance& provenance);

}  // namespace ripplenotch
