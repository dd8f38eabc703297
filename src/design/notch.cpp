// SPDX-License-Identifier: MIT
#include "ripplenotch/design/notch.hpp"

#include <cmath>
#include <numbers>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

void check_notch(const NotchSpec& spec, Hertz sample_rate) {
    if (!std::isfinite(sample_rate.value()) || !(sample_rate.value() > 0.0)) {
        raise<UsageError>("the sample rate is {} Hz; it must be known and above 0 Hz",
                          shortest(sample_rate.value()));
    }
    const double half_rate = 0.5 * sample_rate.value();
    if (!(spec.center.value() > 0.0)) {
        raise<UsageError>("notch centre {} Hz is not above 0 Hz", shortest(spec.center.value()));
    }
    if (!(spec.center.value() < half_rate)) {
        raise<UsageError>("notch centre {} Hz is not below half the sample rate, {} Hz",
                          shortest(spec.center.value()), shortest(half_rate));
    }
    if (!(spec.q > 0.0) || !std::isfinite(spec.q)) {
        raise<UsageError>("notch Q {} is not above 0; the paper's twin-T has Q 0.25", shortest(spec.q));
    }
    if (!(spec.depth_db > 0.0)) {
        raise<UsageError>("notch depth {} dB is not above 0 dB; leave it out for a full null",
                          shortest(spec.depth_db));
    }
    if (spec.width == WidthRule::digital && !(spec.center.value() / spec.q < half_rate)) {
        raise<UsageError>(
            "a digital notch at {} Hz with Q {} is {} Hz wide, not below half the sample rate, {} Hz; raise "
            "Q or "
            "use the analog width rule",
            shortest(spec.center.value()), shortest(spec.q), shortest(spec.center.value() / spec.q),
            shortest(half_rate));
    }
}

}  // namespace

std::string_view width_rule_name(WidthRule rule) { return rule == WidthRule::analog ? "analog" : "digital"; }

Biquad design_notch(const NotchSpec& spec, Hertz sample_rate) {
    check_notch(spec, sample_rate);
    const double omega = 2.0 * std::numbers::pi * (spec.center / sample_rate);
    const double c = portable::cos(omega);
    // The two rules differ in one number: how far the poles stand inside the unit circle. sin(omega) / (2 Q)
    // is the bilinear image of the prototype's damping; tan(omega / (2 Q)) makes the sampled -3 dB points
    // exactly center / Q hertz apart.
    const double alpha = spec.width == WidthRule::analog ? portable::sin(omega) / (2.0 * spec.q)
                                                         : portable::tan(omega / (2.0 * spec.q));
    const double floor_gain = portable::pow(10.0, -spec.depth_db / 20.0);  // exactly 0 for infinite_depth_db
    const double scale = 1.0 / (1.0 + alpha);
    Biquad f;
    f.b0 = (1.0 + floor_gain * alpha) * scale;
    f.b2 = (1.0 - floor_gain * alpha) * scale;
    f.b1 = f.a1 = -2.0 * scale * c;
    // Equal to (1 - alpha) / (1 + alpha), but tied to the rounded numerator so that the gain at 0 Hz stays 1.
    f.a2 = f.b0 + f.b2 - 1.0;
    if (!(pole_radius(f) < 1.0)) {
        raise<UsageError>(
            "a notch at {} Hz with Q {} at a sample rate of {} Hz is too narrow for double precision",
            shortest(spec.center.value()), shortest(spec.q), shortest(sample_rate.value()));
    }
    return f;
}

}  // namespace ripplenotch
