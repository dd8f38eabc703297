// SPDX-License-Identifier: MIT
#pragma once
// How a target computes: the structure of a section and the width of its numbers. The same loops run here, in
// float where the target has float, so that what is measured is what will run.

#include <span>
#include <string>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/export/filter_set.hpp"

namespace ripplenotch {

enum class Form {
    df1,   ///< direct form I: past inputs and outputs
    df2t,  ///< transposed direct form II: two sums
    svf,   ///< state-variable filter of two trapezoidal integrators
};
enum class Precision { float32, float64 };

struct Arithmetic {
    Form form = Form::df2t;
    Precision precision = Precision::float64;
};
[[nodiscard]] std::string arithmetic_name(Arithmetic arithmetic);  ///< "float32, state-variable form"

/// One section as two trapezoidal integrators (A. Simper, Linear Trapezoidal Integrated SVF, 2013). With
/// g = tan(pi f0 / fs) and k = 1/Q: a1 = 1 / (1 + g (g + k)), a2 = g a1, a3 = g a2, and per sample
///   v3 = x - s2;  v1 = a1 s1 + a2 v3;  v2 = s2 + a2 s1 + a3 v3;  s1 = 2 v1 - s1;  s2 = 2 v2 - s2;
///   y = m0 x + m1 v1 + m2 v2.
/// A notch is m0 = 1, m1 = -(1 - gain at the centre) k, m2 = 0. At rest v1 is 0 whatever the rounding, so
/// its gain at 0 Hz is exactly 1.
struct SvfSection {
    double a1 = 1.0, a2 = 0.0, a3 = 0.0;
    double m0 = 1.0, m1 = 0.0, m2 = 0.0;
};

/// From the notch's own figures where there are any, else from the poles and zeros of the section.
[[nodiscard]] SvfSection svf_of(const ExportSection& section, Hertz sample_rate);
/// The transfer function of what stands in `section`, consistent or not.
[[nodiscard]] Biquad biquad_of(const SvfSection& section);

/// A section as it was read back. Values are those that the target holds: exact floats in a float32 target.
struct LoadedSection {
    Arithmetic arithmetic;
    Biquad biquad;   ///< its transfer function, a1 and a2 in the sign of core/biquad.hpp
    SvfSection svf;  ///< in force when the form is svf
};
[[nodiscard]] LoadedSection loaded(const Biquad& section, Arithmetic arithmetic);
[[nodiscard]] LoadedSection loaded(const SvfSection& section, Precision precision);

/// Runs one section over `in` from zero state, in its own arithmetic. Spans of equal length.
void run_section(const LoadedSection& section, std::span<const double> in, std::span<double> out);

}  // namespace ripplenotch
