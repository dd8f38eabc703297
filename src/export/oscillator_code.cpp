// SPDX-License-Identifier: MIT
// The Kalman filter of torque and ripple as C. Its arithmetic is that of export/oscillator_run.hpp, operation
// by operation, written out: a compiler keeps what it can in registers.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "export/map_code.hpp"
#include "export/method_code_parts.hpp"
#include "export/oscillator_run.hpp"

namespace ripplenotch {
namespace {

using Value = OscillatorValue;

constexpr std::string_view state_code = R"c(
typedef struct {
    @real@ x[@NAME@_STATES];      /* torque and ripple together, the torque's rate, of each order a cosine and a sine, in
                                  units of the noise */
    @real@ p[@NAME@_COVARIANCES]; /* their covariance, row by row from the diagonal on */
    @real@ h[@NAME@_STATES - 2];  /* how each order shows */
    @real@ origin, turns, slip, slipped, lost;
    int started;
} @name@_state;

/* At start, and after a gap in time. */
static inline void @name@_init(@name@_state* s) { s->started = 0; }

/* The first sample: its torque is anything at all. */
static inline void @name@_begin(@name@_state* s, @real@ torque_nm) {
    int i;
    s->started = 1;
    s->origin = torque_nm;
    for (i = 0; i < @NAME@_COVARIANCES; ++i) s->p[i] = 0;
    s->x[0] = s->x[1] = 0;
    s->p[0] = 1;
    s->p[@NAME@_STATES] = @name@_values[5];
    for (i = 2; i < @NAME@_STATES; ++i) {
        const @real@* const prior = @name@_priors + 3 * (i / 2 - 1);
        s->x[i] = prior[i % 2];
        s->p[i * @NAME@_STATES - i * (i - 1) / 2] = prior[2] * prior[2];
    }
}

/* An order that nears half the sample rate is let go; rate in cycles a sample. */
static inline void @name@_fade(@real@ rate, @real@* cosine, @real@* sine, @real@* squares) {
    if (rate > (@real@)0.45) {
        const @real@ share = rate < (@real@)0.48 ? ((@real@)0.48 - rate) / ((@real@)0.48 - (@real@)0.45) : 0;
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
    @real@ moved = s->started ? motor_turns - s->turns : 0, squares = @NAME@_ORDERS;
)c";

// Added up with what rounding took off before (Kahan): a phase that drifts is not forgotten at rest.
constexpr std::string_view slip_code = R"c(    if (!s->started) s->slip = s->slipped = s->lost = 0;
    const @real@ step = moved * (1 + s->slip), size = @abs@(step);
    const @real@ slip_added = moved * s->slip - s->lost, slipped = s->slipped + slip_added;
    s->lost = (slipped - s->slipped) - slip_added;
    s->slipped = slipped > 1 ? slipped - 1 : slipped < -1 ? slipped + 1 : slipped;
)c";

// What the model holds for next to impossible is a torque that jumped.
constexpr std::string_view jump_code = R"c(    if (surprise * surprise > c[7] * c[7] * variance) {
        v0 += surprise * surprise;
        variance += surprise * surprise;
    }
)c";

class StepCode {
  public:
    explicit StepCode(const OscillatorDesign& design)
        : d_(design), m_(2 + 2 * design.orders.size()), slips_(design.largest_slip > 0.0) {}

    std::string written() {
        look();
        line("    if (s->started) {{");
        predict();
        update();
        if (slips_) correct();
        line("    }} else {{\n        @name@_begin(s, torque_nm);\n    }}");
        for (std::size_t i = 2; i < m_; ++i) line("    s->h[{}] = {};", i - 2, h(i));
        text_ += "    s->turns = motor_turns;\n    const @real@ ripple = ";
        for (std::size_t i = 2; i < m_; ++i)
            text_ += fmt::format("{}{} * s->x[{}]", i > 2 ? " + " : "", h(i), i);
        line(d_.minus_ripple ? ";\n    return torque_nm - c[1] * ripple;"
                             : ";\n    return s->origin + c[1] * (s->x[0] - ripple);");
        return std::move(text_);
    }

  private:
    template <class... Values>
    void line(std::string_view format, const Values&... values) {
        text_ += fmt::format(fmt::runtime(format), values...) + "\n";
    }
    // Names: of covariances p_1_3, of how an order shows c0 and s0.
    [[nodiscard]] static std::string p(std::size_t i, std::size_t j) {
        return fmt::format("p_{}_{}", std::min(i, j), std::max(i, j));
    }
    [[nodiscard]] static std::string h(std::size_t i) {
        return fmt::format("{}{}", i % 2 == 0 ? 'c' : 's', i / 2 - 1);
    }
    [[nodiscard]] std::size_t place(std::size_t i, std::size_t j) const {
        return i * m_ + j - i * (i + 1) / 2;
    }

    void look() {
        const std::size_t fastest = static_cast<std::size_t>(
            std::max_element(d_.orders.begin(), d_.orders.end()) - d_.orders.begin());
        text_ += slips_ ? std::string(slip_code) : "    const @real@ size = @abs@(moved);\n";
        text_.insert(0, "    moved -= @name@_floor(moved + (@real@)0.5);\n");
        text_ += order_angles_code(d_.orders, slips_ ? "motor_turns + s->slipped" : "motor_turns");
        line("    if (@name@_orders[{}] * size > (@real@)0.45) {{", fastest);
        for (std::size_t i = 0; i < d_.orders.size(); ++i)
            line("        @name@_fade(@name@_orders[{0}] * size, &c{0}, &s{0}, &squares);", i);
        line("    }}");
        if (!d_.map) return;
        text_ += "    torque_nm -= ";
        for (std::size_t i = 2; i < m_; ++i)
            text_ += fmt::format("{}z[{}] * {}", i > 2 ? " + " : "", i - 2, h(i));
        text_ += ";\n";
    }
    void load() {
        for (std::size_t i = 0; i < m_; ++i) {
            text_ += "        @real@ ";
            for (std::size_t j = i; j < m_; ++j)
                text_ += fmt::format("{} = s->p[{}]{}", p(i, j), place(i, j), j + 1 < m_ ? ", " : ";\n");
        }
    }
    void predict() {
        const bool forgets = d_.return_turns > 0.0;
        line("        const @real@ share = size * c[6], added = 2 * share * share;");
        if (forgets) line("        const @real@ left = 1 - size * c[9], kept = left > 0 ? left : 0;");
        text_ += "        const @real@ ";
        for (std::size_t i = 2; i < m_; ++i)
            text_ += fmt::format("d{} = {}{} - s->h[{}]{}", i, forgets ? "kept * " : "", h(i), i - 2,
                                 i + 1 < m_ ? ", " : ";\n");
        load();
        for (std::size_t i = 0; i < m_; ++i) {
            text_ += fmt::format("        @real@ v{} = {} + c[0] * {}", i, p(0, i), p(1, i));
            for (std::size_t k = 2; k < m_; ++k) text_ += fmt::format(" + d{} * {}", k, p(k, i));
            line(";");
        }
        text_ += "        v0 = v0 + c[0] * v1";
        for (std::size_t k = 2; k < m_; ++k) text_ += fmt::format(" + d{} * v{}", k, k);
        line(" + added * squares + c[2];\n        v1 += c[3];\n        p_1_1 += c[4];");
        text_ += "        const @real@ expected = s->x[0] + c[0] * s->x[1]";
        for (std::size_t k = 2; k < m_; ++k) text_ += fmt::format(" + d{0} * s->x[{0}]", k);
        line(";");
        if (forgets) forget();
        for (std::size_t i = 2; i < m_; ++i)
            line("        v{0} += added * {1};\n        {2} += added;", i, h(i), p(i, i));
    }
    void forget() {
        line("        const @real@ square = kept * kept;");
        for (std::size_t i = 2; i < m_; ++i) {
            line("        s->x[{0}] *= kept;\n        v{0} *= kept;\n        p_1_{0} *= kept;", i);
            for (std::size_t j = i; j < m_; ++j) line("        {} *= square;", p(i, j));
        }
    }
    void update() {
        line(
            "        const @real@ surprise = (torque_nm - s->origin) / c[1] - expected;\n"
            "        @real@ variance = 1 + v0;");
        if (d_.jump > 0.0) text_ += jump_code;
        line("        const @real@ scale = 1 / variance;");
        for (std::size_t i = 0; i < m_; ++i) {
            line("        const @real@ g{0} = v{0} * scale;", i);
            line(i == 0 ? "        s->x[0] = expected + g0 * surprise;"
                        : "        s->x[{0}] += g{0} * surprise;",
                 i);
            // Of the first state the rest is the gain itself.
            line("        s->p[{0}] = g{0};", i);
        }
        for (std::size_t i = 1; i < m_; ++i)
            for (std::size_t j = i; j < m_; ++j) {
                line("        {} -= g{} * v{};", p(i, j), i, j);
                line("        s->p[{}] = {};", place(i, j), p(i, j));
            }
    }
    // What the ripple's phase says of the angle's rate.
    void correct() {
        line("        if (size > (@real@)1e-5) {{\n            @real@ ahead = 0, weights = 0;");
        for (std::size_t i = 2; i < m_; i += 2) {
            line("            {{\n                const @real@ n = @name@_orders[{}];", i / 2 - 1);
            line("                const @real@ square = s->x[{0}] * s->x[{0}] + s->x[{1}] * s->x[{1}];", i,
                 i + 1);
            line("                if (square > 9 * ({} + {})) {{", p(i, i), p(i + 1, i + 1));
            line("                    ahead -= n * (s->x[{0}] * v{1} - s->x[{1}] * v{0});", i, i + 1);
            line("                    weights += n * n * square;\n                }}\n            }}");
        }
        line("            if (weights > 0) {{\n                @real@ of = (@real@)0.25 * share;");
        line("                of = of < (@real@)0.01 ? of : (@real@)0.01;");
        line(
            "                s->slip += of * (ahead * (surprise * scale) / ((@real@)6.283185307179586 * "
            "weights)) / step;");
        line("                s->slip = s->slip < -c[8] ? -c[8] : s->slip > c[8] ? c[8] : s->slip;");
        line("            }}\n        }}");
    }

    const OscillatorDesign& d_;
    std::size_t m_;
    bool slips_;
    std::string text_;
};

std::vector<double> values_of(const OscillatorDesign& d) {
    std::vector<double> values(Value::count);
    values[Value::step_s] = d.step_s;
    values[Value::noise_nm] = d.noise_nm;
    values[Value::torque_noise] = d.torque_noise;
    values[Value::cross_noise] = d.cross_noise;
    values[Value::rate_noise] = d.rate_noise;
    values[Value::first_rate_variance] = d.first_rate_variance;
    values[Value::turns_to_memory] = 1.0 / d.memory_turns;
    values[Value::jump] = d.jump;
    values[Value::largest_slip] = d.largest_slip;
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
    return style.filled(text + here + StepCode(d).written() + "}\n");
}

template <class Real>
LoadedCode loaded_code(TextReader& reader, const OscillatorDesign& d, const CodeStyle& style,
                       bool minus_ripple) {
    const auto orders = style.read(reader, "orders", d.orders.size());
    const auto priors = style.read(reader, "priors", 3 * d.orders.size());
    const auto values = style.read(reader, "values", Value::count);
    std::optional<MapRun<Real>> map;
    if (d.map) map.emplace(d.map->form, d.orders.size(), MapTables(reader, *d.map, style));
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
        "/* seconds a sample, noise in Nm; what a sample adds to the variance of torque, to that of torque "
        "and rate, "
        "of rate;\n   variance of the rate at the start, 1 / memory in motor turns, jump, largest slip, 1 / "
        "turns of return */\n";
    text += style.array("values", values_of(d)) + style.filled(turn_code(style.is_float));
    if (d.map) text += "\n/* the map that is taken off before */\n" + MapCode(*d.map, style).definitions();
    return text + style.filled(state_code) + step_of(d, style);
}

LoadedCode oscillator_loaded(TextReader& reader, const OscillatorDesign& d, const CodeStyle& style) {
    reader.expect("_MINUS_RIPPLE");
    const bool minus_ripple = reader.number() > 0.0;
    return style.is_float ? loaded_code<float>(reader, d, style, minus_ripple)
                          : loaded_code<double>(reader, d, style, minus_ripple);
}

}  // namespace ripplenotch
