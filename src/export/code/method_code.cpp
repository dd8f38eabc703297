// SPDX-License-Identifier: MIT
#include "export/code/method_code.hpp"

#include <fmt/format.h>

#include <array>

#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

namespace {

constexpr std::array keys = {name_key("ripplenotch"), precision_key("of numbers and arithmetic"),
                             speed_unit_key, speed_side_key};

// Polynomials in the square of the quarter turns from the nearest whole one, by interpolation at Chebyshev
// points: within 2.5e-9 except for rounding. Where a processor has a fused multiplication and addition it is
// used: that is one instruction for two.
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
    return fmt::format("static const {} {}_{}[{}] = {{{}}};\n", is_float ? "float" : "double", name, what,
                       values.size(), joined(values, ", ", is_float ? decimal_float : decimal));
}

std::string CodeStyle::constants(std::span<const std::string_view> names,
                                 const std::vector<double>& values) const {
    const std::string all = joined(names, ", ");
    return filled(
        fmt::format("typedef struct {{\n    @real@ {};\n}} @name@_constants;\n"
                    "static const @name@_constants @name@_values = {{{}}};\n",
                    all, joined(values, ", ", is_float ? decimal_float : decimal)));
}

std::string CodeStyle::filled(std::string_view code) const {
    return ripplenotch::filled(std::string(code), {{"@name@", name},
                                                   {"@NAME@", upper_case(name)},
                                                   {"@real@", is_float ? "float" : "double"},
                                                   {"@abs@", is_float ? "fabsf" : "fabs"},
                                                   {"@sqrt@", is_float ? "sqrtf" : "sqrt"},
                                                   {"@full@", decimal(full_below_rate)},
                                                   {"@none@", decimal(none_above_rate)}});
}

std::string CodeStyle::header(std::span<const std::string> heading, std::string_view body) const {
    return comment_lines(heading, "// ") +
           filled(fmt::format(
               "#ifndef @NAME@_H\n#define @NAME@_H\n#include <math.h>\n\n{}#endif  // @NAME@_H\n", body));
}

std::vector<double> CodeStyle::read(TextReader& reader, std::string_view what, std::size_t count) const {
    reader.expect(fmt::format("{}_{}[", name, what));
    return reader.numbers('{', '}', count);
}

std::vector<double> CodeStyle::read_constants(TextReader& reader, std::size_t count) const {
    reader.expect(fmt::format("{}_values = ", name));
    return reader.numbers('{', '}', count);
}

bool is_code_target(std::string_view target) { return target == "c-header"; }

std::span<const Key> method_code_keys() { return keys; }

namespace {

// A gear ratio in motor turns per 360 of the code's own unit makes the rest of the code the same for all.
TrackingDesign in_unit(TrackingDesign design, const Settings& settings) {
    design.gear_ratio /= code_speed(settings, design.gear_ratio).per_deg_s;
    return design;
}

void refuse_units(const Settings& settings) {
    if (code_speed(settings, 2.0).per_deg_s != 1.0)
        raise<UsageError>(
            "target c-header: the oscillator takes the motor's angle, not a speed; speed-unit and speed-side "
            "are of tracking and of tables");
}

}  // namespace

Written write_method_code(const RunningDesign& design, const Settings& settings,
                          std::span<const std::string> heading) {
    const CodeStyle style = style_of(settings);
    const auto* const tracking = std::get_if<TrackingDesign>(&design);
    if (tracking == nullptr) {
        refuse_units(settings);
        return {style.header(heading, oscillator_header(std::get<OscillatorDesign>(design), style) + "\n"),
                {}};
    }
    std::string body = tracking_header(in_unit(*tracking, settings), style);
    body = filled(std::move(body), {{"@speed-name@", code_speed(settings, tracking->gear_ratio).name}});
    return {style.header(heading, body + "\n"), {}};
}

LoadedCode read_method_code(std::string_view bytes, const std::string& source, const RunningDesign& design,
                            const Settings& settings) {
    const CodeStyle style = style_of(settings);
    TextReader reader(bytes, source, Comments::c, style.precision());
    LoadedCode loaded;
    if (const auto* const tracking = std::get_if<TrackingDesign>(&design)) {
        const double per_deg_s = code_speed(settings, tracking->gear_ratio).per_deg_s;
        loaded = tracking_loaded(reader, *tracking, style);
        loaded.step = [step = loaded.step, per_deg_s](CodeInput in) {
            in.speed_deg_s *= per_deg_s;
            return step(in);
        };
    } else {
        loaded = oscillator_loaded(reader, std::get<OscillatorDesign>(design), style);
    }
    loaded.arithmetic = style.is_float ? "float32" : "float64";
    return loaded;
}

}  // namespace ripplenotch
