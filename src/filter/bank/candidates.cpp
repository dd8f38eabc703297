// SPDX-License-Identifier: MIT
#include <algorithm>

#include "filter/run/transition.hpp"

namespace ripplenotch {

Candidates::Candidates(std::span<const Band> bands) {
    for (const Band& band : bands) {
        cascades.push_back(band.cascade());
        sections = std::max(sections, cascades.back().size());
    }
    for (Cascade& cascade : cascades) cascade.resize(sections);  // a default Biquad is neutral
    for (const Cascade& cascade : cascades) {
        const auto first = std::find(cascades.begin(), cascades.end(), cascade);
        same_as.push_back(static_cast<int>(first - cascades.begin()));
    }
}

bool Candidates::same(int a, int b) const noexcept {
    if (a == b) return true;
    if (a == no_candidate || b == no_candidate) return false;
    return same_as[static_cast<std::size_t>(a)] == same_as[static_cast<std::size_t>(b)];
}

}  // namespace ripplenotch
