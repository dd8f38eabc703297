// SPDX-License-Identifier: MIT
#include "ripplenotch/core/biquad.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

std::complex<double> unit_delay(Hertz at, Hertz sample_rate) {
    return portable::polar(1.0, -2.0 * std::numbers::pi * (at / sample_rate));
}

// Group delay of c0 + c1 z^-1 + c2 z^-2 in samples: Re( sum k c_k z^-k / sum c_k z^-k ).
double polynomial_delay(double c0, double c1, double c2, std::complex<double> z1) {
    const auto value = c0 + z1 * (c1 + z1 * c2);
    const auto weighted = z1 * (c1 + 2.0 * z1 * c2);
    return (weighted / value).real();
}

}  // namespace

double dc_gain(const Biquad& f) noexcept { return (f.b0 + f.b1 + f.b2) / (1.0 + f.a1 + f.a2); }

std::complex<double> response(const Biquad& f, Hertz at, SampledAt sampled) {
    const auto z1 = unit_delay(at, sampled.rate);
    return (f.b0 + z1 * (f.b1 + z1 * f.b2)) / (1.0 + z1 * (f.a1 + z1 * f.a2));
}

std::complex<double> response(std::span<const Biquad> cascade, Hertz at, SampledAt sampled) {
    std::complex<double> gain = 1.0;
    for (const Biquad& f : cascade) gain *= response(f, at, sampled);
    return gain;
}

Seconds group_delay(std::span<const Biquad> cascade, Hertz at, SampledAt sampled) {
    const auto z1 = unit_delay(at, sampled.rate);
    double samples = 0.0;
    for (const Biquad& f : cascade) {
        samples += polynomial_delay(f.b0, f.b1, f.b2, z1) - polynomial_delay(1.0, f.a1, f.a2, z1);
    }
    return Seconds(samples / sampled.rate.value());
}

double pole_radius(const Biquad& f) {
    const double discriminant = f.a1 * f.a1 / 4.0 - f.a2;
    if (discriminant < 0.0) return std::sqrt(f.a2);
    return std::abs(f.a1) / 2.0 + std::sqrt(discriminant);
}

double pole_radius(std::span<const Biquad> cascade) {
    double radius = 0.0;
    for (const Biquad& f : cascade) radius = std::max(radius, pole_radius(f));
    return radius;
}

}  // namespace ripplenotch
