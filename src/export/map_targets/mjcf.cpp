// SPDX-License-Identifier: MIT
// MuJoCo: passive DC motors whose cogging is the ripple, one an order, on the joint.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "export/map/map_table.hpp"
#include "export/map/map_target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {flat_speed_key, flat_direction_key, flat_temperature_key,
                             Key{.name = "joint",
                                 .kind = KeyKind::text,
                                 .default_text = "joint",
                                 .help = "name of the joint in the model"}};

// cogging="amplitude poles phase" is amplitude sin(poles q + phase), q the joint's angle in radians.
struct Cogging {
    double amplitude = 0.0, poles = 0.0, phase = 0.0;
};

Cogging cogging_of(const RippleMap& flat, std::size_t i) {
    const AmplitudePhase one = amplitude_phase(flat.values[i][0]);
    const double poles = flat.orders[i].value() * flat.gear_ratio.value();
    const double degrees = one.phase_deg + 90.0 - poles * flat.zero_deg;
    return {one.amplitude_nm, poles, (degrees - 360.0 * std::floor(degrees / 360.0)) / degrees_per_radian};
}

Written write(const RippleMap& map, const Settings& settings, std::span<const std::string> heading) {
    const RippleMap flat = flat_map(map, settings);
    std::string text;
    if (!heading.empty()) text += xml_comment(heading);
    // The compiler requires a motor constant and a resistance above 0.
    text += "<mujoco>\n  <actuator>\n";
    for (std::size_t i = 0; i < flat.orders.size(); ++i) {
        const Cogging one = cogging_of(flat, i);
        text += fmt::format(
            "    <dcmotor name=\"ripple_{}\" joint=\"{}\" input=\"none\" motorconst=\"1e-9\" "
            "resistance=\"1\" "
            "cogging=\"{} {} {}\"/>\n",
            shortest(flat.orders[i].value()), settings.text("joint"), shortest(one.amplitude),
            shortest(one.poles), shortest(one.phase));
    }
    return {text + "  </actuator>\n</mujoco>\n", flattened(map, "mjcf")};
}

LoadedMap read(std::string_view bytes, const std::string& source, const RippleMap& map,
               const Settings& settings) {
    TextReader reader(bytes, source, Comments::none, Precision::float64);
    std::vector<Cogging> found;
    while (reader.find("cogging=\"")) {
        Cogging one;
        one.amplitude = reader.number();
        one.poles = reader.number();
        one.phase = reader.number();
        found.push_back(one);
    }
    const auto torque = [found](const MapState& state) {
        const double angle = state.position_deg / degrees_per_radian;
        double sum = 0.0;
        for (const Cogging& one : found) sum += one.amplitude * portable::sin(one.poles * angle + one.phase);
        return sum;
    };
    return {"float64, amplitude sin(poles q + phase)", flat_map(map, settings), torque};
}

}  // namespace

const MapTarget map_target_list::mjcf = {
    .name = "mjcf",
    .summary = "MuJoCo: passive dcmotor elements whose cogging is the ripple",
    .source = "MuJoCo, XML reference: actuator/dcmotor, cogging",
    .endings = ".xml",
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
