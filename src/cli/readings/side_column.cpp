// SPDX-License-Identifier: MIT
#include "cli/readings/side_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cli/gear/joint_methods.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/document/map_json.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view remedy = "state it in the method: temperature=31";

std::string value_of(const Spec& spec, std::string_view key) {
    const auto at = std::find_if(spec.values.begin(), spec.values.end(),
                                 [key](const auto& entry) { return entry.first == key; });
    return at == spec.values.end() ? "" : at->second;
}

}  // namespace

// It is read in the place of the torque.
std::vector<double> side_column(const std::string& path, std::string column, const std::string& joint,
                                ReadOptions read, std::size_t most_rows) {
    if (const std::size_t at = column.find(joint_mark); at != std::string::npos)
        column.replace(at, joint_mark.size(), joint);
    std::erase_if(read.columns, [](const std::string& entry) { return entry.starts_with("torque="); });
    read.columns.push_back("torque=" + column);
    read.units["torque"] = "Nm";  // its numbers as they are
    if (joint.empty())
        read.joint.reset();
    else
        read.joint = joint;
    return read_log_in_part(path, read, most_rows).trace.torque_nm;
}

double mean_of_side_column(const std::string& path, const std::string& column, const std::string& joint,
                           const ReadOptions& read, std::size_t most_rows) {
    const std::vector<double> values = side_column(path, column, joint, read, most_rows);
    return std::accumulate(values.begin(), values.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

std::string at_log_temperature(const std::string& method, const std::string& log, const ReadOptions& read) {
    if (names_joint(method)) return method;
    const Spec spec = parse_spec(method);
    const std::string path = value_of(spec, "map");
    if (path.empty() || !value_of(spec, "temperature").empty() || !is_map(path)) return method;
    const RippleMap map = load_map(path).map;
    if (!map.form.by_temperature) return method;
    const std::string& column = map.temperature_column;
    if (log == "-")
        raise<UsageError>(
            "method {}: {} depends on the joint's temperature ('{}'), and standard input cannot be "
            "read twice; {}",
            spec.name, path, column, remedy);
    try {
        const std::string joint = read.joint.value_or(names_joint(column) ? map.joint : "");
        const double degc = mean_of_side_column(log, column, joint, read);
        return fmt::format("{},temperature={}", method, shortest(std::round(1000.0 * degc) / 1000.0));
    } catch (const UsageError&) {
        raise<DataError>("{}: read no column '{}', expected the temperature that {} depends on; {}", log,
                         column, path, remedy);
    }
}

}  // namespace ripplenotch
