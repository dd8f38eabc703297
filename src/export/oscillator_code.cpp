// SPDX-License-Identifier: MIT
// The Kalman filter of torque and ripple as C. Its arithmetic is that of export/oscillator_run.hpp, operation
// by operation.
#include <fmt/format.h>

#include <memory>

#include "export/method_code_parts.hpp"
#include "export/oscillator_run.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view begin_code = R"c(
typedef struct {
    @real@ x[@NAME@_STATES], h[@NAME@_STATES], ph[@NAME@_STATES];
    @real@ p[@NAME@_STATES][@NAME@_STATES]; /* of the covariance, what is above the diagonal */
    @real@ origin, turns, slip, slipped, surprise;
    int started;
} @name@_state;

/* At start, and after a gap in time. */
static inline void @name@_init(@name@_state* s) { s->started = 0; }

static inline void @name@_look(@name@_state* s, @real@ turns, @real@ step) {
    const @real@ size = step < 0 ? -step : step;
    int i;
    for (i = 0; i < @NAME@_ORDERS; ++i) {
        const @real@ n = @name@_orders[i], cycles = n * turns;
        @real@ share = ((@real@)0.48 - n * size) / ((@real@)0.48 - (@real@)0.45), cosine, sine;
        share = share < 0 ? 0 : share > 1 ? 1 : share;
        @name@_on_circle(cycles - @floor@(cycles), &cosine, &sine);
        s->h[2 + 2 * i] = share * cosine;
        s->h[3 + 2 * i] = share * sine;
    }
}

static inline @real@ @name@_ripple(const @name@_state* s) {
    @real@ sum = 0;
    int i;
    for (i = 2; i < @NAME@_STATES; ++i) sum += s->h[i] * s->x[i];
    return sum;
}

static inline void @name@_begin(@name@_state* s, @real@ torque_nm, @real@ turns) {
    @real@ variance = 1;
    int i, j;
    s->started = 1;
    s->origin = torque_nm;
    s->slip = s->slipped = s->surprise = 0;
    @name@_look(s, turns, 0);
    for (i = 0; i < @NAME@_STATES; ++i)
        for (j = 0; j < @NAME@_STATES; ++j) s->p[i][j] = 0;
    for (i = 2; i < @NAME@_STATES; ++i) {
        const @real@* const prior = @name@_priors + 3 * (i / 2 - 1);
        const @real@ square = prior[2] * prior[2];
        s->x[i] = prior[i % 2];
        s->p[i][i] = square;
        s->p[0][i] = -square * s->h[i];
        variance += square * s->h[i] * s->h[i];
    }
    s->x[0] = -@name@_ripple(s);
    s->x[1] = 0;
    s->p[0][0] = variance;
    s->p[1][1] = @name@_values[5];
}
)c";

constexpr std::string_view update_code = R"c(
static inline void @name@_predict(@name@_state* s, @real@ step) {
    const @real@* const c = @name@_values;
    const @real@ share = step / c[6], added = 2 * share * share;
    int j;
    s->x[0] += c[0] * s->x[1];
    s->p[0][0] += c[0] * s->p[0][1];
    for (j = 1; j < @NAME@_STATES; ++j) s->p[0][j] += c[0] * s->p[1][j];
    s->p[0][0] += c[0] * s->p[0][1];
    s->p[0][0] += c[2];
    s->p[0][1] += c[3];
    s->p[1][1] += c[4];
    for (j = 2; j < @NAME@_STATES; ++j) s->p[j][j] += added;
}

static inline void @name@_update(@name@_state* s, @real@ measured) {
    const @real@ jump = @name@_values[7];
    @real@ expected = s->x[0], variance = 1, surprise, scale;
    int i, j;
    for (i = 0; i < @NAME@_STATES; ++i) {
        @real@ sum = s->p[0][i];
        for (j = 2; j < @NAME@_STATES; ++j) sum += (i < j ? s->p[i][j] : s->p[j][i]) * s->h[j];
        s->ph[i] = sum;
        if (i == 0) variance += sum;
        if (i >= 2) {
            expected += s->h[i] * s->x[i];
            variance += s->h[i] * sum;
        }
    }
    surprise = measured - expected;
    /* What the model holds for next to impossible is a torque that jumped. */
    if (jump > 0 && surprise * surprise > jump * jump * variance) {
        const @real@ added = surprise * surprise;
        s->p[0][0] += added;
        s->ph[0] += added;
        variance += added;
    }
    scale = 1 / variance;
    s->surprise = surprise * scale;
    for (i = 0; i < @NAME@_STATES; ++i) {
        const @real@ gain = s->ph[i] * scale;
        s->x[i] += gain * surprise;
        for (j = i; j < @NAME@_STATES; ++j) s->p[i][j] -= gain * s->ph[j];
    }
}

/* By how much the ripple's phase ran ahead of the angle, in motor turns. */
static inline @real@ @name@_ahead(const @name@_state* s) {
    @real@ advance = 0, weights = 0;
    int i;
    for (i = 2; i < @NAME@_STATES; i += 2) {
        const @real@ a = s->x[i], b = s->x[i + 1], n = @name@_orders[i / 2 - 1], square = a * a + b * b;
        if (square <= 9 * (s->p[i][i] + s->p[i + 1][i + 1])) continue;
        advance -= n * ((a * s->ph[i + 1] - b * s->ph[i]) * s->surprise);
        weights += n * n * square;
    }
    return weights > 0 ? advance / ((@real@)6.283185307179586 * weights) : 0;
}
)c";

constexpr std::string_view step_code = R"c(
/* Every sample, @NAME@_SAMPLE_RATE_HZ times a second: the torque without ripple. motor_turns is the motor's angle in
   turns, 0 where the joint is at position 0; the fraction of the turn is enough. */
static inline @real@ @name@_step(@name@_state* s, @real@ torque_nm, @real@ motor_turns) {
    const @real@ noise = @name@_values[1], most = @name@_values[8];
    if (!s->started) {
        @name@_begin(s, torque_nm, motor_turns);
    } else {
        @real@ moved = motor_turns - s->turns, step;
        moved -= @floor@(moved + (@real@)0.5);
        step = moved * (1 + s->slip);
        s->slipped += moved * s->slip;
        s->slipped -= @floor@(s->slipped);
        @name@_predict(s, step);
        @name@_look(s, motor_turns + s->slipped, step);
        @name@_update(s, (torque_nm - s->origin) / noise);
        if (most > 0) {
            const @real@ size = step < 0 ? -step : step;
            if (size > (@real@)1e-5) {
                @real@ share = size / (4 * @name@_values[6]);
                share = share < (@real@)0.01 ? share : (@real@)0.01;
                s->slip += share * @name@_ahead(s) / step;
                s->slip = s->slip < -most ? -most : s->slip > most ? most : s->slip;
            }
        }
    }
    s->turns = motor_turns;
    return @NAME@_MINUS_RIPPLE ? torque_nm - noise * @name@_ripple(s) : s->origin + noise * s->x[0];
}
)c";

}  // namespace

std::string oscillator_header(const OscillatorDesign& d, const CodeStyle& style) {
    std::vector<double> priors;
    for (const auto& prior : d.priors)
        priors.insert(priors.end(), {prior.cosine, prior.sine, prior.deviation});
    std::string text = style.filled(fmt::format(
        "enum {{ @NAME@_ORDERS = {}, @NAME@_STATES = {}, @NAME@_MINUS_RIPPLE = {}, @NAME@_SAMPLE_RATE_HZ = "
        "{} }};\n",
        d.orders.size(), 2 + 2 * d.orders.size(), d.minus_ripple ? 1 : 0, std::lround(1.0 / d.step_s)));
    text += style.array("orders", d.orders);
    text += "/* of each order, in units of the noise: cosine, sine, how far off they may be */\n";
    text += style.array("priors", priors);
    text +=
        "/* seconds a sample, noise in Nm; what a sample adds to the variance of torque, to that of torque "
        "and rate, "
        "of rate;\n   variance of the rate at the start, memory in motor turns, jump, largest slip */\n";
    text += style.array("values", {d.step_s, d.noise_nm, d.torque_noise, d.cross_noise, d.rate_noise,
                                   d.first_rate_variance, d.memory_turns, d.jump, d.largest_slip});
    return text + style.filled(turn_code(style.is_float)) + style.filled(begin_code) +
           style.filled(update_code) + style.filled(step_code);
}

LoadedCode oscillator_loaded(TextReader& reader, const OscillatorDesign& d, const CodeStyle& style) {
    reader.expect("_MINUS_RIPPLE");
    const bool minus_ripple = reader.number() > 0.0;
    const auto orders = style.read(reader, "orders", d.orders.size());
    const auto priors = style.read(reader, "priors", 3 * d.orders.size());
    const auto values = style.read(reader, "values", 9);
    LoadedCode loaded;
    loaded.by_angle = true;
    if (style.is_float) {
        auto run = std::make_shared<OscillatorRun<float>>(orders, priors, values, minus_ripple);
        loaded.step = [run](double torque, double turns) { return run->step(torque, turns); };
    } else {
        auto run = std::make_shared<OscillatorRun<double>>(orders, priors, values, minus_ripple);
        loaded.step = [run](double torque, double turns) { return run->step(torque, turns); };
    }
    return loaded;
}

}  // namespace ripplenotch
