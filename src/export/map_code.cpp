// SPDX-License-Identifier: MIT
#include "export/map_code.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "export/method_code_parts.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view code = R"c(
/* Ripple of the joint's torque in Nm: subtract it from the sensor. motor_turns: the motor's angle in turns, 0 where the
   joint is at the map's zero; the fraction of the turn is enough. joint_deg: the joint's position; only for its own
   harmonics. torque_nm: the joint's torque; only for the load. */
static inline @real@ @name@_torque(@real@ speed_deg_s, @real@ motor_turns, @real@ joint_deg, @real@ torque_nm) {
    enum { orders = @orders@, speeds = @speeds@, directions = @directions@, harmonics = @harmonics@, loads = @loads@,
           each = speeds + 2 * harmonics + loads };
    @real@ weight[directions * each];
    const @real@ size = speed_deg_s < 0 ? -speed_deg_s : speed_deg_s;
    const @real@ lowest = @name@_speeds[0], highest = @name@_speeds[speeds - 1];
    const @real@ speed = size < lowest ? lowest : size > highest ? highest : size;
    @real@ forward = 1, ripple = 0, joint = joint_deg;
    int d, k, i, above = 0;
    if (directions == 2) {
        forward = (@real@)0.5 + (@real@)0.5 * speed_deg_s / @name@_limits[0];
        forward = forward < 0 ? 0 : forward > 1 ? 1 : forward;
    }
    if (@name@_limits[2] > @name@_limits[1]) {
        const @real@ middle = (@real@)0.5 * (@name@_limits[1] + @name@_limits[2]);
        joint -= 360 * @name@_floor((joint - middle) / 360 + (@real@)0.5);
        joint = joint < @name@_limits[1] ? @name@_limits[1] : joint > @name@_limits[2] ? @name@_limits[2] : joint;
    }
    joint = (joint - @name@_limits[5]) * (@real@)0.017453292519943295;
    while (above + 1 < speeds && @name@_speeds[above] < speed) ++above;
    for (d = 0; d < directions; ++d) {
        const @real@ share = d == 0 ? forward : 1 - forward;
        @real@* const w = weight + d * each;
        for (k = 0; k < each; ++k) w[k] = 0;
        if (above == 0) {
            w[0] = share;
        } else {
            const @real@ from = @name@_speeds[above - 1];
            const @real@ along = (speed - from) / (@name@_speeds[above] - from);
            w[above - 1] = share * (1 - along);
            w[above] = share * along;
        }
        for (k = 0; k < harmonics; ++k) {
            w[speeds + 2 * k] = share * @cos@((@real@)(k + 1) * joint);
            w[speeds + 2 * k + 1] = share * @sin@((@real@)(k + 1) * joint);
        }
        if (loads == 1) {
            const @real@ low = @name@_limits[3], high = @name@_limits[4];
            w[each - 1] = share * (torque_nm < low ? low : torque_nm > high ? high : torque_nm);
        }
    }
    for (i = 0; i < orders; ++i) {
        const @real@* const z = @name@_values + 2 * i * directions * each;
        @real@ cosine = 0, sine = 0, c, s, cycles = @name@_orders[i] * motor_turns;
        for (k = 0; k < directions * each; ++k) {
            cosine += weight[k] * z[2 * k];
            sine += weight[k] * z[2 * k + 1];
        }
        @name@_on_circle(cycles - @name@_floor(cycles), &c, &s);
        ripple += cosine * c + sine * s;
    }
    return ripple;
}

)c";

}  // namespace

std::string map_code(const RippleMap& map, std::string_view name, bool is_float) {
    const MapForm& form = map.form;
    const std::array<std::pair<std::string_view, std::string>, 9> fields = {{
        {"@real@", is_float ? "float" : "double"},
        {"@name@", std::string(name)},
        {"@orders@", std::to_string(map.orders.size())},
        {"@speeds@", std::to_string(form.speeds_deg_s.size())},
        {"@directions@", std::to_string(form.directions)},
        {"@harmonics@", std::to_string(form.turn_harmonics)},
        {"@loads@", form.by_load ? "1" : "0"},
        {"@cos@", is_float ? "cosf" : "cos"},
        {"@sin@", is_float ? "sinf" : "sin"},
    }};
    std::string text = std::string(turn_code(is_float)) + std::string(code);
    for (const auto& [mark, value] : fields)
        for (std::size_t at = text.find(mark); at != std::string::npos;
             at = text.find(mark, at + value.size()))
            text.replace(at, mark.size(), value);
    return text;
}

}  // namespace ripplenotch
