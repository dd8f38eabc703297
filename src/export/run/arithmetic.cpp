// SPDX-License-Identifier: MIT
#include "ripplenotch/export/arithmetic.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "export/run/structure.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

template <class Real, template <class> class Structure>
void run(const LoadedSection& section, std::span<const double> in, std::span<double> out) {
    const auto coefficients = Structure<Real>::coefficients(section);
    typename Structure<Real>::State state{};
    for (std::size_t k = 0; k < in.size(); ++k) {
        out[k] = static_cast<double>(Structure<Real>::step(coefficients, state, static_cast<Real>(in[k])));
    }
}

template <class Real>
void run_in(const LoadedSection& section, std::span<const double> in, std::span<double> out) {
    switch (section.arithmetic.form) {
        case Form::df1:
            return run<Real, DirectForm1>(section, in, out);
        case Form::df2t:
            return run<Real, TransposedForm2>(section, in, out);
        case Form::svf:
            return run<Real, StateVariable>(section, in, out);
    }
}

}  // namespace

std::string arithmetic_name(Arithmetic arithmetic) {
    const std::string_view form = arithmetic.form == Form::df1    ? "direct form I"
                                  : arithmetic.form == Form::df2t ? "transposed direct form II"
                                                                  : "state-variable form";
    return fmt::format("{}, {}", arithmetic.precision == Precision::float32 ? "float32" : "float64", form);
}

SvfSection svf_of(const ExportSection& section, Hertz sample_rate) {
    const Biquad& f = section.section;
    double g = 0.0, k = 0.0;
    SvfSection svf;
    if (section.notch) {
        const NotchSpec& notch = *section.notch;
        const double half = std::numbers::pi * (notch.center / sample_rate);
        g = portable::tan(half);
        // The digital rule has another damping in the same prototype: alpha = tan(W/(2Q)) instead of
        // sin(W)/(2Q).
        k = notch.width == WidthRule::analog
                ? 1.0 / notch.q
                : 2.0 * portable::tan(half / notch.q) / portable::sin(2.0 * half);
        const double gain = notch.depth_db >= 6000.0 ? 0.0 : portable::pow(10.0, -notch.depth_db / 20.0);
        svf.m1 = -(1.0 - gain) * k;
    } else {
        const double at_half_rate = 1.0 - f.a1 + f.a2;
        g = std::sqrt((1.0 + f.a1 + f.a2) / at_half_rate);
        k = 2.0 * (1.0 - f.a2) / (g * at_half_rate);
        const double scale = 4.0 / at_half_rate;
        const double high = (f.b0 - f.b1 + f.b2) * scale / 4.0;
        // A low-pass has no high-pass part; what is left of it is rounding.
        svf.m0 = std::abs(high) < 1e-12 ? 0.0 : high;
        svf.m1 = (f.b0 - f.b2) * scale / (2.0 * g) - k * svf.m0;
        svf.m2 = 1.0 - svf.m0;
    }
    svf.a1 = 1.0 / (1.0 + g * (g + k));
    svf.a2 = g * svf.a1;
    svf.a3 = g * svf.a2;
    return svf;
}

Biquad biquad_of(const SvfSection& s) {
    // State space of the two integrators: s' = A s + B x, y = C s + D x.
    const double a11 = 2.0 * s.a1 - 1.0, a12 = -2.0 * s.a2, a21 = 2.0 * s.a2, a22 = 1.0 - 2.0 * s.a3;
    const double in1 = 2.0 * s.a2, in2 = 2.0 * s.a3;
    const double out1 = s.m1 * s.a1 + s.m2 * s.a2, out2 = s.m2 * (1.0 - s.a3) - s.m1 * s.a2;
    const double through = s.m0 + s.m1 * s.a2 + s.m2 * s.a3;
    const double trace = a11 + a22, determinant = a11 * a22 - a12 * a21;
    const double once = out1 * in1 + out2 * in2;
    const double twice = out1 * (a11 * in1 + a12 * in2) + out2 * (a21 * in1 + a22 * in2);
    return {through, once - through * trace, through * determinant - trace * once + twice, -trace,
            determinant};
}

LoadedSection loaded(const Biquad& section, Arithmetic arithmetic) { return {arithmetic, section, {}}; }

LoadedSection loaded(const SvfSection& section, Precision precision) {
    return {{Form::svf, precision}, biquad_of(section), section};
}

void run_section(const LoadedSection& section, std::span<const double> in, std::span<double> out) {
    if (section.arithmetic.precision == Precision::float32) {
        run_in<float>(section, in, out);
    } else {
        run_in<double>(section, in, out);
    }
}

}  // namespace ripplenotch
