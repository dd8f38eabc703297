// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <complex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "export/text.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

// One method as C and as the same loops here: a file each.

/// How a header is written.
struct CodeStyle {
    std::string name;
    bool is_float = true;

    [[nodiscard]] Precision precision() const { return is_float ? Precision::float32 : Precision::float64; }
    [[nodiscard]] std::string number(double value) const {
        return is_float ? decimal_float(value) : decimal(value);
    }
    /// A whole header: its origin, its guard, and between them `body`, filled in.
    [[nodiscard]] std::string header(std::span<const std::string> heading, std::string_view body) const;

    /// "static const float NAME_what[3] = {...};"
    [[nodiscard]] std::string array(std::string_view what, const std::vector<double>& values) const;
    /// "typedef struct { float a, b; } NAME_constants;" and their values as NAME_values.
    [[nodiscard]] std::string constants(std::span<const std::string_view> names,
                                        const std::vector<double>& values) const;
    /// Fields @name@, @NAME@, @real@ and mathematics functions filled in.
    [[nodiscard]] std::string filled(std::string_view code) const;
    /// The numbers of constants().
    [[nodiscard]] std::vector<double> read_constants(TextReader& reader, std::size_t count) const;
    /// The numbers of an array().
    [[nodiscard]] std::vector<double> read(TextReader& reader, std::string_view what,
                                           std::size_t count) const;
};

/// By the keys name and precision. Throws UsageError.
[[nodiscard]] CodeStyle style_of(const Settings& settings);

/// Sine and cosine of an angle in turns, of a float by its own series, of a double by the library; the
/// nearest whole number; a b + c.
[[nodiscard]] std::string_view turn_code(bool is_float);
/// "first + a b + c d", as nested calls; each pair is a product.
[[nodiscard]] std::string sum_code(std::string first,
                                   std::span<const std::pair<std::string, std::string>> products);

template <class Real>
struct OnCircle {
    Real cosine, sine;
};

/// The same, operation by operation.
[[nodiscard]] inline OnCircle<double> on_circle(double turns) {
    const double angle = 6.283185307179586 * (turns - std::floor(turns));
    const std::complex<double> at = portable::phasor(angle);
    return {at.real(), at.imag()};
}
/// The difference from the nearest whole number.
[[nodiscard]] inline double beside_whole(double value) { return value - std::floor(value + 0.5); }
[[nodiscard]] inline float beside_whole(float value) {
    value -= static_cast<float>(static_cast<int>(value));
    return value - static_cast<float>(static_cast<int>(value + value));
}
[[nodiscard]] inline OnCircle<float> on_circle(float turns) {
    const float quarters = 4.0F * turns;
    const int quarter = static_cast<int>(quarters + (quarters < 0.0F ? -0.5F : 0.5F));
    const float a = quarters - static_cast<float>(quarter), s = a * a;
    float y = s * (s * -4.60214921e-3F + 7.96802176e-2F) + -6.45963478e-1F;
    float x = s * (s * 9.06739898e-4F + -2.08615283e-2F) + 2.5366941e-1F;
    y = a * (s * y + 1.57079632F);
    x = s * (s * x + -1.23370055F) + 1.0F;
    if ((quarter & 1) != 0) {
        const float turned = x;
        x = -y;
        y = turned;
    }
    return (quarter & 2) != 0 ? OnCircle<float>{-x, -y} : OnCircle<float>{x, y};
}

/// The body of a header, for CodeStyle::header().
[[nodiscard]] std::string tracking_header(const TrackingDesign& design, const CodeStyle& style);
[[nodiscard]] LoadedCode tracking_loaded(TextReader& reader, const TrackingDesign& design,
                                         const CodeStyle& style);
[[nodiscard]] std::string oscillator_header(const OscillatorDesign& design, const CodeStyle& style);
[[nodiscard]] LoadedCode oscillator_loaded(TextReader& reader, const OscillatorDesign& design,
                                           const CodeStyle& style);

}  // namespace ripplenotch
