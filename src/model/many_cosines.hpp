// SPDX-License-Identifier: MIT
#pragma once
// Cosines of an angle at every sample, in rooms that stay in the first cache.

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

/// use(k, cosine of angle_deg(k)) for each sample k.
template <class AngleDeg, class Use>
void with_cosines(std::size_t samples, AngleDeg angle_deg, Use use) {
    std::array<double, 256> angles{}, cosines{};
    for (std::size_t first = 0; first < samples; first += angles.size()) {
        const std::size_t count = std::min(angles.size(), samples - first);
        for (std::size_t i = 0; i < count; ++i) angles[i] = angle_deg(first + i);
        portable::cos_degrees(std::span(angles).first(count), cosines);
        for (std::size_t i = 0; i < count; ++i) use(first + i, cosines[i]);
    }
}

/// use(k, cosine, sine) of angle_deg(k) for each sample k.
template <class AngleDeg, class Use>
void with_cosines_and_sines(std::size_t samples, AngleDeg angle_deg, Use use) {
    std::array<double, 256> angles{}, cosines{}, sines{};
    for (std::size_t first = 0; first < samples; first += angles.size()) {
        const std::size_t count = std::min(angles.size(), samples - first);
        for (std::size_t i = 0; i < count; ++i) angles[i] = angle_deg(first + i);
        portable::cos_degrees(std::span(angles).first(count), cosines);
        portable::sin_degrees(std::span(angles).first(count), sines);
        for (std::size_t i = 0; i < count; ++i) use(first + i, cosines[i], sines[i]);
    }
}

}  // namespace ripplenotch
