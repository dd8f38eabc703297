// SPDX-License-Identifier: MIT
// A sample of the oscillator in C, unrolled: a compiler keeps what it can in registers.

#include "export/run/oscillator_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "export/code/map_code.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

namespace {

// Compensated summation (Kahan): a phase that drifts is not lost at standstill.
constexpr std::string_view slip_code =
    R"c(    const @real@ step = @name@_fma(moved, s->slip, moved), size = @abs@(step);
    const @real@ slip_added = @name@_fma(moved, s->slip, -s->lost), slipped = s->slipped + slip_added;
    s->lost = (slipped - s->slipped) - slip_added;
    s->slipped = slipped - (@real@)(int)slipped;
)c";

// A sample that is nearly impossible under the model is a torque that jumped.
constexpr std::string_view jump_code = R"c(    if (surprise * surprise > c->jump * c->jump * variance) {
        variance += surprise * surprise;
    }
)c";

class StepCode {
  public:
    explicit StepCode(const OscillatorDesign& design)
        : d_(design),
          m_(2 + 2 * design.orders.size()),
          slips_(design.largest_slip > 0.0),
          forgets_(design.return_turns > 0.0),
          waits_(design.waits) {}

    std::string written() {
        look();
        line("    if (s->started) {{");
        if (waits_) wait();
        if (forgets_) forget();
        predict();
        update();
        if (slips_) correct();
        line("    }} else {{\n        @name@_begin(s, torque_nm);\n    }}");
        for (std::size_t i = 2; i < m_; ++i) line("    s->h[{}] = {};", i - 2, h(i));
        line("    s->turns = motor_turns;\n    const @real@ ripple = {};", shown(2, "s->x"));
        line("    {} {};", waits_ ? "const @real@ clean =" : "return",
             d_.minus_ripple ? "@name@_fma(-c->noise_nm, ripple, torque_nm)"
                             : "@name@_fma(c->noise_nm, s->x[0] - ripple, s->origin)");
        if (waits_) fade_in();
        return std::move(text_);
    }

  private:
    using Products = std::vector<std::pair<std::string, std::string>>;

    // first + change of each amplitude's measurement weight, d2, times the value of `of` for its index.
    template <class Of>
    [[nodiscard]] std::string sum(const std::string& first, const Of& of) const {
        Products products;
        for (std::size_t k = 2; k < m_; ++k) products.emplace_back(fmt::format("d{}", k), of(k));
        return sum_code(first, products);
    }
    // How the amplitudes in an array show; the first of them stands at `from`.
    [[nodiscard]] std::string shown(std::size_t from, std::string_view array) const {
        Products products;
        for (std::size_t k = 3; k < m_; ++k)
            products.emplace_back(fmt::format("{}[{}]", array, from + k - 2), h(k));
        return sum_code(fmt::format("{}[{}] * c0", array, from), products);
    }
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
        line(slips_ ? "    if (!s->started) {{\n        s->turns = motor_turns;\n        s->slip = "
                      "s->slipped = s->lost = 0;\n    }}"
                    : "    if (!s->started) s->turns = motor_turns;");
        line("    moved = @name@_beside_whole(motor_turns - s->turns);");
        text_ += slips_ ? std::string(slip_code) : "    const @real@ size = @abs@(moved);\n";
        text_ += order_angles_code(d_.orders, slips_ ? "motor_turns + s->slipped" : "motor_turns");
        const double fastest = *std::max_element(d_.orders.begin(), d_.orders.end());
        line("    if (size > (@real@){}) {{", decimal(full_below_rate / fastest));
        for (std::size_t i = 0; i < d_.orders.size(); ++i)
            line("        @name@_fade(@name@_orders[{0}] * size, &c{0}, &s{0}, &squares);", i);
        line("    }}");
        if (d_.map) line("    torque_nm -= {};", shown(0, "z"));
    }
    void forget() {
        line("        s->left *= @name@_fma(-size, c->turns_to_return, 1);");
        line("        if (s->left < (@real@)0.5) @name@_bring_back(s);");
        for (std::size_t i = 2; i < m_; ++i) line("        {} *= s->left;", h(i));
    }
    void load() {
        for (std::size_t i = 0; i < m_; ++i) {
            text_ += "        @real@ ";
            for (std::size_t j = i; j < m_; ++j)
                text_ += fmt::format("{} = s->p[{}]{}", p(i, j), place(i, j), j + 1 < m_ ? ", " : ";\n");
        }
    }
    void predict() {
        line("        const @real@ strays = size * c->amplitude_noise, added = strays * strays;");
        line(forgets_
                 ? "        const @real@ strays_here = strays / s->left, more = strays_here * strays_here;"
                 : "        const @real@ more = added;");
        text_ += "        const @real@ ";
        for (std::size_t i = 2; i < m_; ++i)
            text_ += fmt::format("d{} = {} - s->h[{}]{}", i, h(i), i - 2, i + 1 < m_ ? ", " : ";\n");
        load();
        for (std::size_t i = 0; i < m_; ++i)
            line("        {}@real@ v{} = {};", i == 0 ? "const " : "", i,
                 sum(p(0, i) + " + " + p(1, i), [&](std::size_t k) { return p(k, i); }));
        line("        @real@ variance = @name@_fma(added, squares, {}) + c->seen_noise;",
             sum("v0 + v1", [](std::size_t k) { return fmt::format("v{}", k); }));
        line("        v1 += c->cross_noise;\n        p_1_1 += c->rate_noise;");
        line("        const @real@ expected = {};",
             sum("s->x[0] + s->x[1]", [](std::size_t k) { return fmt::format("s->x[{}]", k); }));
        for (std::size_t i = 2; i < m_; ++i)
            line("        v{0} = @name@_fma(more, {1}, v{0});\n        {2} += more;", i, h(i), p(i, i));
    }
    void update() {
        line("        const @real@ surprise = @name@_fma(torque_nm - s->origin, c->in_noise, -expected);");
        if (d_.jump > 0.0) text_ += jump_code;
        line("        const @real@ scale = 1 / variance;");
        for (std::size_t i = 0; i < m_; ++i) {
            line(
                i == 0 ? "        const @real@ g0 = 1 - scale;" : "        const @real@ g{0} = v{0} * scale;",
                i);
            line("        s->x[{0}] = @name@_fma(g{0}, surprise, {1});", i,
                 i == 0 ? std::string("expected") : fmt::format("s->x[{}]", i));
            // The updated covariance of the first state is the gain itself.
            line("        s->p[{0}] = g{0};", i);
        }
        for (std::size_t i = 1; i < m_; ++i) {
            for (std::size_t j = i; j < m_; ++j) {
                line("        {0} = @name@_fma(-g{1}, v{2}, {0});", p(i, j), i, j);
                line("        s->p[{}] = {};", place(i, j), p(i, j));
            }
        }
    }
    void wait() {
        line("        s->waited = @name@_fma(size, (@real@){}, s->waited);",
             decimal(*std::min_element(d_.orders.begin(), d_.orders.end())));
    }
    // What is learnt counts once the motor has turned far enough to tell it from the torque.
    void fade_in() {
        line("    if (!(s->waited < (@real@){})) return clean;", OscillatorWait::until);
        line("    const @real@ share = (s->waited - (@real@){0}) / ((@real@){1} - (@real@){0});",
             OscillatorWait::from, OscillatorWait::until);
        line("    return share > 0 ? @name@_fma(share, clean - torque_nm, torque_nm) : torque_nm;");
    }
    // Corrects the angle's rate from the ripple's phase.
    void correct() {
        const double lowest = *std::min_element(d_.orders.begin(), d_.orders.end());
        line("        if (size > (@real@){}) {{\n            @real@ ahead = 0, weights = 0;",
             shortest(slowest_corrected_periods / lowest));
        for (std::size_t i = 2; i < m_; i += 2) {
            const double n = d_.orders[i / 2 - 1];
            line("            {{\n                const @real@ a = s->x[{}], b = s->x[{}];", i, i + 1);
            line("                const @real@ square = @name@_fma(b, b, a * a);");
            line("                if (square > 9 * ({} + {})) {{", p(i, i), p(i + 1, i + 1));
            line("                    ahead -= (@real@){} * @name@_fma(a, v{}, -b * v{});", decimal(n), i + 1,
                 i);
            line("                    weights = @name@_fma((@real@){}, square, weights);", decimal(n * n));
            line("                }}\n            }}");
        }
        line("            if (weights > 0) {{\n                @real@ of = size * c->quarter_memory;");
        line("                of = of < (@real@)0.01 ? of : (@real@)0.01;");
        line(
            "                s->slip += of * (ahead * (surprise * scale)) / ((@real@)6.283185307179586 * "
            "weights * step);");
        line(
            "                s->slip = s->slip < -c->largest_slip ? -c->largest_slip : s->slip > "
            "c->largest_slip ? c->largest_slip : s->slip;");
        line("            }}\n        }}");
    }

    const OscillatorDesign& d_;
    std::size_t m_;
    bool slips_, forgets_, waits_;
    std::string text_;
};

}  // namespace

std::string oscillator_step_code(const OscillatorDesign& design) { return StepCode(design).written(); }

}  // namespace ripplenotch
