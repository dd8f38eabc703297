// SPDX-License-Identifier: MIT
#pragma once
// The declarations of every effect's record; seen by the effects' own files and by the catalogue alone.

#include "ripplenotch/model/effect.hpp"

namespace ripplenotch::effects {
#define EFFECT(name) extern const Effect name;
#include "model/effects/effects.def"
#undef EFFECT
}  // namespace ripplenotch::effects
