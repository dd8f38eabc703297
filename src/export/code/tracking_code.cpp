// SPDX-License-Identifier: MIT
// Notches that follow the speed, as C and as the same loops here.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "export/code/method_code_parts.hpp"
#include "ripplenotch/design/rate_edge.hpp"

namespace ripplenotch {
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
