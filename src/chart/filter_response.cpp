// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "ripplenotch/chart/comparison_figure.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr int response_points = 600;
constexpr double lowest_share = 1e-4, highest_share = 0.499;  // of the sample rate

// Where a section's zeros lie on the unit circle, if they do.
std::optional<double> null_hz(const Biquad& section, Hertz sample_rate) {
    if (section.b0 == 0.0 || std::abs(section.b2 / section.b0 - 1.0) > 1e-9) return std::nullopt;
    const double cosine = -section.b1 / (2.0 * section.b0);
    if (!(std::abs(cosine) < 1.0)) return std::nullopt;
    return portable::acos(cosine) / (2.0 * std::numbers::pi) * sample_rate.value();
}

}  // namespace

FilterResponse filter_response(std::span<const Biquad> cascade, Hertz sample_rate,
                               std::span<const double> also_hz) {
    FilterResponse result;
    const double lowest = lowest_share * sample_rate.value(), highest = highest_share * sample_rate.value();
    for (int i = 0; i <= response_points; ++i)
        result.hz.push_back(lowest *
                            portable::pow(highest / lowest, static_cast<double>(i) / response_points));
    const auto add = [&](double hz) {
        if (hz > lowest && hz < highest) result.hz.push_back(hz);
    };
    std::vector<double> nulls;
    for (const double hz : also_hz) add(hz);
    for (const Biquad& section : cascade) {
        if (const auto hz = null_hz(section, sample_rate)) {
            nulls.push_back(*hz);
            // The phase jumps here: both sides of it are shown.
            for (const double share : {1.0 - 1e-6, 1.0, 1.0 + 1e-6}) add(share * *hz);
        }
    }
    std::sort(result.hz.begin(), result.hz.end());
    result.hz.erase(std::unique(result.hz.begin(), result.hz.end()), result.hz.end());
    for (const double hz : result.hz) {
        double magnitude = 1.0, phase_rad = 0.0;
        for (const Biquad& section : cascade) {
            const std::complex<double> gain = response(section, Hertz(hz), SampledAt(sample_rate));
            magnitude *= std::abs(gain);
            // A section turns by less than half a turn below half the sample rate, so its phase is not
            // folded.
            phase_rad += portable::arg(gain);
        }
        const double db = magnitude > 0.0 ? 20.0 * portable::log10(magnitude) : lowest_magnitude_db;
        result.magnitude_db.push_back(std::max(db, lowest_magnitude_db));
        const bool at_null = std::any_of(nulls.begin(), nulls.end(),
                                         [hz](double null) { return std::abs(hz / null - 1.0) < 1e-9; });
        result.phase_deg.push_back(at_null ? not_a_number : phase_rad * degrees_per_radian);
        result.group_delay_ms.push_back(
            at_null ? not_a_number : 1e3 * group_delay(cascade, Hertz(hz), SampledAt(sample_rate)).value());
    }
    return result;
}

}  // namespace ripplenotch
