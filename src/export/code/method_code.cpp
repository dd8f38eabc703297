// SPDX-License-Identifier: MIT
#include "export/code/method_code.hpp"

#include <fmt/format.h>

#include <array>

#include "export/text.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch::c_code {

std::string declarations(Form form) {
    const std::string fields(form == Form::svf ? svf_fields : "b0, b1, b2, a1, a2;");
    const std::string memory(form == Form::df1 ? df1_memory : "s1, s2;");
    const std::string sign =
        form == Form::svf
            ? ""
            : "/* y = b0 x + b1 x1 + b2 x2 - a1 y1 - a2 y2: a1 and a2 are subtracted (SciPy's sign). */\n";
    return R"(#ifndef @NAME@_H
#define @NAME@_H

#define @NAME@_SAMPLE_RATE_HZ @rate@
#define @NAME@_BANDS @bands@
#define @NAME@_SECTIONS @sections@

typedef @real@ @name@_real;

)" + sign + "typedef struct {\n    @name@_real " +
           fields + "\n} @name@_section;\n\ntypedef struct {\n    @name@_real " + memory +
           "\n} @name@_memory;\n\n" +
           R"(typedef struct {
    @name@_memory memory[@NAME@_SECTIONS];
    int band; /* in force, counted from 0; -1 while the torque passes */
} @name@_state;

)";
}

std::string regions_open() {
    return R"(#define @NAME@_REGIONS @regions@

/* Slowest first. band: -1 passes the torque, -2 keeps the band in force. Where full and none differ, the
 * share of the filtered torque falls from 1 at full to 0 at none. */
typedef struct {
    @name@_real to_deg_s;
    int band;
    @name@_real full_deg_s, none_deg_s;
} @name@_region;

static const @name@_region @name@_regions[@NAME@_REGIONS] = {
)";
}

std::string section_functions(Form form) {
    std::string step, settle;
    switch (form) {
        case Form::svf:
            settle = "    (void)c;\n    m->s1 = 0;\n    m->s2 = x;\n";
            step = R"(    const @name@_real v3 = x - m->s2;
    const @name@_real v1 = c->a1 * m->s1 + c->a2 * v3;
    const @name@_real v2 = m->s2 + c->a2 * m->s1 + c->a3 * v3;
    m->s1 = v1 + v1 - m->s1;
    m->s2 = v2 + v2 - m->s2;
    return c->m0 * x + c->m1 * v1 + c->m2 * v2;
)";
            break;
        case Form::df1:
            settle = "    (void)c;\n    m->x1 = m->x2 = m->y1 = m->y2 = x;\n";
            step =
                R"(    const @name@_real y = c->b0 * x + c->b1 * m->x1 + c->b2 * m->x2 - c->a1 * m->y1 - c->a2 * m->y2;
    m->x2 = m->x1;
    m->x1 = x;
    m->y2 = m->y1;
    m->y1 = y;
    return y;
)";
            break;
        case Form::df2t:
            settle = "    m->s2 = (c->b2 - c->a2) * x;\n    m->s1 = (c->b1 - c->a1) * x + m->s2;\n";
            step = R"(    const @name@_real y = c->b0 * x + m->s1;
    m->s1 = c->b1 * x - c->a1 * y + m->s2;
    m->s2 = c->b2 * x - c->a2 * y;
    return y;
)";
            break;
    }
    return R"(/* As if x had been there for ever. */
static inline void @name@_settle(const @name@_section *c, @name@_memory *m, @name@_real x)
{
)" + settle +
           R"(}

static inline @name@_real @name@_section_step(const @name@_section *c, @name@_memory *m, @name@_real x)
{
)" + step + "}\n\n";
}

std::string step_function(bool by_speed) {
    const std::string init =
        R"(/* Before the first sample, and after a gap in time: the next torque is met as if it had always been there. */
static inline void @name@_init(@name@_state *state)
{
    int i;
    for (i = 0; i < @NAME@_SECTIONS; ++i) {
        @name@_settle(&@name@_bands[0][i], &state->memory[i], 0);
    }
    state->band = -1;
}

)";
    if (!by_speed) {
        return init + R"(/* One sample, called at @NAME@_SAMPLE_RATE_HZ. */
static inline @name@_real @name@_step(@name@_state *state, @name@_real torque_nm)
{
    @name@_real filtered = torque_nm;
    int i;
    if (state->band < 0) {
        for (i = 0; i < @NAME@_SECTIONS; ++i) {
            @name@_settle(&@name@_bands[0][i], &state->memory[i], torque_nm);
        }
        state->band = 0;
    }
    for (i = 0; i < @NAME@_SECTIONS; ++i) {
        filtered = @name@_section_step(&@name@_bands[0][i], &state->memory[i], filtered);
    }
    return filtered;
}

)";
    }
    return init + R"(/* One sample, called at @NAME@_SAMPLE_RATE_HZ; the joint speed may have either sign. */
static inline @name@_real @name@_step(@name@_state *state, @name@_real torque_nm, @name@_real speed_deg_s)
{
    const @name@_real speed = speed_deg_s < 0 ? -speed_deg_s : speed_deg_s;
    const @name@_region *region = @name@_regions;
    @name@_real filtered = torque_nm;
    @name@_real share;
    int band, i;
    while (region < @name@_regions + @NAME@_REGIONS - 1 && speed > region->to_deg_s) {
        ++region;
    }
    band = region->band == -2 ? state->band : region->band;
    if (band >= 0 && state->band < 0) {
        for (i = 0; i < @NAME@_SECTIONS; ++i) {
            @name@_settle(&@name@_bands[band][i], &state->memory[i], torque_nm);
        }
    }
    state->band = band;
    if (band < 0) {
        return torque_nm;
    }
    for (i = 0; i < @NAME@_SECTIONS; ++i) {
        filtered = @name@_section_step(&@name@_bands[band][i], &state->memory[i], filtered);
    }
    if (region->full_deg_s == region->none_deg_s) {
        return filtered;
    }
    share = (speed - region->none_deg_s) / (region->full_deg_s - region->none_deg_s);
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    return torque_nm + share * (filtered - torque_nm);
}

)";
}

std::string self_test_open() {
    return R"(#ifdef @NAME@_SELF_TEST
#define @NAME@_GOLDEN @golden@
#define @NAME@_GOLDEN_TOLERANCE_NM @tolerance@

/* torque Nm, speed deg/s, filtered torque Nm */
static const @name@_real @name@_golden[@NAME@_GOLDEN][3] = {
)";
}

std::string self_test_function(bool by_speed) {
    return std::string(
               R"(/* The largest error in Nm; assert(@name@_self_test() <= @NAME@_GOLDEN_TOLERANCE_NM). */
static inline @name@_real @name@_self_test(void)
{
    @name@_state state;
    @name@_real largest = 0;
    int k;
    @name@_init(&state);
    for (k = 0; k < @NAME@_GOLDEN; ++k) {
        const @name@_real error =
            @name@_step(&state, @name@_golden[k][0])") +
           (by_speed ? ", @name@_golden[k][1]" : "") +
           R"() - @name@_golden[k][2];
        const @name@_real size = error < 0 ? -error : error;
        if (!(size <= largest)) {
            largest = size;
        }
        if (!(largest >= 0)) {
            break; /* not a number, and nothing larger can come */
        }
    }
    return largest;
}
#endif

)";
}

std::string filled(std::string text, std::span<const std::pair<std::string_view, std::string>> fields) {
    for (const auto& [field, value] : fields) {
        for (std::size_t at = 0; (at = text.find(field, at)) != std::string::npos; at += value.size()) {
            text.replace(at, field.size(), value);
        }
    }
    return text;
}

}  // namespace ripplenotch::c_code

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
