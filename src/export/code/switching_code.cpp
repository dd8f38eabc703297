// SPDX-License-Identifier: MIT
#include "export/code/switching_code.hpp"

#include <fmt/format.h>

namespace ripplenotch {

SwitchingCode::SwitchingCode(const Arithmetic& arithmetic, const FilterSet& filters)
    : arithmetic_(arithmetic),
      fixed_(is_fixed(arithmetic.precision)),
      by_speed_(filters.by_speed()),
      all_bands_(by_speed_ && runs_all_bands(filters.switching)),
      blends_(all_bands_ && filters.switching.transition == "crossfade" &&
              filters.switching.crossfade_samples > 0) {}

std::string SwitchingCode::product(std::string_view coefficient, std::string_view signal) const {
    return fixed_ ? fmt::format("@name@_product(&c->{}, {})", coefficient, signal)
                  : fmt::format("c->{} * {}", coefficient, signal);
}

std::string SwitchingCode::declarations() const {
    const Form form = arithmetic_.form;
    const std::string fields(form == Form::svf ? svf_fields : "b0, b1, b2, a1, a2;");
    const std::string memory(form == Form::df1 ? df1_memory : "s1, s2;");
    std::string text = R"(#ifndef @NAME@_H
#define @NAME@_H

#define @NAME@_SAMPLE_RATE_HZ @rate@
#define @NAME@_BANDS @bands@
#define @NAME@_SECTIONS @sections@
)";
    if (by_speed_) {
        text +=
            R"(#define @NAME@_HYSTERESIS @hysteresis@ /* @speed-unit@: a region is left only so far outside it */
#define @NAME@_DWELL @dwell@ /* samples that a filter stays in force at least */
)";
        if (blends_)
            text += "#define @NAME@_CROSSFADE @crossfade@ /* samples over which outputs are blended */\n";
    }
    if (fixed_) {
        text +=
            R"(#define @NAME@_FULL_SCALE_NM @full-scale@ /* the torque of a word one larger than the largest */
#define @NAME@_HEADROOM @headroom@ /* bits of a signal above a word, for what is larger inside of a filter */

#include <stdint.h>

typedef int32_t @name@_real;
typedef int64_t @name@_signal; /* a word of torque times 2^@NAME@_FRACTION */
#define @NAME@_FRACTION (16 - @NAME@_HEADROOM)

/* mantissa / 2^shift. Signals are shifted to the right as two's complement, as compilers do it. */
typedef struct {
    int32_t mantissa;
    int16_t shift;
} @name@_coefficient;

/* Of x itself a section adds m0 = (its gain at half the rate) - 1. */
typedef struct {
    @name@_coefficient )" +
            fields + "\n} @name@_section;\n\n";
    } else {
        text += "\ntypedef @real@ @name@_real;\ntypedef @real@ @name@_signal;\n\n";
        if (form != Form::svf)
            text +=
                "/* y = b0 x + b1 x1 + b2 x2 - a1 y1 - a2 y2: a1 and a2 are subtracted (SciPy's sign). */\n";
        text += "typedef struct {\n    @name@_real " + fields + "\n} @name@_section;\n\n";
    }
    text += "typedef struct {\n    @name@_signal " + memory + "\n} @name@_memory;\n\ntypedef struct {\n";
    text += all_bands_ ? "    @name@_memory memory[@NAME@_BANDS][@NAME@_SECTIONS];\n"
                       : "    @name@_memory memory[@NAME@_SECTIONS];\n";
    text += "    int band; /* active band, counted from 0; -1 while the torque passes */\n";
    if (by_speed_)
        text +=
            "    int region; /* of speed; -1 before the first sample */\n"
            "    long since; /* samples since the last switch, @NAME@_DWELL at most */\n";
    if (blends_)
        text +=
            "    @name@_share leaving[@NAME@_BANDS + 1]; /* shares at the start of a blend; the torque's "
            "first */\n"
            "    long blended; /* samples of the blend so far; -1 without one */\n";
    text += "} @name@_state;\n\n";
    const std::string share =
        fixed_ ? "/* 32768 is all */\ntypedef int32_t @name@_share;\n\n" : "typedef @real@ @name@_share;\n\n";
    if (by_speed_) text.insert(text.find("typedef struct {\n    @name@_signal " + memory), share);
    return text;
}

std::string SwitchingCode::regions_open() const {
    return R"(#define @NAME@_REGIONS @regions@

/* Slowest first, speeds in @speed-words@. band: -1 passes the torque, -2 keeps the band in force. Where full
 * and none differ, the share of the filtered torque falls from 1 at full to 0 at none. */
typedef struct {
    @speed@ to;
    int band;
    @speed@ full, none;
} @name@_region;

static const @name@_region @name@_regions[@NAME@_REGIONS] = {
)";
}

std::string SwitchingCode::section_functions() const {
    std::string step, settle, before;
    switch (arithmetic_.form) {
        case Form::svf:
            settle = "    (void)c;\n    m->s1 = 0;\n    m->s2 = x;\n";
            step = fmt::format(R"(    const @name@_signal v3 = x - m->s2;
    const @name@_signal v1 = {} + {};
    const @name@_signal v2 = m->s2 + {} + {};
    m->s1 = v1 + v1 - m->s1;
    m->s2 = v2 + v2 - m->s2;
    return {}{} + {} + {};
)",
                               product("a1", "m->s1"), product("a2", "v3"), product("a2", "m->s1"),
                               product("a3", "v3"), fixed_ ? "x + " : "", product("m0", "x"),
                               product("m1", "v1"), product("m2", "v2"));
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
    if (fixed_)
        before = R"(static inline @name@_signal @name@_product(const @name@_coefficient *c, @name@_signal x)
{
    const int shift = c->shift - @unused@;
    return (c->mantissa * (x >> @unused@) + ((@name@_signal)1 << (shift - 1))) >> shift;
}

)";
    return before + R"(/* As if x had been there for ever. */
static inline void @name@_settle(const @name@_section *c, @name@_memory *m, @name@_signal x)
{
)" + settle +
           R"(}

static inline @name@_signal @name@_section_step(const @name@_section *c, @name@_memory *m, @name@_signal x)
{
)" + step +
           R"(}

static inline @name@_signal @name@_cascade(const @name@_section *c, @name@_memory *m, @name@_signal x)
{
    int i;
    for (i = 0; i < @NAME@_SECTIONS; ++i) {
        x = @name@_section_step(&c[i], &m[i], x);
    }
    return x;
}

static inline void @name@_settle_cascade(const @name@_section *c, @name@_memory *m, @name@_signal x)
{
    int i;
    for (i = 0; i < @NAME@_SECTIONS; ++i) {
        @name@_settle(&c[i], &m[i], x);
    }
}

)";
}

std::string SwitchingCode::supervisor() const {
    return R"(/* Which band is in force from this sample on, by the size of the speed. Returns whether another one is. */
static inline int @name@_supervise(@name@_state *state, @speed@ speed)
{
    const int first = state->region < 0;
    int next = 0, band, changes;
    if (!first) {
        const @name@_region *region = &@name@_regions[state->region];
        const @speed@ from = state->region > 0 ? region[-1].to : 0;
        /* Written so that a speed that is not a number is outside. */
        if (speed > from - @NAME@_HYSTERESIS &&
            (state->region == @NAME@_REGIONS - 1 || speed <= region->to + @NAME@_HYSTERESIS)) {
            if (state->since < @NAME@_DWELL) {
                ++state->since;
            }
            return 0;
        }
    }
    while (next < @NAME@_REGIONS - 1 && speed > @name@_regions[next].to) {
        ++next;
    }
    band = @name@_regions[next].band == -2 ? state->band : @name@_regions[next].band;
    changes = band != state->band;
    if (!first && changes && state->since < @NAME@_DWELL) {
        ++state->since;
        return 0;
    }
    if (first) {
        state->since = @NAME@_DWELL;
    } else {
        state->since = changes ? 0 : state->since;
        if (state->since < @NAME@_DWELL) {
            ++state->since;
        }
    }
    state->region = next;
    state->band = band;
    return changes && !first;
}

)";
}

std::string SwitchingCode::blend_functions() const {
    std::string text;
    if (fixed_) {
        text = R"(static inline @name@_signal @name@_times(@name@_signal x, @name@_share share)
{
    return (x >> 15) * share + (((x & 32767) * share) >> 15);
}

static inline @name@_share @name@_fade(@speed@ speed, @speed@ full, @speed@ none)
{
    const int64_t share = ((int64_t)speed - none) * 32768 / ((int64_t)full - none);
    return (@name@_share)(share < 0 ? 0 : share > 32768 ? 32768 : share);
}

)";
    } else {
        text =
            R"(static inline @name@_signal @name@_times(@name@_signal x, @name@_share share) { return share * x; }

static inline @name@_share @name@_fade(@speed@ speed, @speed@ full, @speed@ none)
{
    const @name@_share share = (speed - none) / (full - none);
    return share < 0 ? 0 : share > 1 ? 1 : share;
}

)";
    }
    if (!blends_) return text;
    text += fixed_ ? R"(static inline @name@_share @name@_left(long step)
{
    return (@name@_share)((int64_t)(@NAME@_CROSSFADE - step) * 32768 / @NAME@_CROSSFADE);
}

)"
                   : R"(static inline @name@_share @name@_left(long step)
{
    return 1 - (@name@_share)step / (@name@_share)@NAME@_CROSSFADE;
}

)";
    return text + fmt::format(R"(/* The mixture in force becomes the start of a new blend. */
static inline void @name@_blend_from(@name@_state *state, int before)
{{
    const @name@_share left = state->blended < 0 ? 0 : @name@_left(state->blended);
    @name@_share rest = {};
    int i;
    for (i = 0; i <= @NAME@_BANDS; ++i) {{
        state->leaving[i] = (@name@_share)@name@_times(state->leaving[i], left);
        rest -= state->leaving[i];
    }}
    state->leaving[before + 1] += rest;
    state->leaving[state->band + 1] = 0;
    state->blended = 0;
}}

)",
                              fixed_ ? "32768" : "1");
}

std::string SwitchingCode::filter_code() const {
    if (!all_bands_)
        return R"(    if (state->band >= 0) {
        if (before < 0) {
            @name@_settle_cascade(@name@_bands[state->band], state->memory, x);
        }
        filtered = @name@_cascade(@name@_bands[state->band], state->memory, x);
    }
)";
    std::string text = R"(    outputs[0] = x;
    for (i = 0; i < @NAME@_BANDS; ++i) {
        if (first) {
            @name@_settle_cascade(@name@_bands[i], state->memory[i], x);
        }
        outputs[i + 1] = @name@_cascade(@name@_bands[i], state->memory[i], x);
    }
    filtered = outputs[state->band + 1];
)";
    if (blends_)
        text += R"(    if (changed) {
        @name@_blend_from(state, before);
    }
    if (state->blended >= 0) {
        const @name@_signal target = filtered;
        @name@_signal sum = 0;
        ++state->blended;
        for (i = 0; i <= @NAME@_BANDS; ++i) {
            sum += @name@_times(outputs[i] - target, state->leaving[i]);
        }
        filtered = target + @name@_times(sum, @name@_left(state->blended));
        if (state->blended >= @NAME@_CROSSFADE) {
            state->blended = -1;
            for (i = 0; i <= @NAME@_BANDS; ++i) {
                state->leaving[i] = 0;
            }
        }
    }
)";
    return text;
}

std::string SwitchingCode::step_function() const {
    const std::string to_signal =
        fixed_ ? "(@name@_signal)torque * ((@name@_signal)1 << @NAME@_FRACTION)" : "torque_nm";
    std::string out = fixed_ ? "@name@_word(filtered)" : "filtered";
    std::string text;
    if (fixed_)
        text = R"(/* Rounded, and no larger than a word. */
static inline @name@_real @name@_word(@name@_signal x)
{
    const @name@_signal word = (x + ((@name@_signal)1 << (@NAME@_FRACTION - 1))) >> @NAME@_FRACTION;
    return (@name@_real)(word > 2147483647 ? 2147483647 : word < -2147483647 - 1 ? -2147483647 - 1 : word);
}

)";
    if (by_speed_) text += supervisor() + blend_functions();
    text +=
        R"(/* Before the first sample, and after a gap in time: the next torque is met as if it had always been there. */
static inline void @name@_init(@name@_state *state)
{
)";
    if (all_bands_) {
        text +=
            "    int i;\n    for (i = 0; i < @NAME@_BANDS; ++i) {\n"
            "        @name@_settle_cascade(@name@_bands[i], state->memory[i], 0);\n    }\n";
    } else {
        text += "    @name@_settle_cascade(@name@_bands[0], state->memory, 0);\n";
    }
    text += "    state->band = -1;\n";
    if (by_speed_) text += "    state->region = -1;\n    state->since = 0;\n";
    if (blends_)
        text +=
            "    for (i = 0; i <= @NAME@_BANDS; ++i) {\n        state->leaving[i] = 0;\n    }\n"
            "    state->blended = -1;\n";
    text += "}\n\n";
    const std::string torque = fixed_ ? "torque" : "torque_nm";
    if (!by_speed_) {
        return text + fmt::format(R"(/* One sample, called at @NAME@_SAMPLE_RATE_HZ. */
static inline @name@_real @name@_step(@name@_state *state, @name@_real {0})
{{
    const @name@_signal x = {1};
    @name@_signal filtered;
    if (state->band < 0) {{
        @name@_settle_cascade(@name@_bands[0], state->memory, x);
        state->band = 0;
    }}
    filtered = @name@_cascade(@name@_bands[0], state->memory, x);
    return {2};
}}

)",
                                  torque, to_signal, out);
    }
    text += fmt::format(
        R"(/* One sample, called at @NAME@_SAMPLE_RATE_HZ; the @shaft@ speed, in @speed-words@, may have either sign. */
static inline @name@_real @name@_step(@name@_state *state, @name@_real {0}, @speed@ @speed-name@)
{{
    const @speed@ speed = @speed-name@ < 0 ? -@speed-name@ : @speed-name@;
    const @name@_signal x = {1};
)",
        torque, to_signal);
    if (all_bands_)
        text += std::string("    const int first = state->region < 0;\n") +
                (blends_ ? "    const int before = state->band;\n" : "") +
                "    @name@_signal outputs[@NAME@_BANDS + 1];\n";
    else
        text += "    const int before = state->band;\n";
    text += blends_ ? "    const int changed = @name@_supervise(state, speed);\n" : "";
    text += "    const @name@_region *region;\n    @name@_signal filtered = x;\n";
    if (all_bands_) text += "    int i;\n";
    if (!blends_) text += "    (void)@name@_supervise(state, speed);\n";
    text += "    region = &@name@_regions[state->region];\n" + filter_code();
    text +=
        "    if (region->full != region->none) {\n"
        "        filtered = x + @name@_times(filtered - x, @name@_fade(speed, region->full, region->none));\n"
        "    }\n";
    return text + "    return " + out + ";\n}\n\n";
}

std::string SwitchingCode::self_test_open() const {
    return fmt::format(R"(#ifdef @NAME@_SELF_TEST
#define @NAME@_GOLDEN @golden@
#define @NAME@_GOLDEN_TOLERANCE{0} @tolerance@

/* torque{1}, @shaft@ speed in @speed-words@, filtered torque */
static const @golden-type@ @name@_golden[@NAME@_GOLDEN][3] = {{
)",
                       fixed_ ? "" : "_NM", fixed_ ? "" : " Nm");
}

std::string SwitchingCode::self_test_function() const {
    return fmt::format(
        R"(/* The largest error{0}; assert(@name@_self_test() <= @NAME@_GOLDEN_TOLERANCE{1}). */
static inline @golden-type@ @name@_self_test(void)
{{
    @name@_state state;
    @golden-type@ largest = 0;
    int k;
    @name@_init(&state);
    for (k = 0; k < @NAME@_GOLDEN; ++k) {{
        const @golden-type@ error =
            {4}@name@_step(&state, {2}@name@_golden[k][0]{3}) - @name@_golden[k][2];
        const @golden-type@ size = error < 0 ? -error : error;
        if (!(size <= largest)) {{
            largest = size;
        }}
        if (!(largest >= 0)) {{
            break; /* not a number, and nothing larger can come */
        }}
    }}
    return largest;
}}
#endif

)",
        fixed_ ? " in words" : " in Nm", fixed_ ? "" : "_NM", fixed_ ? "(@name@_real)" : "",
        !by_speed_ ? ""
        : fixed_   ? ", (@speed@)@name@_golden[k][1]"
                   : ", @name@_golden[k][1]",
        fixed_ ? "(@golden-type@)" : "");
}

}  // namespace ripplenotch
