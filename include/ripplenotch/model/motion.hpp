// SPDX-License-Identifier: MIT
#pragma once
// Motions for simulate: "constant,speed=60deg/s,duration=5s", "poly6,from=90deg,to=-90deg,duration=2s".

#include <span>
#include <string_view>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

struct MotionKind {
    std::string_view name, summary, source;
    std::span<const Key> keys;
    Motion (*make)(const Settings& settings, Hertz sample_rate, GearRatio ratio) = nullptr;
};

[[nodiscard]] std::span<const MotionKind> motion_kinds();
/// Throws UsageError with the nearest name.
[[nodiscard]] Motion make_motion(std::string_view spec, Hertz sample_rate, GearRatio ratio);

}  // namespace ripplenotch
