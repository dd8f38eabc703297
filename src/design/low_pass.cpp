// SPDX-License-Identifier: MIT
#include "ripplenotch/design/low_pass.hpp"

#include <cmath>
#include <numbers>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr int highest_order = 20;  // by hand

void check_low_pass(const LowPassSpec& spec, Hertz sample_rate) {
    if (!std::isfinite(sample_rate.value()) || !(sample_rate.value() > 0.0)) {
        raise<UsageError>("the sample rate is {} Hz; it must be known and above 0 Hz",
                          shortest(sample_rate.value()));
    }
    if (!(spec.cutoff.value() > 0.0)) {
        raise<UsageError>("low-pass cut-off {} Hz is not above 0 Hz", shortest(spec.cutoff.value()));
    }
    if (!(spec.cutoff.value() < 0.5 * sample_rate.value())) {
        raise<UsageError>("low-pass cut-off {} Hz is not below half the sample rate, {} Hz",
                          shortest(spec.cutoff.value()), shortest(0.5 * sample_rate.value()));
    }
    if (spec.order < 1 || spec.order > highest_order) {
        raise<UsageError>("low-pass order {} is outside 1 to {}", spec.order, highest_order);
    }
}

}  // namespace

Cascade design_low_pass(const LowPassSpec& spec, Hertz sample_rate) {
    check_low_pass(spec, sample_rate);
    const double k = portable::tan(std::numbers::pi * (spec.cutoff / sample_rate));
    Cascade cascade;
    if (spec.order % 2 == 1) {
        Biquad f;
        f.a1 = (k - 1.0) / (k + 1.0);
        f.b0 = f.b1 = 0.5 * (1.0 + f.a1);
        cascade.push_back(f);
    }
    for (int pair = 1; pair <= spec.order / 2; ++pair) {
        // Butterworth poles stand at equal angles on a circle; each pair's damping is twice the cosine of its
        // angle.
        const double damping = 2.0 * portable::sin(std::numbers::pi * (2 * pair - 1) / (2.0 * spec.order));
        const double scale = 1.0 / (1.0 + k * (damping + k));
        Biquad f;
        f.a1 = 2.0 * (k * k - 1.0) * scale;
        f.a2 = (1.0 + k * (k - damping)) * scale;
        // Equal to k^2 * scale, but taken from the rounded poles so that the gain at 0 Hz stays 1.
        f.b0 = f.b2 = 0.25 * (1.0 + f.a1 + f.a2);
        f.b1 = 2.0 * f.b0;
        cascade.push_back(f);
    }
    for (const Biquad& f : cascade) {
        if (!(pole_radius(f) < 1.0) || !(f.b0 > 0.0)) {
            raise<UsageError>("a low-pass at {} Hz at a sample rate of {} Hz is too low for double precision",
                              shortest(spec.cutoff.value()), shortest(sample_rate.value()));
        }
    }
    return cascade;
}

}  // namespace ripplenotch
