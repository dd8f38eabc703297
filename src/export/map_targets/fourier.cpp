// SPDX-License-Identifier: MIT
// The whole map as rows of n, a, b: the most widely readable form.
#include <fmt/format.h>

#include <cmath>

#include "export/map/map_target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view explained =
    "ripple in Nm = sum over the rows of weight (a cos(n theta) + b sin(n theta)), theta = ";
constexpr std::string_view by_motor = "gear_ratio (position - zero)", by_joint = "position - zero";
constexpr std::string_view weights =
    "weight: of a speed, linear between the speeds of its direction and held beyond";
constexpr std::string_view of_second_comb =
    "; of second_comb_deg_s, as of a speed, with n (theta + second_comb (position - zero)) instead of n "
    "theta";

struct Column {
    std::string_view of;
    double at = 0.0;
};

Column column_of(const MapForm& form, std::size_t column) {
    const std::size_t within = column % form.columns_a_direction(), speeds = form.speeds_deg_s.size();
    if (within < speeds) return {"speed_deg_s", form.speeds_deg_s[within]};
    return {"second_comb_deg_s", form.speeds_deg_s[within - speeds]};
}

std::string direction_of(const MapForm& form, std::size_t column) {
    if (form.directions == 1) return "both";
    return column < form.columns_a_direction() ? "forward" : "backward";
}

std::string fact(std::string_view name, double value) {
    return fmt::format("# {} = {}\n", name, shortest(value));
}

std::string rows_of(const RippleMap& map) {
    std::string text = "n,direction,of,at,a_nm,b_nm\n";
    for (std::size_t i = 0; i < map.orders.size(); ++i) {
        for (std::size_t c = 0; c < map.form.columns(); ++c) {
            const Column column = column_of(map.form, c);
            text += fmt::format("{},{},{},{},{},{}\n", shortest(map.orders[i].value()),
                                direction_of(map.form, c), column.of, shortest(column.at),
                                shortest(map.values[i][c].real()), shortest(map.values[i][c].imag()));
        }
    }
    return text;
}

Written write(const RippleMap& map, const Settings&, std::span<const std::string> heading) {
    std::string text = comment_lines(heading, "# ");
    const bool has_ratio = map.gear_ratio != no_ratio;
    text += fmt::format("# {}{}\n# {}{}\n", explained, has_ratio ? by_motor : by_joint, weights,
                        map.form.second_comb != 0 ? of_second_comb : "");
    if (map.form.second_comb != 0) text += fact("second_comb", map.form.second_comb);
    if (has_ratio) text += fact("gear_ratio", map.gear_ratio.value());
    text += fact("zero_deg", map.zero_deg);
    text += fact("slowest_deg_s", map.speeds_deg_s.from) + fact("fastest_deg_s", map.speeds_deg_s.to);
    text += fact("position_from_deg", map.positions_deg.from) + fact("position_to_deg", map.positions_deg.to);
    return {text + rows_of(map), {}};
}

double fact_in(std::string_view bytes, std::string_view name, const std::string& source) {
    const std::string mark = fmt::format("# {} = ", name);
    const std::size_t at = bytes.find(mark);
    const auto value =
        at == std::string_view::npos
            ? std::nullopt
            : parse_number(bytes.substr(at + mark.size(), bytes.find('\n', at) - at - mark.size()));
    if (!value) raise<DataError>("{}: expected a line '{}' with a number", source, mark);
    return *value;
}

// The rows must be those that the map has, in their order; their numbers are taken from the file.
RippleMap read_rows(std::string_view bytes, const std::string& source, RippleMap map) {
    std::size_t at = bytes.find("n,direction,of,at,a_nm,b_nm\n");
    if (at == std::string_view::npos)
        raise<DataError>("{}: expected a line n,direction,of,at,a_nm,b_nm", source);
    at = bytes.find('\n', at) + 1;
    for (std::size_t i = 0; i < map.orders.size(); ++i) {
        for (std::size_t c = 0; c < map.form.columns(); ++c) {
            const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
            const std::string_view line = bytes.substr(at, end - at);
            const Column column = column_of(map.form, c);
            const std::string head = fmt::format("{},{},{},{},", shortest(map.orders[i].value()),
                                                 direction_of(map.form, c), column.of, shortest(column.at));
            const std::size_t comma = line.find(',', head.size());
            if (!line.starts_with(head) || comma == std::string_view::npos)
                raise<DataError>("{}: read '{}', expected a row that begins {}", source, line, head);
            const auto a = parse_number(line.substr(head.size(), comma - head.size()));
            const auto b = parse_number(line.substr(comma + 1));
            if (!a || !b) raise<DataError>("{}: read '{}', expected two numbers at its end", source, line);
            map.values[i][c] = {*a, *b};
            at = std::min(end + 1, bytes.size());
        }
    }
    return map;
}

LoadedMap read(std::string_view bytes, const std::string& source, const RippleMap& map, const Settings&) {
    RippleMap found = read_rows(bytes, source, map);
    if (map.gear_ratio != no_ratio) found.gear_ratio = GearRatio(fact_in(bytes, "gear_ratio", source));
    found.zero_deg = fact_in(bytes, "zero_deg", source);
    found.speeds_deg_s = {fact_in(bytes, "slowest_deg_s", source), fact_in(bytes, "fastest_deg_s", source)};
    found.positions_deg = {fact_in(bytes, "position_from_deg", source),
                           fact_in(bytes, "position_to_deg", source)};
    if (map.form.second_comb != 0)
        found.form.second_comb = fact_in(bytes, "second_comb", source) > 0.0 ? 1 : -1;
    return {"float64", map, [found](const MapState& state) { return map_torque(found, state); }};
}

}  // namespace

const MapTarget map_target_list::fourier = {
    .name = "fourier",
    .summary = "the whole map as CSV rows of order, a and b",
    .source = "Fourier series in the motor's angle",
    .endings = ".csv .txt",
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
