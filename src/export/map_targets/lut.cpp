// SPDX-License-Identifier: MIT
// A table over one motor turn, with linear interpolation: C99 or CSV.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "export/map/map_table.hpp"
#include "export/map/map_target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {
    flat_speed_key, flat_direction_key,
    Key{.name = "entries",
        .default_text = "1024",
        .at_least = 8.0,
        .at_most = 65536.0,
        .whole = true,
        .help = "of the table, over one motor turn"},
    Key{.name = "form",
        .default_text = "csv",
        .choices = "csv c",
        .help = "csv: one number a line; c: an array of C99 floats"},
    Key{.name = "name", .kind = KeyKind::text, .default_text = "ripple_table", .help = "of the array in C"}};

std::size_t entries_of(const Settings& settings) {
    return static_cast<std::size_t>(settings.number("entries"));
}

std::string c_text(const std::vector<double>& table, const std::string& name) {
    check_identifier(name, "target lut, name");
    std::string text = fmt::format("static const float {}[{}] = {{", name, table.size());
    for (std::size_t k = 0; k < table.size(); ++k)
        text += fmt::format("{}{}", k % 8 == 0 ? "\n    " : " ", decimal_float(table[k]) + ",");
    return text + "\n};\n";
}

Written write(const RippleMap& map, const Settings& settings, std::span<const std::string> heading) {
    std::vector<std::string> warnings = flattened(map, "lut");
    const RippleMap flat = flat_map(map, settings);
    const std::vector<double> table = turn_table(flat, entries_of(settings));
    const bool c = settings.text("form") == "c";
    const std::string what = fmt::format(
        "ripple in Nm at the joint, entry k at k / {} of a motor turn, linear between; the motor's angle is "
        "0 where the joint is at {} deg",
        table.size(), shortest(map.zero_deg));
    warnings.push_back(fmt::format("interpolation is wrong by at most {:.2g} Nm",
                                   interpolation_bound_nm(flat, table.size())));
    std::string text = comment_lines(heading, c ? "// " : "# ") + (c ? "// " : "# ") + what + "\n";
    if (c) return {text + c_text(table, settings.text("name")), warnings};
    for (const double value : table) text += shortest(as_float(value)) + "\n";
    return {text, warnings};
}

LoadedMap read(std::string_view bytes, const std::string& source, const RippleMap& map,
               const Settings& settings) {
    const bool c = settings.text("form") == "c";
    TextReader reader(bytes, source, c ? Comments::c : Comments::hash, Precision::float32);
    std::vector<double> table;
    if (c) {
        reader.expect(fmt::format("{}[", settings.text("name")));
        table = reader.numbers('{', '}', entries_of(settings));
    } else {
        for (std::size_t k = 0; k < entries_of(settings); ++k) table.push_back(reader.number());
    }
    return {fmt::format("float32, table of {}", table.size()), flat_map(map, settings),
            table_torque(table, map)};
}

}  // namespace

const MapTarget map_target_list::lut = {
    .name = "lut",
    .summary = "a table over one motor turn, as CSV or C99",
    .source = "linear interpolation in a periodic table",
    .endings = ".csv .txt .h .c",
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
