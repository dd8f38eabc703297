// SPDX-License-Identifier: MIT
// Notches that follow the speed, as C and as the same loops here.

#include <fmt/format.h>

#include <array>
#include <memory>
#include <utility>

#include "design/tracking_run.hpp"
#include "export/code/map_code.hpp"
#include "export/code/method_code.hpp"
#include "export/run/oscillator_run.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

namespace {

// The Kalman filter of torque and ripple as C. Its arithmetic is that of export/run/oscillator_run.hpp,
// operation by operation.

using Value = OscillatorValue;

constexpr std::string_view state_code = R"c(
typedef struct {
    @real@ x[@NAME@_STATES];      /* torque and ripple together, the torque's rate, of each order a cosine and a sine, in
                                  units of the noise; the rate is per sample */
    @real@ p[@NAME@_COVARIANCES]; /* their covariance, row by row from the diagonal on */
    @real@ h[@NAME@_STATES - 2];  /* how each order shows */
    @real@ origin, turns, slip, slipped, lost, left;
    @real@ waited; /* periods of the lowest order before what is learnt counts */
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
    s->waited = 0;
    for (i = 0; i < @NAME@_COVARIANCES; ++i) s->p[i] = 0;
    s->x[0] = s->x[1] = 0;
    s->p[0] = 1;
    s->p[@NAME@_STATES] = @name@_values.first_rate_variance;
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
/* Every sample, @NAME@_SAMPLE_RATE_HZ times a second: the torque without ripple. motor_turns is the @shaft@'s angle in
   turns, 0 where the joint is at position 0; @fraction@.@more@ */
static inline @real@ @name@_step(@name@_state* s, @real@ torque_nm, @real@ motor_turns@parameters@) {
    const @name@_constants* const c = &@name@_values;
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

constexpr std::array<std::string_view, Value::count> oscillator_names = {
    "noise_nm",        "seen_noise",     "cross_noise", "rate_noise",   "first_rate_variance",
    "amplitude_noise", "quarter_memory", "jump",        "largest_slip", "turns_to_return",
    "in_noise"};

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

std::string step_of(const OscillatorDesign& d, const CodeStyle& style) {
    std::string text = filled(std::string(step_code),
                              {{"@parameters@", d.map ? ", @real@ speed_deg_s, @real@ joint_deg" : ""},
                               {"@more@", d.map ? " speed_deg_s and joint_deg: the joint's\n   velocity and "
                                                  "position, where its map depends on them."
                                                : ""}});
    if (d.map) text += MapCode(*d.map, style).amplitudes_here();
    return text + oscillator_step_code(d) + "}\n";
}

}  // namespace

std::string oscillator_header(const OscillatorDesign& d, const CodeStyle& style) {
    const std::size_t states = 2 + 2 * d.orders.size();
    std::vector<double> priors;
    for (const auto& prior : d.priors)
        priors.insert(priors.end(), {prior.cosine, prior.sine, prior.deviation});
    std::string text = fmt::format(
        "enum {{ @NAME@_ORDERS = {}, @NAME@_STATES = {}, @NAME@_COVARIANCES = {}, @NAME@_MINUS_RIPPLE = "
        "{},\n       @NAME@_SAMPLE_RATE_HZ = {} }};\n",
        d.orders.size(), states, states * (states + 1) / 2, d.minus_ripple ? 1 : 0,
        std::lround(1.0 / d.step_s));
    text += style.array("orders", d.orders);
    text += "/* of each order, in units of the noise: cosine, sine, how far off they may be */\n";
    text += style.array("priors", priors);
    text +=
        "/* noise_nm is the unit of the state; seen_noise: variance of the sensor and of what a sample adds "
        "to the torque;\n   amplitude_noise: deviation that a turn adds; quarter_memory: 0.25 / memory in "
        "turns; in_noise: 1 / noise */\n";
    text += style.constants(oscillator_names, code_values(d));
    text += turn_code(style.is_float);
    if (d.map) text += "\n/* the map that is subtracted first */\n" + MapCode(*d.map, style).definitions();
    text += state_code;
    if (d.return_turns > 0.0) text += back_code;
    return by_shaft(text + step_of(d, style), d.orders, GearRatio(d.gear_ratio));
}

LoadedCode oscillator_loaded(TextReader& reader, const OscillatorDesign& d, const CodeStyle& style) {
    reader.expect("_MINUS_RIPPLE");
    const bool minus_ripple = reader.number() > 0.0;
    const auto orders = style.read(reader, "orders", d.orders.size());
    const auto priors = style.read(reader, "priors", 3 * d.orders.size());
    const auto values = style.read_constants(reader, Value::count);
    const auto tables = d.map ? std::optional(MapTables(reader, *d.map, style)) : std::nullopt;
    return in_precision(style.precision(), [&](auto real) -> LoadedCode {
        using Real = decltype(real);
        std::optional<MapRun<Real>> map;
        if (tables) map.emplace(*d.map, *tables);
        auto run = std::make_shared<OscillatorRun<Real>>(orders, priors, values, minus_ripple, d.waits,
                                                         std::move(map));
        return {"", [run](const CodeInput& in) { return run->step(in); }};
    });
}

namespace {

constexpr std::string_view code = R"c(
typedef struct {
    @real@ center, taken, q;
    struct {
        @real@ a1, a2, a3, damping, s1, s2;
    } notch[@NAME@_NOTCHES];
} @name@_line;

typedef struct {
    @name@_line line[@NAME@_ORDERS];
    @real@ origin, speed, tuned_for;
    int started, arrived;
} @name@_state;

/* At start, and after a gap in time. */
static inline void @name@_init(@name@_state* s) { s->started = 0; }
)c";

constexpr std::string_view tune_code = R"c(
static inline void @name@_tune(@name@_line* line, @real@ center) {
    const @name@_constants* const c = &@name@_values;
    const @real@ narrow = c->narrow_hz / center;
    int j;
    line->center = center;
    line->q = c->q_each * (narrow > 1 ? narrow : 1);
    for (j = 0; j < @NAME@_NOTCHES; ++j) {
        @real@ cosine, sine, warped, damping, a1;
        @name@_on_circle((@real@)0.5 * center * @name@_spread[j] / c->sample_rate_hz, &cosine, &sine);
        warped = sine / cosine;
        damping = 1 / line->q;
        a1 = 1 / (1 + warped * (warped + damping));
        line->notch[j].a1 = a1;
        line->notch[j].a2 = warped * a1;
        line->notch[j].a3 = warped * warped * a1;
        line->notch[j].damping = damping;
    }
}

static inline @real@ @name@_between(@real@ value, @real@ low, @real@ high) {
    return value < low ? low : value > high ? high : value;
}

/* What is left of a line at its centre. */
static inline @real@ @name@_left(int order, @real@ hz) {
    const @name@_constants* const c = &@name@_values;
    @real@ gain = c->depth_gain;
    @real@ share = @name@_weights[order] * @name@_between(((@real@)@none@ - hz / c->sample_rate_hz) / ((@real@)@none@ - (@real@)@full@), 0, 1);
    if (@NAME@_PARKS) {
        const @real@ on = @name@_between((hz / c->min_hz - (@real@)0.25) / (@real@)0.75, 0, 1);
        const @real@ root = 1 - on * (1 - @sqrt@(c->depth_gain));
        gain = root * root;
    } else if (c->fade_hz > 0) {
        share *= @name@_between((hz - c->min_hz) / c->fade_hz, 0, 1);
    } else if (hz < c->min_hz) {
        share = 0;
    }
    return 1 - share * (1 - gain);
}

static inline void @name@_follow(@name@_state* s, int starts) {
    const @name@_constants* const c = &@name@_values;
    int i;
    s->arrived = 1;
    for (i = 0; i < @NAME@_ORDERS; ++i) {
        @name@_line* const line = s->line + i;
        const @real@ hz = @name@_orders[i] * c->gear_ratio * (s->speed < 0 ? -s->speed : s->speed) / 360;
        const @real@ wanted = @name@_between(hz, c->min_hz, (@real@)@none@ * c->sample_rate_hz);
        @real@ center = wanted;
        if (!starts && c->slew < 1) center = @name@_between(wanted, line->center * (1 - c->slew), line->center / (1 - c->slew));
        if (center != wanted) s->arrived = 0;
        if (starts || center != line->center) @name@_tune(line, center);
        line->taken = 1 - @name@_left(i, hz);
    }
    s->tuned_for = s->speed;
}

/* Every sample, @NAME@_SAMPLE_RATE_HZ times a second: the torque without ripple. */
static inline @real@ @name@_step(@name@_state* s, @real@ torque_nm, @real@ @speed-name@) {
    @real@ y;
    int i, j;
    if (!s->started) {
        s->started = 1;
        s->origin = torque_nm;
        s->speed = @speed-name@;
        @name@_follow(s, 1);
        for (i = 0; i < @NAME@_ORDERS; ++i)
            for (j = 0; j < @NAME@_NOTCHES; ++j) s->line[i].notch[j].s1 = s->line[i].notch[j].s2 = 0;
    } else {
        s->speed = @speed-name@ + @name@_values.speed_pole * (s->speed - @speed-name@);
        if (s->speed != s->tuned_for || !s->arrived) @name@_follow(s, 0);
    }
    y = torque_nm - s->origin;
    for (i = 0; i < @NAME@_ORDERS; ++i) {
        for (j = 0; j < @NAME@_NOTCHES; ++j) {
            const @real@ s1 = s->line[i].notch[j].s1, s2 = s->line[i].notch[j].s2;
            const @real@ a1 = s->line[i].notch[j].a1, a2 = s->line[i].notch[j].a2, a3 = s->line[i].notch[j].a3;
            const @real@ v3 = y - s2;
            const @real@ v1 = a1 * s1 + a2 * v3;
            const @real@ v2 = s2 + a2 * s1 + a3 * v3;
            s->line[i].notch[j].s1 = v1 + v1 - s1;
            s->line[i].notch[j].s2 = v2 + v2 - s2;
            y -= s->line[i].taken * (s->line[i].notch[j].damping * v1);
        }
    }
    return s->origin + y;
}
)c";

/// The header's constants, in their order.
constexpr std::array<std::string_view, 9> tracking_names = {"gear_ratio", "sample_rate_hz", "q_each",
                                                            "narrow_hz",  "depth_gain",     "min_hz",
                                                            "fade_hz",    "speed_pole",     "slew"};
constexpr std::array tracking_values = {
    &TrackingDesign::gear_ratio, &TrackingDesign::sample_rate_hz, &TrackingDesign::q_each,
    &TrackingDesign::narrow_hz,  &TrackingDesign::depth_gain,     &TrackingDesign::min_hz,
    &TrackingDesign::fade_hz,    &TrackingDesign::speed_pole,     &TrackingDesign::slew};

// How the header comes to the tangent; all else it does as TrackingRun does it.
template <class Real>
Real warped(Real center_hz, Real relative, Real sample_rate_hz) {
    const auto at = on_circle(static_cast<Real>(0.5) * center_hz * relative / sample_rate_hz);
    return at.sine / at.cosine;
}

}  // namespace

std::string tracking_header(const TrackingDesign& d, const CodeStyle& style) {
    std::string text = fmt::format(
        "enum {{ @NAME@_ORDERS = {}, @NAME@_NOTCHES = {}, @NAME@_PARKS = {}, @NAME@_SAMPLE_RATE_HZ = {} "
        "}};\n",
        d.orders.size(), d.spread.size(), d.parks ? 1 : 0, std::lround(d.sample_rate_hz));
    text +=
        style.array("orders", d.orders) + style.array("weights", d.weights) + style.array("spread", d.spread);
    text +=
        "/* gear_ratio: turns of the shaft by which the orders count per turn of the speed's, in the speed's "
        "unit; depth_gain: gain at the centre; min_hz: lowest centre */\n";
    std::vector<double> values;
    for (const auto value : tracking_values) values.push_back(d.*value);
    text += style.constants(tracking_names, values);
    for (const std::string_view part : {code, turn_code(style.is_float), tune_code}) text += part;
    return text;
}

LoadedCode tracking_loaded(TextReader& reader, const TrackingDesign& d, const CodeStyle& style) {
    reader.expect("_PARKS");
    TrackingDesign found;
    found.parks = reader.number() > 0.0;
    found.orders = style.read(reader, "orders", d.orders.size());
    found.weights = style.read(reader, "weights", d.orders.size());
    found.spread = style.read(reader, "spread", d.spread.size());
    const auto values = style.read_constants(reader, tracking_values.size());
    for (std::size_t i = 0; i < values.size(); ++i) found.*tracking_values[i] = values[i];
    return in_precision(style.precision(), [&](auto real) -> LoadedCode {
        using Real = decltype(real);
        auto run = std::make_shared<TrackingRun<Real>>(found, warped<Real>);
        return {"", [run](const CodeInput& in) {
                    return static_cast<double>(
                        run->next(static_cast<Real>(in.torque_nm), static_cast<Real>(in.speed_deg_s)));
                }};
    });
}

}  // namespace ripplenotch
