// SPDX-License-Identifier: MIT
// The whole map as C99: constants and one function, without allocation, in bounded time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/map_code.hpp"
#include "export/map_targets.hpp"
#include "export/method_code_parts.hpp"
#include "export/text.hpp"
#include "export/text_reader.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> precisions = {"float", "double"};
constexpr std::array keys = {
    Key{.name = "name", .kind = KeyKind::text, .default_text = "ripple_map", .help = "prefix of all names"},
    Key{.name = "precision",
        .kind = KeyKind::choice,
        .default_text = "float",
        .choices = precisions,
        .help = "of numbers and arithmetic"}};

bool single(const Settings& settings) { return settings.text("precision") == "float"; }

std::string literal(double value, bool is_float) { return is_float ? decimal_float(value) : decimal(value); }

std::string list_of(const std::vector<double>& values, bool is_float) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : ", ") + literal(value, is_float);
    return text;
}

std::vector<double> limits_of(const RippleMap& map) {
    return {std::max(map.speeds_deg_s.from, 0.1),
            map.positions_deg.from,
            map.positions_deg.to,
            map.loads_nm.from,
            map.loads_nm.to,
            map.zero_deg};
}

std::vector<double> values_of(const RippleMap& map) {
    std::vector<double> values;
    for (const auto& order : map.values) {
        for (const std::complex<double>& z : order) {
            values.push_back(z.real());
            values.push_back(z.imag());
        }
    }
    return values;
}

std::vector<double> orders_of(const RippleMap& map) {
    std::vector<double> orders;
    for (const Order order : map.orders) orders.push_back(order.value());
    return orders;
}

Written write(const RippleMap& map, const Settings& settings, std::span<const std::string> heading) {
    const std::string name = settings.text("name");
    check_identifier(name, "target c-header, name");
    const bool is_float = single(settings);
    const auto array = [&](std::string_view what, const std::vector<double>& values) {
        return fmt::format("static const {} {}_{}[{}] = {{{}}};\n", is_float ? "float" : "double", name, what,
                           values.size(), list_of(values, is_float));
    };
    std::string text = comment_lines(heading, "// ");
    text += fmt::format("#ifndef {0}_H\n#define {0}_H\n#include <math.h>\n\n", upper_case(name));
    text += array("orders", orders_of(map)) + array("speeds", map.form.speeds_deg_s) +
            array("limits", limits_of(map)) + array("values", values_of(map));
    return {text + map_code(map, name, is_float) + fmt::format("#endif  // {}_H\n", upper_case(name)), {}};
}

// The function of map_code, operation by operation.
template <class Real>
double run(const RippleMap& held, const MapState& state) {
    const double turns = held.gear_ratio.value() * (state.position_deg - held.zero_deg) / 360.0;
    const auto motor_turns = static_cast<Real>(turns - std::floor(turns));
    std::vector<double> weights(held.form.columns());
    map_weights(held,
                {static_cast<double>(static_cast<Real>(state.speed_deg_s)),
                 static_cast<double>(static_cast<Real>(state.position_deg)),
                 static_cast<double>(static_cast<Real>(state.load_nm))},
                weights);
    Real ripple = 0;
    for (std::size_t i = 0; i < held.orders.size(); ++i) {
        Real cosine = 0, sine = 0;
        for (std::size_t c = 0; c < weights.size(); ++c) {
            cosine += static_cast<Real>(weights[c]) * static_cast<Real>(held.values[i][c].real());
            sine += static_cast<Real>(weights[c]) * static_cast<Real>(held.values[i][c].imag());
        }
        Real cycles = static_cast<Real>(held.orders[i].value()) * motor_turns;
        cycles -= std::floor(cycles);
        const OnCircle<Real> at = on_circle(cycles);
        ripple += cosine * at.cosine + sine * at.sine;
    }
    return static_cast<double>(ripple);
}

LoadedMap read(std::string_view bytes, const std::string& source, const RippleMap& map,
               const Settings& settings) {
    const std::string name = settings.text("name");
    const bool is_float = single(settings);
    TextReader reader(bytes, source, Comments::c, is_float ? Precision::float32 : Precision::float64);
    const auto numbers = [&](std::string_view what, std::size_t count) {
        reader.expect(fmt::format("{}_{}[", name, what));
        return reader.numbers('{', '}', count);
    };
    RippleMap found = map;
    const auto orders = numbers("orders", map.orders.size());
    found.form.speeds_deg_s = numbers("speeds", map.form.speeds_deg_s.size());
    const auto limits = numbers("limits", 6);
    const auto values = numbers("values", 2 * map.orders.size() * map.form.columns());
    found.speeds_deg_s.from = limits[0];
    found.positions_deg = {limits[1], limits[2]};
    found.loads_nm = {limits[3], limits[4]};
    std::size_t at = 0;
    for (std::size_t i = 0; i < orders.size(); ++i) {
        found.orders[i] = Order(orders[i]);
        for (auto& value : found.values[i]) {
            value = {values[at], values[at + 1]};
            at += 2;
        }
    }
    if (is_float)
        return {"float32", map, [found](const MapState& state) { return run<float>(found, state); }};
    return {"float64", map, [found](const MapState& state) { return run<double>(found, state); }};
}

}  // namespace

const MapTarget map_target_list::c_header = {
    .name = "c-header",
    .summary = "the whole map as C99: one function, no allocation",
    .source = "ISO/IEC 9899:1999",
    .endings = ".h .hpp",
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
