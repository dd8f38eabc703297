// SPDX-License-Identifier: MIT
// mjbots moteus: a table of 1024 signed bytes over one turn of the commutation encoder, in q current.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/map/map_table.hpp"
#include "export/map/map_target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t entries = 1024;
constexpr double largest_byte = 127.0;
constexpr std::array keys = {flat_speed_key, flat_direction_key,
                             Key{.name = "kt",
                                 .required = true,
                                 .above = 0.0,
                                 .help = "torque constant of the motor, Nm/A: the table is of q current"}};

// The current that cancels the ripple, of the motor.
double amperes_per_nm(const RippleMap& map, const Settings& settings) {
    return -1.0 / (map.gear_ratio.value() * settings.number("kt"));
}

Written write(const RippleMap& map, const Settings& settings, std::span<const std::string> heading) {
    std::vector<std::string> warnings = flattened(map, "moteus");
    std::vector<double> table = turn_table(flat_map(map, settings), entries);
    double largest = 0.0;
    for (double& value : table) {
        value *= amperes_per_nm(map, settings);
        largest = std::max(largest, std::abs(value));
    }
    const double scale = largest > 0.0 ? as_float(largest / largest_byte) : 0.0;
    std::string text = comment_lines(heading, "# ");
    text += fmt::format("# the commutation encoder's turn begins where the joint is at {} deg\n",
                        shortest(map.zero_deg));
    text += fmt::format("conf set motor.cogging_dq_scale {}\n", shortest(scale));
    for (std::size_t k = 0; k < entries; ++k)
        text += fmt::format(
            "conf set motor.cogging_dq_comp.{} {}\n", k,
            scale > 0.0 ? std::lround(std::clamp(table[k] / scale, -largest_byte, largest_byte)) : 0);
    text += "conf write\n";
    warnings.push_back(
        fmt::format("a byte is {:.2g} Nm at the joint", std::abs(scale / amperes_per_nm(map, settings))));
    return {text, warnings};
}

LoadedMap read(std::string_view bytes, const std::string& source, const RippleMap& map,
               const Settings& settings) {
    TextReader reader(bytes, source, Comments::hash, Precision::float32);
    reader.expect("conf set motor.cogging_dq_scale");
    const double scale = reader.number();
    std::vector<double> table;
    for (std::size_t k = 0; k < entries; ++k) {
        reader.expect(fmt::format("conf set motor.cogging_dq_comp.{} ", k));
        const double byte = reader.number();
        if (byte != std::round(byte) || std::abs(byte) > 128.0)
            raise<DataError>("{}: read {} in entry {}, expected a signed byte", source, byte, k);
        table.push_back(byte * scale / amperes_per_nm(map, settings));
    }
    return {"float32, table of 1024 signed bytes", flat_map(map, settings), table_torque(table, map)};
}

}  // namespace

const MapTarget map_target_list::moteus = {
    .name = "moteus",
    .summary = "conf set lines of the cogging table of mjbots moteus: 1024 signed bytes of q current",
    .source = "mjbots moteus, firmware: motor.cogging_dq_scale, motor.cogging_dq_comp",
    .endings = ".txt .cfg .conf",
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
