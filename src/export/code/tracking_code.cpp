// SPDX-License-Identifier: MIT
// Notches that follow the speed, as C and as the same loops here.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

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
    const @real@* const c = @name@_values;
    const @real@ narrow = c[3] / center;
    int j;
    line->center = center;
    line->q = c[2] * (narrow > 1 ? narrow : 1);
    for (j = 0; j < @NAME@_NOTCHES; ++j) {
        @real@ cosine, sine, warped, damping, a1;
        @name@_on_circle((@real@)0.5 * center * @name@_spread[j] / c[1], &cosine, &sine);
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
    const @real@* const c = @name@_values;
    @real@ gain = c[4];
    @real@ share = @name@_weights[order] * @name@_between(((@real@)@none@ - hz / c[1]) / ((@real@)@none@ - (@real@)@full@), 0, 1);
    if (@NAME@_PARKS) {
        const @real@ on = @name@_between((hz / c[5] - (@real@)0.25) / (@real@)0.75, 0, 1);
        const @real@ root = 1 - on * (1 - @sqrt@(c[4]));
        gain = root * root;
    } else if (c[6] > 0) {
        share *= @name@_between((hz - c[5]) / c[6], 0, 1);
    } else if (hz < c[5]) {
        share = 0;
    }
    return 1 - share * (1 - gain);
}

static inline void @name@_follow(@name@_state* s, int starts) {
    const @real@* const c = @name@_values;
    int i;
    s->arrived = 1;
    for (i = 0; i < @NAME@_ORDERS; ++i) {
        @name@_line* const line = s->line + i;
        const @real@ hz = @name@_orders[i] * c[0] * (s->speed < 0 ? -s->speed : s->speed) / 360;
        const @real@ wanted = @name@_between(hz, c[5], (@real@)@none@ * c[1]);
        @real@ center = wanted;
        if (!starts && c[8] < 1) center = @name@_between(wanted, line->center * (1 - c[8]), line->center / (1 - c[8]));
        if (center != wanted) s->arrived = 0;
        if (starts || center != line->center) @name@_tune(line, center);
        line->taken = 1 - @name@_left(i, hz);
    }
    s->tuned_for = s->speed;
}

/* Every sample, @NAME@_SAMPLE_RATE_HZ times a second: the torque without ripple. */
static inline @real@ @name@_step(@name@_state* s, @real@ torque_nm, @real@ speed_deg_s) {
    @real@ y;
    int i, j;
    if (!s->started) {
        s->started = 1;
        s->origin = torque_nm;
        s->speed = speed_deg_s;
        @name@_follow(s, 1);
        for (i = 0; i < @NAME@_ORDERS; ++i)
            for (j = 0; j < @NAME@_NOTCHES; ++j) s->line[i].notch[j].s1 = s->line[i].notch[j].s2 = 0;
    } else {
        s->speed = speed_deg_s + @name@_values[7] * (s->speed - speed_deg_s);
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

// The code above, operation by operation.
template <class Real>
class Runner {
  public:
    Runner(std::vector<double> orders, std::vector<double> weights, std::vector<double> spread,
           const std::vector<double>& values, bool parks)
        : orders_(orders.begin(), orders.end()),
          weights_(weights.begin(), weights.end()),
          spread_(spread.begin(), spread.end()),
          c_(values.begin(), values.end()),
          parks_(parks),
          lines_(orders_.size()) {
        for (Line& line : lines_) line.notches.resize(spread_.size());
    }

    double step(double torque_nm, double speed_deg_s) {
        const Real torque = static_cast<Real>(torque_nm), speed = static_cast<Real>(speed_deg_s);
        if (!started_) {
            started_ = true;
            origin_ = torque;
            speed_ = speed;
            follow(true);
        } else {
            speed_ = speed + c_[7] * (speed_ - speed);
            if (speed_ != tuned_for_ || !arrived_) follow(false);
        }
        Real y = torque - origin_;
        for (Line& line : lines_) {
            for (Notch& n : line.notches) {
                const Real v3 = y - n.s2;
                const Real v1 = n.a1 * n.s1 + n.a2 * v3;
                const Real v2 = n.s2 + n.a2 * n.s1 + n.a3 * v3;
                n.s1 = v1 + v1 - n.s1;
                n.s2 = v2 + v2 - n.s2;
                y -= line.taken * (n.damping * v1);
            }
        }
        return static_cast<double>(origin_ + y);
    }

  private:
    struct Notch {
        Real a1 = 0, a2 = 0, a3 = 0, damping = 0, s1 = 0, s2 = 0;
    };
    struct Line {
        Real center = 0, taken = 0;
        std::vector<Notch> notches;
    };

    void follow(bool starts) {
        arrived_ = true;
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            Line& line = lines_[i];
            const Real hz = orders_[i] * c_[0] * std::abs(speed_) / 360;
            const Real wanted = std::clamp(hz, c_[5], static_cast<Real>(none_above_rate) * c_[1]);
            Real center = wanted;
            if (!starts && c_[8] < 1)
                center = std::clamp(wanted, line.center * (1 - c_[8]), line.center / (1 - c_[8]));
            if (center != wanted) arrived_ = false;
            if (starts || center != line.center) tune(line, center);
            line.taken = 1 - left(i, hz);
        }
        tuned_for_ = speed_;
    }
    void tune(Line& line, Real center) {
        line.center = center;
        const Real q = c_[2] * std::max(c_[3] / center, Real(1));
        for (std::size_t j = 0; j < spread_.size(); ++j) {
            const auto at = on_circle(static_cast<Real>(0.5) * center * spread_[j] / c_[1]);
            const Real warped = at.sine / at.cosine, damping = 1 / q;
            const Real a1 = 1 / (1 + warped * (warped + damping));
            Notch& n = line.notches[j];
            n.a1 = a1;
            n.a2 = warped * a1;
            n.a3 = warped * warped * a1;
            n.damping = damping;
        }
    }
    [[nodiscard]] Real left(std::size_t i, Real hz) const {
        const auto share_of = [](Real value) { return std::clamp(value, Real(0), Real(1)); };
        const Real none = static_cast<Real>(none_above_rate), full = static_cast<Real>(full_below_rate);
        Real gain = c_[4], share = weights_[i] * share_of((none - hz / c_[1]) / (none - full));
        if (parks_) {
            const Real on = share_of((hz / c_[5] - static_cast<Real>(0.25)) / static_cast<Real>(0.75));
            const Real root = 1 - on * (1 - std::sqrt(c_[4]));
            gain = root * root;
        } else if (c_[6] > 0) {
            share *= share_of((hz - c_[5]) / c_[6]);
        } else if (hz < c_[5]) {
            share = 0;
        }
        return 1 - share * (1 - gain);
    }

    std::vector<Real> orders_, weights_, spread_, c_;
    bool parks_;
    std::vector<Line> lines_;
    Real origin_ = 0, speed_ = 0, tuned_for_ = 0;
    bool started_ = false, arrived_ = false;
};

}  // namespace

std::string tracking_header(const TrackingDesign& d, const CodeStyle& style) {
    std::string text = style.filled(
        fmt::format("enum {{ @NAME@_ORDERS = {}, @NAME@_NOTCHES = {}, @NAME@_PARKS = {}, "
                    "@NAME@_SAMPLE_RATE_HZ = {} }};\n",
                    d.orders.size(), d.spread.size(), d.parks ? 1 : 0, std::lround(d.sample_rate_hz)));
    text +=
        style.array("orders", d.orders) + style.array("weights", d.weights) + style.array("spread", d.spread);
    text +=
        "/* gear ratio, sample rate, Q, narrow below, gain at the centre, lowest centre, fade, speed pole, "
        "slew */\n";
    text += style.array("values", {d.gear_ratio, d.sample_rate_hz, d.q_each, d.narrow_hz, d.depth_gain,
                                   d.min_hz, d.fade_hz, d.speed_pole, d.slew});
    return text + style.filled(code) + style.filled(turn_code(style.is_float)) + style.filled(tune_code);
}

LoadedCode tracking_loaded(TextReader& reader, const TrackingDesign& d, const CodeStyle& style) {
    reader.expect("_PARKS");
    const bool parks = reader.number() > 0.0;
    const auto orders = style.read(reader, "orders", d.orders.size());
    const auto weights = style.read(reader, "weights", d.orders.size());
    const auto spread = style.read(reader, "spread", d.spread.size());
    const auto values = style.read(reader, "values", 9);
    LoadedCode loaded;
    if (style.is_float) {
        auto runner = std::make_shared<Runner<float>>(orders, weights, spread, values, parks);
        loaded.step = [runner](const CodeInput& in) { return runner->step(in.torque_nm, in.speed_deg_s); };
    } else {
        auto runner = std::make_shared<Runner<double>>(orders, weights, spread, values, parks);
        loaded.step = [runner](const CodeInput& in) { return runner->step(in.torque_nm, in.speed_deg_s); };
    }
    return loaded;
}

}  // namespace ripplenotch
