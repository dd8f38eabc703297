// SPDX-License-Identifier: MIT
#pragma once
// One method as C and as the same loops here: a file each.

#include <cmath>
#include <string>
#include <string_view>

#include "export/text_reader.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/export/method_code.hpp"

namespace ripplenotch {

/// How a header is written.
struct CodeStyle {
    std::string name;
    bool is_float = true;

    /// "static const float NAME_what[3] = {...};"
    [[nodiscard]] std::string array(std::string_view what, const std::vector<double>& values) const;
    /// Fields @name@, @NAME@, @real@ and mathematics functions filled in.
    [[nodiscard]] std::string filled(std::string_view code) const;
    /// The numbers of an array().
    [[nodiscard]] std::vector<double> read(TextReader& reader, std::string_view what,
                                           std::size_t count) const;
};

/// By the keys name and precision. Throws UsageError.
[[nodiscard]] CodeStyle style_of(const Settings& settings);

/// Sine and cosine of an angle in turns: of a float by its own series, of a double by the library.
[[nodiscard]] std::string_view turn_code(bool is_float);

template <class Real>
struct OnCircle {
    Real cosine, sine;
};

/// The same, operation by operation.
[[nodiscard]] inline OnCircle<double> on_circle(double turns) {
    const double angle = 6.283185307179586 * (turns - std::floor(turns));
    return {portable::cos(angle), portable::sin(angle)};
}
[[nodiscard]] inline OnCircle<float> on_circle(float turns) {
    const float quarters = 4.0F * turns;
    const int quarter = static_cast<int>(quarters + (quarters < 0.0F ? -0.5F : 0.5F));
    const float a = 1.5707963F * (quarters - static_cast<float>(quarter)), s = a * a;
    float y =
        a * (1.0F + s * (-1.6666667e-1F + s * (8.3333333e-3F + s * (-1.9841270e-4F + s * 2.7557319e-6F))));
    float x =
        1.0F +
        s * (-0.5F + s * (4.1666667e-2F + s * (-1.3888889e-3F + s * (2.4801587e-5F - s * 2.7557319e-7F))));
    if ((quarter & 1) != 0) {
        const float turned = x;
        x = -y;
        y = turned;
    }
    return (quarter & 2) != 0 ? OnCircle<float>{-x, -y} : OnCircle<float>{x, y};
}

[[nodiscard]] std::string tracking_header(const TrackingDesign& design, const CodeStyle& style);
[[nodiscard]] LoadedCode tracking_loaded(TextReader& reader, const TrackingDesign& design,
                                         const CodeStyle& style);
[[nodiscard]] std::string oscillator_header(const OscillatorDesign& design, const CodeStyle& style);
[[nodiscard]] LoadedCode oscillator_loaded(TextReader& reader, const OscillatorDesign& design,
                                           const CodeStyle& style);

}  // namespace ripplenotch
