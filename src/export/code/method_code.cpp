// SPDX-License-Identifier: MIT
#include "export/code/method_code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "export/code/map_code.hpp"
#include "export/run/maths.hpp"
#include "export/run/ripple_run.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

CodeStyle style_of(const Settings& settings) {
    CodeStyle style{settings.text("name"), settings.text("precision") == "float"};
    check_identifier(style.name, "target c-header, name");
    return style;
}

std::string CodeStyle::array(std::string_view what, const std::vector<double>& values) const {
    return fmt::format("static const rn_real rn_{}[{}] = {{{}}};\n", what, values.size(),
                       joined(values, ", ", literal()));
}

std::string CodeStyle::constants(std::span<const double> values) const {
    return fmt::format("static const rn_constants rn_values = {{{}}};\n", joined(values, ", ", literal()));
}

std::string CodeStyle::filled(std::string_view code) const {
    return ripplenotch::filled(std::string(code), {{"// SPDX-License-Identifier: MIT\n", "\n"},
                                                   {"#ifndef RN_PREVIEW\n", ""},
                                                   {"#endif /* RN_PREVIEW */\n", ""},
                                                   {"RN_INLINE", "static inline"},
                                                   {"RN_", upper_case(name) + "_"},
                                                   {"rn_", name + "_"}});
}

std::string CodeStyle::header(std::span<const std::string> heading, std::string_view body) const {
    return comment_lines(heading, "// ") +
           filled(fmt::format("#ifndef RN_H\n#define RN_H\n#include <math.h>\n{}{}\n#endif  // RN_H\n",
                              is_float ? runtime_text::real_float : runtime_text::real_double, body));
}

std::string with_tables(std::string_view runtime, const std::string& tables) {
    return filled(std::string(runtime), {{"/* TABLES */", tables}});
}

std::vector<double> CodeStyle::read(TextReader& reader, std::string_view what, std::size_t count) const {
    reader.expect(fmt::format("{}_{}[", name, what));
    return reader.numbers('{', '}', count);
}

std::vector<double> CodeStyle::read_constants(TextReader& reader, std::size_t count) const {
    reader.expect(fmt::format("{}_values = ", name));
    return reader.numbers('{', '}', count);
}

bool is_code_target(std::string_view target) { return target == "c-header"; }

std::span<const Key> method_code_keys() {
    static constexpr std::array keys = {name_key("ripplenotch"), precision_key("of numbers and arithmetic"),
                                        speed_unit_key, speed_side_key};
    return keys;
}

namespace {

// Orders that near half the sample rate, in cycles a sample.
std::string fading_rates() {
    return fmt::format(
        "/* from RN_FULL_BELOW to RN_NONE_ABOVE cycles a sample an order is let go */\n"
        "#define RN_FULL_BELOW {}\n#define RN_NONE_ABOVE {}\n",
        decimal(full_below_rate), decimal(none_above_rate));
}

std::string tracking_header(const TrackingDesign& d, const CodeStyle& style) {
    return fmt::format(
               "\nenum {{ RN_ORDERS = {}, RN_NOTCHES = {}, RN_PARKS = {}, RN_SAMPLE_RATE_HZ = {} }};\n",
               d.orders.size(), d.spread.size(), d.parks ? 1 : 0, std::lround(d.sample_rate_hz)) +
           fading_rates() + std::string(runtime_text::tangent) +
           with_tables(runtime_text::tracking,
                       "\n" + style.array("orders", d.orders) + style.array("weights", d.weights) +
                           style.array("spread", d.spread) + style.constants(tracking_values(d)));
}

LoadedCode tracking_loaded(TextReader& reader, const TrackingDesign& d, const CodeStyle& style) {
    reader.expect("_PARKS");
    TrackingDesign found;
    found.parks = reader.number() > 0.0;
    found.orders = style.read(reader, "orders", d.orders.size());
    found.weights = style.read(reader, "weights", d.orders.size());
    found.spread = style.read(reader, "spread", d.spread.size());
    const auto values = style.read_constants(reader, tracking_members.size());
    for (std::size_t i = 0; i < values.size(); ++i) found.*tracking_members[i] = values[i];
    return in_precision(style.precision(), [&](auto math) -> LoadedCode {
        using Real = typename decltype(math)::rn_real;
        return {"", [run = std::make_shared<TrackingRun<decltype(math)>>(found)](const CodeInput& in) {
                    return static_cast<double>(
                        run->next(static_cast<Real>(in.torque_nm), static_cast<Real>(in.speed_deg_s)));
                }};
    });
}

// Periods of the lowest order in a sample above which the angle's rate is corrected.
constexpr double slowest_corrected_periods = 1e-5;

// In the order of the runtime's constants.
std::array<double, 13> oscillator_values(const OscillatorDesign& d) {
    const double step_s = d.step_s, lowest = *std::min_element(d.orders.begin(), d.orders.end());
    return {d.noise_nm,
            1.0 + d.torque_noise,
            step_s * d.cross_noise,
            step_s * step_s * d.rate_noise,
            step_s * step_s * d.first_rate_variance,
            std::sqrt(2.0) / d.memory_turns,
            0.25 / d.memory_turns,
            d.jump,
            d.largest_slip,
            d.return_turns > 0.0 ? 1.0 / d.return_turns : 0.0,
            1.0 / d.noise_nm,
            lowest,
            slowest_corrected_periods / lowest};
}

std::string oscillator_header(const OscillatorDesign& d, const CodeStyle& style) {
    const std::size_t states = 2 + 2 * d.orders.size();
    std::vector<double> priors;
    for (const auto& prior : d.priors)
        priors.insert(priors.end(), {prior.cosine, prior.sine, prior.deviation});
    const std::string tables =
        "\n" + angles_code(d.orders, style) +
        "/* of each order, in units of the noise: cosine, sine, how far off they may be */\n" +
        style.array("priors", priors) + style.constants(oscillator_values(d)) +
        std::string(runtime_text::angles) + (d.map ? map_code(*d.map, style) : "");
    return fmt::format(
               "\nenum {{ RN_ORDERS = {}, RN_STATES = {}, RN_MINUS_RIPPLE = {}, RN_WAITS = {}, "
               "RN_SAMPLE_RATE_HZ = {} }};\n",
               d.orders.size(), states, d.minus_ripple ? 1 : 0, d.waits ? 1 : 0,
               std::lround(1.0 / d.step_s)) +
           fading_rates() +
           fmt::format(
               "/* periods of the lowest order over which what is learnt begins to count */\n"
               "#define RN_WAIT_FROM {}\n#define RN_WAIT_UNTIL {}\n\n",
               decimal(OscillatorWait::from), decimal(OscillatorWait::until)) +
           by_shaft(
               with_tables(runtime_text::oscillator, tables) +
                   std::string(d.map ? runtime_text::oscillator_map_step : runtime_text::oscillator_step),
               d.orders, GearRatio(d.gear_ratio));
}

LoadedCode oscillator_loaded(TextReader& reader, const OscillatorDesign& d, const CodeStyle& style) {
    OscillatorTables found;
    reader.expect("_MINUS_RIPPLE");
    found.minus_ripple = reader.number() > 0.0;
    reader.expect("_WAITS");
    found.waits = reader.number() > 0.0;
    found.orders = style.read(reader, "orders", d.orders.size());
    found.priors = style.read(reader, "priors", 3 * d.orders.size());
    found.values = style.read_constants(reader, oscillator_values(d).size());
    const MapTables tables = d.map ? MapTables(reader, *d.map, style) : MapTables();
    return in_precision(style.precision(), [&](auto math) -> LoadedCode {
        const auto run =
            std::make_shared<RippleRun<decltype(math)>>(found, d.map ? &*d.map : nullptr, tables);
        return {"", [run](const CodeInput& in) { return run->step(in); }};
    });
}

// A gear ratio in motor turns per 360 of the code's own unit makes the rest of the code the same for all.
TrackingDesign in_unit(TrackingDesign design, const Settings& settings) {
    design.gear_ratio /= code_speed(settings, design.gear_ratio).per_deg_s;
    return design;
}

void refuse_units(const Settings& settings) {
    if (code_speed(settings, 2.0).per_deg_s != 1.0)
        raise<UsageError>(
            "target c-header: the oscillator takes the motor's angle, not a speed; speed-unit and speed-side "
            "are of tracking and of tables");
}

}  // namespace

Written write_method_code(const RunningDesign& design, const Settings& settings,
                          std::span<const std::string> heading) {
    const CodeStyle style = style_of(settings);
    const auto* const tracking = std::get_if<TrackingDesign>(&design);
    if (tracking == nullptr) {
        refuse_units(settings);
        return {style.header(heading, oscillator_header(std::get<OscillatorDesign>(design), style)), {}};
    }
    const std::string body = tracking_header(in_unit(*tracking, settings), style);
    return {style.header(heading,
                         filled(body, {{"speed_deg_s", code_speed(settings, tracking->gear_ratio).name}})),
            {}};
}

LoadedCode read_method_code(std::string_view bytes, const std::string& source, const RunningDesign& design,
                            const Settings& settings) {
    const CodeStyle style = style_of(settings);
    TextReader reader(bytes, source, Comments::c, style.precision());
    LoadedCode loaded;
    if (const auto* const tracking = std::get_if<TrackingDesign>(&design)) {
        const double per_deg_s = code_speed(settings, tracking->gear_ratio).per_deg_s;
        loaded = tracking_loaded(reader, *tracking, style);
        loaded.step = [step = loaded.step, per_deg_s](CodeInput in) {
            in.speed_deg_s *= per_deg_s;
            return step(in);
        };
    } else {
        loaded = oscillator_loaded(reader, std::get<OscillatorDesign>(design), style);
    }
    loaded.arithmetic = style.is_float ? "float32" : "float64";
    return loaded;
}

}  // namespace ripplenotch
