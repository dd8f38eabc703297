// SPDX-License-Identifier: MIT
#include "ripplenotch/design/transient.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr double longest_run = 5e7;  // samples; about half a second of work per section

}  // namespace

std::size_t samples_to_settle(std::span<const Biquad> cascade, double remainder) {
    const double radius = pole_radius(cascade);
    if (!(radius < 1.0)) raise<UsageError>("the filter is unstable: a pole at radius {}", shortest(radius));
    // What is left after n samples is at most about (n / tau)^(order - 1) / (order - 1)! * exp(-n / tau).
    // Three more time constants per order make up for the polynomial, twenty for unfavourable residues.
    const double orders = 2.0 * static_cast<double>(cascade.size());
    const double time_constants = 20.0 - std::log(remainder) + 3.0 * orders;
    const double count = radius < 1e-3 ? 0.0 : time_constants / -std::log(radius);
    if (!(count < longest_run)) {
        raise<UsageError>(
            "the filter needs {:.3g} samples to settle, too many to measure (limit {:.3g}); its Q is "
            "too high or its cut-off too low for this sample rate",
            count, longest_run);
    }
    return static_cast<std::size_t>(count) + 8 * cascade.size() + 8;
}

StepFigures measure_step(std::span<const Biquad> cascade, Hertz sample_rate, double band_percent) {
    if (!(band_percent > 0.0 && band_percent < 100.0)) {
        raise<UsageError>("settling band {} % is outside 0 to 100 %", shortest(band_percent));
    }
    if (!(sample_rate.value() > 0.0)) {
        raise<UsageError>("the sample rate is {} Hz; it must be above 0 Hz", shortest(sample_rate.value()));
    }
    double target = 1.0;
    for (const Biquad& f : cascade) target *= dc_gain(f);
    const double band = std::abs(target) * band_percent / 100.0;
    const std::size_t count = samples_to_settle(cascade, band_percent / 100.0);
    std::vector<BiquadState> states(cascade.size());
    std::size_t settled = 0;
    double peak = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        double y = 1.0;
        for (std::size_t i = 0; i < cascade.size(); ++i) y = step(cascade[i], states[i], y);
        if (!(std::abs(y - target) <= band)) settled = k + 1;
        peak = std::max(peak, y / target);
    }
    // Below a millionth of a per cent it is rounding, not overshoot.
    const double overshoot = 100.0 * (peak - 1.0);
    return {Seconds(static_cast<double>(settled) / sample_rate.value()), overshoot > 1e-6 ? overshoot : 0.0};
}

}  // namespace ripplenotch
