// SPDX-License-Identifier: MIT
// The Kalman filter of torque and ripple as C. Its arithmetic is that of export/oscillator_run.hpp, operation
// by operation.
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "export/method_code_parts.hpp"
#include "export/oscillator_run.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view state_code = R"c(
typedef struct {
    @real@ x[@NAME@_STATES];      /* torque, its rate, of each order a cosine and a sine, in units of the noise */
    @real@ p[@NAME@_COVARIANCES]; /* their covariance, row by row from the diagonal on */
    @real@ origin, turns, slip, slipped, lost;
    int started;
} @name@_state;

/* At start, and after a gap in time. */
static inline void @name@_init(@name@_state* s) { s->started = 0; }

/* Of cycles a sample. */
static inline void @name@_fade(@real@ rate, @real@* cosine, @real@* sine) {
    if (rate > (@real@)0.45) {
        const @real@ share = rate < (@real@)0.48 ? ((@real@)0.48 - rate) / ((@real@)0.48 - (@real@)0.45) : 0;
        *cosine = share * *cosine;
        *sine = share * *sine;
    }
}

)c";

constexpr std::string_view begin_code = R"c(
static inline @real@ @name@_begin(@name@_state* s, @real@ torque_nm, @real@ turns) {
    @real@ variance = 1, ripple = 0, h[@NAME@_STATES];
    int i;
    s->started = 1;
    s->origin = torque_nm;
    s->turns = turns;
    s->slip = s->slipped = s->lost = 0;
    for (i = 0; i < @NAME@_COVARIANCES; ++i) s->p[i] = 0;
    @name@_look(turns, 0, h);
    for (i = 2; i < @NAME@_STATES; ++i) {
        const @real@* const prior = @name@_priors + 3 * (i / 2 - 1);
        const @real@ square = prior[2] * prior[2];
        s->x[i] = prior[i % 2];
        s->p[i * @NAME@_STATES - i * (i - 1) / 2] = square;
        s->p[i] = -square * h[i];
        variance += square * h[i] * h[i];
        ripple += h[i] * s->x[i];
    }
    s->x[0] = -ripple;
    s->x[1] = 0;
    s->p[0] = variance;
    s->p[@NAME@_STATES] = @name@_values[5];
    return @NAME@_MINUS_RIPPLE ? torque_nm - @name@_values[1] * ripple : torque_nm + @name@_values[1] * s->x[0];
}
)c";

constexpr std::string_view step_code = R"c(
/* Every sample, @NAME@_SAMPLE_RATE_HZ times a second: the torque without ripple. motor_turns is the motor's angle in
   turns, 0 where the joint is at position 0; the fraction of the turn is enough. */
static inline @real@ @name@_step(@name@_state* s, @real@ torque_nm, @real@ motor_turns) {
    const @real@* const c = @name@_values;
    @real@* const x = s->x;
    @real@* const p = s->p;
    @real@ moved, step, size, slipped, added, measured, expected, variance, surprise, scale, gain@ripple@;
    @real@ h[@NAME@_STATES], ph[@NAME@_STATES];
    if (!s->started) return @name@_begin(s, torque_nm, motor_turns);
    moved = motor_turns - s->turns;
    moved -= @name@_floor(moved + (@real@)0.5);
    step = moved * (1 + s->slip);
    size = step < 0 ? -step : step;
    /* Added up with what rounding took off before (Kahan): a phase that drifts is not forgotten at rest. */
    added = moved * s->slip - s->lost;
    slipped = s->slipped + added;
    s->lost = (slipped - s->slipped) - added;
    s->slipped = slipped > 1 ? slipped - 1 : slipped < -1 ? slipped + 1 : slipped;
    s->turns = motor_turns;
    measured = (torque_nm - s->origin) / c[1];
    added = step / c[6];
    added = 2 * added * added;
)c";

constexpr std::string_view jump_code = R"c(
    /* What the model holds for next to impossible is a torque that jumped. */
    if (c[7] > 0 && surprise * surprise > c[7] * c[7] * variance) {
        const @real@ square = surprise * surprise;
        p[0] += square;
        ph[0] += square;
        variance += square;
    }
    scale = 1 / variance;
)c";

// The filter's matrices written out, element by element: a compiler keeps what it can in registers.
class MatrixCode {
  public:
    explicit MatrixCode(const std::vector<double>& orders) : orders_(orders), m_(2 + 2 * orders.size()) {}

    // How the orders show at an angle. An order twice another one is its double angle.
    std::string look() {
        line("\nstatic inline void @name@_look(@real@ turns, @real@ size, @real@* h) {{");
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const std::size_t half = half_of(orders_, i), a = 2 + 2 * i, of = 2 + 2 * half;
            if (half < i) {
                line("    h[{}] = 1 - 2 * h[{}] * h[{}];\n    h[{}] = 2 * h[{}] * h[{}];", a, of + 1, of + 1,
                     a + 1, of, of + 1);
            } else {
                line(
                    "    @name@_on_circle(@name@_orders[{0}] * turns - @name@_floor(@name@_orders[{0}] * "
                    "turns), h + {1}, "
                    "h + {2});",
                    i, a, a + 1);
            }
        }
        for (std::size_t i = 0; i < orders_.size(); ++i)
            line("    @name@_fade(@name@_orders[{}] * size, h + {}, h + {});", i, 2 + 2 * i, 3 + 2 * i);
        line("}}");
        return std::move(text_);
    }
    std::string step() {
        predict();
        line("    @name@_look(motor_turns + s->slipped, size, h);");
        update();
        correct();
        return std::move(text_);
    }
    std::string last() {
        line("    ripple = 0;");
        for (std::size_t i = 2; i < m_; ++i) line("    ripple += h[{0}] * x[{0}];", i);
        return std::move(text_);
    }

  private:
    template <class... Values>
    void line(std::string_view format, const Values&... values) {
        text_ += fmt::format(fmt::runtime(format), values...) + "\n";
    }
    [[nodiscard]] std::size_t p(std::size_t i, std::size_t j) const {
        if (i > j) std::swap(i, j);
        return i * m_ + j - i * (i + 1) / 2;
    }

    void predict() {
        line("    x[0] += c[0] * x[1];\n    p[0] += c[0] * p[1];");
        for (std::size_t j = 1; j < m_; ++j) line("    p[{}] += c[0] * p[{}];", j, p(1, j));
        line("    p[0] += c[0] * p[1];\n    p[0] += c[2];\n    p[1] += c[3];\n    p[{}] += c[4];", p(1, 1));
        for (std::size_t j = 2; j < m_; ++j) line("    p[{}] += added;", p(j, j));
    }
    void update() {
        for (std::size_t i = 0; i < m_; ++i) {
            text_ += fmt::format("    ph[{}] = p[{}]", i, p(0, i));
            for (std::size_t j = 2; j < m_; ++j) text_ += fmt::format(" + p[{}] * h[{}]", p(i, j), j);
            line(";");
        }
        line("    expected = x[0];\n    variance = 1 + ph[0];");
        for (std::size_t i = 2; i < m_; ++i)
            line("    expected += h[{0}] * x[{0}];\n    variance += h[{0}] * ph[{0}];", i);
        text_ += "    surprise = measured - expected;" + std::string(jump_code);
        for (std::size_t i = 0; i < m_; ++i) {
            line("    gain = ph[{0}] * scale;\n    x[{0}] += gain * surprise;", i);
            for (std::size_t j = i; j < m_; ++j) line("    p[{}] -= gain * ph[{}];", p(i, j), j);
        }
    }
    // What the ripple's phase says of the angle's rate.
    void correct() {
        line("    if (c[8] > 0 && size > (@real@)1e-5) {{");
        line("        @real@ ahead = 0, weights = 0, share = size / (4 * c[6]);");
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const std::size_t a = 2 + 2 * i, b = a + 1;
            line(
                "        {{\n            const @real@ n = @name@_orders[{}], square = x[{}] * x[{}] + x[{}] "
                "* "
                "x[{}];",
                i, a, a, b, b);
            line("            if (square > 9 * (p[{}] + p[{}])) {{", p(a, a), p(b, b));
            line("                ahead -= n * ((x[{}] * ph[{}] - x[{}] * ph[{}]) * (surprise * scale));", a,
                 b, b, a);
            line("                weights += n * n * square;\n            }}\n        }}");
        }
        line("        if (weights > 0) {{");
        line("            share = share < (@real@)0.01 ? share : (@real@)0.01;");
        line("            s->slip += share * (ahead / ((@real@)6.283185307179586 * weights)) / step;");
        line(
            "            s->slip = s->slip < -c[8] ? -c[8] : s->slip > c[8] ? c[8] : s->slip;\n        }}\n  "
            "  }}");
    }

    const std::vector<double>& orders_;
    std::size_t m_;
    std::string text_;
};

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
        "/* seconds a sample, noise in Nm; what a sample adds to the variance of torque, to that of torque "
        "and rate, "
        "of rate;\n   variance of the rate at the start, memory in motor turns, jump, largest slip */\n";
    text += style.array("values", {d.step_s, d.noise_nm, d.torque_noise, d.cross_noise, d.rate_noise,
                                   d.first_rate_variance, d.memory_turns, d.jump, d.largest_slip});
    text += style.filled(turn_code(style.is_float)) + style.filled(state_code) +
            style.filled(MatrixCode(d.orders).look()) + style.filled(begin_code);
    std::string step = style.filled(step_code);
    step.replace(step.find("@ripple@"), 8, d.minus_ripple ? ", ripple" : "");
    text += step;
    text += style.filled(MatrixCode(d.orders).step());
    if (!d.minus_ripple) return text + style.filled("    return s->origin + c[1] * x[0];\n}\n");
    return text + MatrixCode(d.orders).last() + "    return torque_nm - c[1] * ripple;\n}\n";
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
