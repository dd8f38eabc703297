// SPDX-License-Identifier: MIT
#include "ripplenotch/export/method_code.hpp"

#include <fmt/format.h>

#include <array>

#include "export/code/c_code.hpp"
#include "export/code/method_code_parts.hpp"
#include "export/text.hpp"
#include "ripplenotch/design/rate_edge.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> precisions = {"float", "double"};
constexpr std::array keys = {
    Key{.name = "name", .kind = KeyKind::text, .default_text = "ripplenotch", .help = "prefix of all names"},
    Key{.name = "precision",
        .kind = KeyKind::choice,
        .default_text = "float",
        .choices = precisions,
        .help = "of numbers and arithmetic"}};

// Polynomials in the square of the quarter turns beside the nearest whole one, by interpolation at
// Chebyshev's places: within 2.5e-9 but for rounding. Where a processor has a fused multiplication and
// addition it is used: that is one instruction for two.
constexpr std::string_view float_turn = R"c(
#if defined FP_FAST_FMAF || defined __FP_FAST_FMAF
static inline float @name@_fma(float a, float b, float c) { return fmaf(a, b, c); }
#else
static inline float @name@_fma(float a, float b, float c) { return a * b + c; }
#endif
/* What is beyond the nearest whole number, which an int has to hold. */
static inline float @name@_beside_whole(float value) {
    value -= (float)(int)value;
    return value - (float)(int)(value + value);
}
static inline void @name@_on_circle(float turns, float* cosine, float* sine) {
    const float quarters = 4 * turns;
    const int quarter = (int)(quarters + (quarters < 0 ? -0.5f : 0.5f));
    const float a = quarters - (float)quarter, s = a * a;
    float y = @name@_fma(s, @name@_fma(s, -4.60214921e-3f, 7.96802176e-2f), -6.45963478e-1f);
    float x = @name@_fma(s, @name@_fma(s, 9.06739898e-4f, -2.08615283e-2f), 2.5366941e-1f);
    y = a * @name@_fma(s, y, 1.57079632f);
    x = @name@_fma(s, @name@_fma(s, x, -1.23370055f), 1.0f);
    if (quarter & 1) {
        const float turned = x;
        x = -y;
        y = turned;
    }
    *cosine = quarter & 2 ? -x : x;
    *sine = quarter & 2 ? -y : y;
}
)c";

constexpr std::string_view double_turn = R"c(
static inline double @name@_fma(double a, double b, double c) { return a * b + c; }
static inline double @name@_beside_whole(double value) { return value - floor(value + 0.5); }
static inline void @name@_on_circle(double turns, double* cosine, double* sine) {
    const double angle = 6.283185307179586 * (turns - floor(turns));
    *cosine = cos(angle);
    *sine = sin(angle);
}
)c";

}  // namespace

CodeStyle style_of(const Settings& settings) {
    CodeStyle style{settings.text("name"), settings.text("precision") == "float"};
    check_identifier(style.name, "target c-header, name");
    return style;
}

std::string_view turn_code(bool is_float) { return is_float ? float_turn : double_turn; }

std::string sum_code(std::string first, std::span<const std::pair<std::string, std::string>> products) {
    for (const auto& [a, b] : products) first = fmt::format("@name@_fma({}, {}, {})", a, b, first);
    return first;
}

std::string CodeStyle::array(std::string_view what, const std::vector<double>& values) const {
    std::string text;
    for (const double value : values)
        text += (text.empty() ? "" : ", ") + (is_float ? decimal_float(value) : decimal(value));
    return fmt::format("static const {} {}_{}[{}] = {{{}}};\n", is_float ? "float" : "double", name, what,
                       values.size(), text);
}

std::string CodeStyle::filled(std::string_view code) const {
    const std::array<std::pair<std::string_view, std::string>, 7> fields = {
        {{"@name@", name},
         {"@NAME@", upper_case(name)},
         {"@real@", is_float ? "float" : "double"},
         {"@abs@", is_float ? "fabsf" : "fabs"},
         {"@sqrt@", is_float ? "sqrtf" : "sqrt"},
         {"@full@", decimal(full_below_rate)},
         {"@none@", decimal(none_above_rate)}}};
    return c_code::filled(std::string(code), fields);
}

std::vector<double> CodeStyle::read(TextReader& reader, std::string_view what, std::size_t count) const {
    reader.expect(fmt::format("{}_{}[", name, what));
    return reader.numbers('{', '}', count);
}

bool is_code_target(std::string_view target) { return target == "c-header"; }

bool has_code(std::string_view method) { return method == "tracking" || method == "oscillator"; }

std::span<const Key> method_code_keys() { return keys; }

Written write_method_code(const RunningDesign& design, const Settings& settings,
                          std::span<const std::string> heading) {
    const CodeStyle style = style_of(settings);
    std::string text = comment_lines(heading, "// ");
    text += style.filled("#ifndef @NAME@_H\n#define @NAME@_H\n#include <math.h>\n\n");
    if (const auto* tracking = std::get_if<TrackingDesign>(&design))
        text += tracking_header(*tracking, style);
    if (const auto* oscillator = std::get_if<OscillatorDesign>(&design))
        text += oscillator_header(*oscillator, style);
    return {text + style.filled("\n#endif  // @NAME@_H\n"), {}};
}

LoadedCode read_method_code(std::string_view bytes, const std::string& source, const RunningDesign& design,
                            const Settings& settings) {
    const CodeStyle style = style_of(settings);
    TextReader reader(bytes, source, Comments::c, style.is_float ? Precision::float32 : Precision::float64);
    LoadedCode loaded = std::holds_alternative<TrackingDesign>(design)
                            ? tracking_loaded(reader, std::get<TrackingDesign>(design), style)
                            : oscillator_loaded(reader, std::get<OscillatorDesign>(design), style);
    loaded.arithmetic = style.is_float ? "float32" : "float64";
    return loaded;
}

}  // namespace ripplenotch
