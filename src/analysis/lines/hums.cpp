// SPDX-License-Identifier: MIT
#include "analysis/lines/hums.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

constexpr std::size_t most_hums = 3;  // by hand: a list that a person reads
constexpr double near_share = 0.05;   // of a line's frequency: a hump so near is the line, smeared
constexpr int harmonics = 2;          // multiples of a line that are taken as its own, too
constexpr double smeared_share =
    0.2;  // by hand: of its frequency; a speed that is steady smears no line so far

/// Where a line runs while the joint goes at a speed.
double hz_of(const Line& line, double speed_deg_s) {
    if (line.order_output && speed_deg_s != 0.0) return *line.order_output * std::abs(speed_deg_s) / 360.0;
    return line.hz.value_or(0.0);
}

bool of_a_line(const SpectralHump& hump, const std::vector<Line>& lines, double speed_deg_s) {
    if (hump.to_hz - hump.from_hz > smeared_share * hump.peak_hz) return false;
    return std::any_of(lines.begin(), lines.end(), [&](const Line& line) {
        for (int n = 1; n <= harmonics; ++n) {
            const double hz = n * hz_of(line, speed_deg_s);
            if (std::abs(hz - hump.peak_hz) <= near_share * hz) return true;
        }
        return false;
    });
}

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

std::vector<Hum> hums_beside(const Looked& looked, const std::vector<Line>& lines) {
    double ripple_nm = 0.0;
    for (const Line& line : lines) {
        if (line.kind != LineKind::tone) ripple_nm = std::max(ripple_nm, line.amplitude_nm);
    }
    std::vector<Hum> hums;
    if (looked.steady) {
        for (const StretchLines& one : looked.steady->stretches) {
            const double speed = one.stretch.rest ? 0.0 : one.stretch.speed.value();
            for (const SpectralHump& hump : one.humps) {
                if (!of_a_line(hump, lines, speed)) add(hump, hums);
            }
        }
    }
    if (looked.motion) {
        // What lines leave of a sweep has no one speed: humps of theirs are smaller than the lines.
        for (const SpectralHump& hump : looked.motion->humps) add(hump, hums);
    }
    // A sine of this amplitude has as much torque in it.
    std::erase_if(hums, [&](const Hum& hum) { return std::sqrt(2.0) * hum.rms_nm <= ripple_nm; });
    std::stable_sort(hums.begin(), hums.end(),
                     [](const Hum& a, const Hum& b) { return a.rms_nm > b.rms_nm; });
    if (hums.size() > most_hums) hums.resize(most_hums);
    return hums;
}

}  // namespace ripplenotch
