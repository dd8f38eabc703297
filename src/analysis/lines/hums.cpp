// SPDX-License-Identifier: MIT
#include "analysis/lines/hums.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

constexpr std::size_t most_hums = 3;  // by hand: a list that a person reads

/// Of humps that overlap, the one with most torque.
void add(const SpectralHump& hump, std::vector<Hum>& hums) {
    const Hum hum{hump.from_hz, hump.to_hz, hump.peak_hz, hump.rms_nm};
    const auto same = std::find_if(hums.begin(), hums.end(), [&](const Hum& known) {
        return known.from_hz <= hum.to_hz && hum.from_hz <= known.to_hz;
    });
    if (same == hums.end()) {
        hums.push_back(hum);
    } else if (hum.rms_nm > same->rms_nm) {
        *same = hum;
    }
}

}  // namespace

std::vector<Hum> hums_beside(const MotionLines& motion, const std::vector<Line>& lines) {
    double ripple_nm = 0.0;
    for (const Line& line : lines) {
        if (line.kind != LineKind::tone) ripple_nm = std::max(ripple_nm, line.amplitude_nm);
    }
    std::vector<Hum> hums;
    // What lines leave of a sweep has no one speed: humps of theirs are smaller than the lines.
    for (const SpectralHump& hump : motion.humps) add(hump, hums);
    // A sine of this amplitude has as much torque in it.
    std::erase_if(hums, [&](const Hum& hum) { return std::sqrt(2.0) * hum.rms_nm <= ripple_nm; });
    std::stable_sort(hums.begin(), hums.end(),
                     [](const Hum& a, const Hum& b) { return a.rms_nm > b.rms_nm; });
    if (hums.size() > most_hums) hums.resize(most_hums);
    return hums;
}

}  // namespace ripplenotch
