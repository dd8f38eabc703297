// SPDX-License-Identifier: MIT
// The Kalman filter of torque and ripple as C. Its arithmetic is that of export/run/oscillator_run.hpp,
// operation by operation.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "export/code/map_code.hpp"
#include "export/code/method_code_parts.hpp"
#include "export/run/oscillator_run.hpp"
#include "export/run/oscillator_step.hpp"

namespace ripplenotch {
namespace {

using Value = OscillatorValue;

constexpr std::string_view state_code = R"c(
typedef struct {
    @real@ x[@NAME@_STATES];      /* torque and ripple together, the torque's rate, of each order a cosine and a sine, in
                                  units of the noise; the rate is per sample */
    @real@ p[@NAME@_COVARIANCES]; /* their covariance, row by row from the diagonal on */
    @real@ h[@NAME@_STATES - 2];  /* how each order shows */
    @real@ origin, turns, slip, slipped, lost, left;
    int started;
} @name@_state;

/* At start, and after a gap in time. */
static inline void @name@_init(@name@_state* s) { s->started = 0; }

/* The first sample: its torque is anything at all. */
static inline void @name@_begin(@name@_state* s, @real@ torque_nm) {
    int i;
    s->started = 1;
    s->origin = torque_nm;
    s->left = 1;
    for (i = 0; i < @NAME@_COVARIANCES; ++i) s->p[i] = 0;
    s->x[0] = s->x[1] = 0;
    s->p[0] = 1;
    s->p[@NAME@_STATES] = @name@_values[4];
    for (i = 2; i < @NAME@_STATES; ++i) {
        const @real@* const prior = @name@_priors + 3 * (i / 2 - 1);
        s->x[i] = prior[i % 2];
        s->p[i * @NAME@_STATES - i * (i - 1) / 2] = prior[2] * prior[2];
    }
}

/* An order that nears half the sample rate is let go; rate in cycles a sample. */
static inline void @name@_fade(@real@ rate, @real@* cosine, @real@* sine, @real@* squares) {
    if (rate > (@real@)@full@) {
        const @real@ share = rate < (@real@)@none@ ? ((@real@)@none@ - rate) / ((@real@)@none@ - (@real@)@full@) : 0;
        *cosine *= share;
        *sine *= share;
        *squares -= 1 - share * share;
    }
}
)c";

constexpr std::string_view step_code = R"c(
/* Every sample, @NAME@_SAMPLE_RATE_HZ times a second: the torque without ripple. motor_turns is the motor's angle in
   turns, 0 where the joint is at position 0; the fraction of the turn is enough.@more@ */
static inline @real@ @name@_step(@name@_state* s, @real@ torque_nm, @real@ motor_turns@parameters@) {
    const @real@* const c = @name@_values;
    @real@ moved, squares = @NAME@_ORDERS;
)c";

constexpr std::string_view back_code = R"c(
/* What was forgotten of the amplitudes, taken off themselves. */
static inline void @name@_bring_back(@name@_state* s) {
    const @real@ left = s->left;
    int i, j, at = 2 * @NAME@_STATES - 1;
    for (i = 2; i < @NAME@_STATES; ++i) {
        s->x[i] *= left;
        s->h[i - 2] /= left;
        s->p[i] *= left;
        s->p[@NAME@_STATES + i - 1] *= left;
        for (j = i; j < @NAME@_STATES; ++j) s->p[at++] *= left * left;
    }
    s->left = 1;
}
)c";

std::vector<double> code_values(const OscillatorDesign& d) {
    std::vector<double> values(Value::count);
    values[Value::noise_nm] = d.noise_nm;
    values[Value::seen_noise] = 1.0 + d.torque_noise;
    values[Value::cross_noise] = d.step_s * d.cross_noise;
    values[Value::rate_noise] = d.step_s * d.step_s * d.rate_noise;
    values[Value::first_rate_variance] = d.step_s * d.step_s * d.first_rate_variance;
    values[Value::amplitude_noise] = std::sqrt(2.0) / d.memory_turns;
    values[Value::quarter_memory] = 0.25 / d.memory_turns;
    values[Value::jump] = d.jump;
    values[Value::largest_slip] = d.largest_slip;
    values[Value::in_noise] = 1.0 / d.noise_nm;
    values[Value::turns_to_return] = d.return_turns > 0.0 ? 1.0 / d.return_turns : 0.0;
    return values;
}

void replace(std::string& text, std::string_view mark, const std::string& value) {
    text.replace(text.find(mark), mark.size(), value);
}

std::string step_of(const OscillatorDesign& d, const CodeStyle& style) {
    std::string text(step_code);
    std::string here;
    if (d.map) {
        const MapCode map(*d.map, style);
        here = map.amplitudes_here("torque_nm");
        replace(text, "@parameters@", ", " + map.parameters());
        replace(text, "@more@",
                " speed_deg_s and joint_deg: the joint's\n   velocity and position, where its map depends on "
                "them.");
    } else {
        replace(text, "@parameters@", "");
        replace(text, "@more@", "");
    }
    return style.filled(text + here + oscillator_step_code(d) + "}\n");
}

template <class Real>
LoadedCode loaded_code(TextReader& reader, const OscillatorDesign& d, const CodeStyle& style,
                       bool minus_ripple) {
    const auto orders = style.read(reader, "orders", d.orders.size());
    const auto priors = style.read(reader, "priors", 3 * d.orders.size());
    const auto values = style.read(reader, "values", Value::count);
    std::optional<MapRun<Real>> map;
    if (d.map) map.emplace(*d.map, MapTables(reader, *d.map, style));
    auto run = std::make_shared<OscillatorRun<Real>>(orders, priors, values, minus_ripple, std::move(map));
    return {"", [run](const CodeInput& in) { return run->step(in); }};
}

}  // namespace

std::string oscillator_header(const OscillatorDesign& d, const CodeStyle& style) {
    const std::size_t states = 2 + 2 * d.orders.size();
    std::vector<double> priors;
    for (const auto& prior : d.priors)
        priors.insert(priors.end(), {prior.cosine, prior.sine, prior.deviation});
    std::string text =
        style.filled(fmt::format("enum {{ @NAME@_ORDERS = {}, @NAME@_STATES = {}, @NAME@_COVARIANCES = {}, "
                                 "@NAME@_MINUS_RIPPLE = {},\n       @NAME@_SAMPLE_RATE_HZ = {} }};\n",
                                 d.orders.size(), states, states * (states + 1) / 2, d.minus_ripple ? 1 : 0,
                                 std::lround(1.0 / d.step_s)));
    text += style.array("orders", d.orders);
    text += "/* of each order, in units of the noise: cosine, sine, how far off they may be */\n";
    text += style.array("priors", priors);
    text +=
        "/* noise in Nm; variance of the sensor and of what a sample adds to the torque; what it adds to "
        "that of "
        "torque and\n   rate, of rate, and the rate's at the start; deviation that a motor turn adds to an "
        "amplitude; 0.25 / memory in\n   turns, jump, largest slip, 1 / turns of return, 1 / noise */\n";
    text += style.array("values", code_values(d)) + style.filled(turn_code(style.is_float));
    if (d.map) text += "\n/* the map that is taken off before */\n" + MapCode(*d.map, style).definitions();
    text += style.filled(state_code);
    if (d.return_turns > 0.0) text += style.filled(back_code);
    return text + step_of(d, style);
}

LoadedCode oscillator_loaded(TextReader& reader, const OscillatorDesign& d, const CodeStyle& style) {
    reader.expect("_MINUS_RIPPLE");
    const bool minus_ripple = reader.number() > 0.0;
    return style.is_float ? loaded_code<float>(reader, d, style, minus_ripple)
                          : loaded_code<double>(reader, d, style, minus_ripple);
}

}  // namespace ripplenotch
