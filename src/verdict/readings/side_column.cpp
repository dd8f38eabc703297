// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/side_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view remedy = "state it in the method: temperature=31";

std::string value_of(const Spec& spec, std::string_view key) {
    const auto at = std::find_if(spec.values.begin(), spec.values.end(),
                                 [key](const auto& entry) { return entry.first == key; });
    return at == spec.values.end() ? "" : at->second;
}

std::string named_for(std::string column, const std::string& joint) {
    if (const std::size_t at = column.find(joint_mark); at != std::string::npos)
        column.replace(at, joint_mark.size(), joint);
    return column;
}

// The column is read in the place of the torque.
ReadOptions read_as_torque(std::string& column, const std::string& joint, ReadOptions read) {
    column = named_for(column, joint);
    std::erase_if(read.columns, [](const std::string& entry) { return entry.starts_with("torque="); });
    read.columns.push_back("torque=" + column);
    read.units["torque"] = "Nm";  // its numbers as they are
    read.scales.erase("torque");
    if (joint.empty())
        read.joint.reset();
    else
        read.joint = joint;
    return read;
}

std::string joint_of(const RippleMap& map, const ReadOptions& read) {
    return read.joint.value_or(names_joint(map.temperature_column) ? map.joint : "");
}

ReadOptions held(ReadOptions read) {
    read.hold_bad_values = true;
    return read;
}

std::string held_in_words(const std::string& log, const std::string& column, std::size_t cells) {
    return fmt::format("{}: column '{}': {} {} without a temperature; the row before counts", log, column,
                       cells, cells == 1 ? "cell" : "cells");
}

}  // namespace

std::vector<double> side_column(const std::string& path, std::string column, const std::string& joint,
                                ReadOptions read, std::size_t most_rows) {
    return read_log_in_part(path, read_as_torque(column, joint, std::move(read)), most_rows).trace.torque_nm;
}

void require_beside(const std::vector<double>& values, const Trace& motion, const std::string& path,
                    const std::string& column) {
    if (values.size() != motion.size())
        raise<DataError>("{}: column '{}' has {} numbers at {} rows of the motion", path, column,
                         values.size(), motion.size());
}

double mean_of_side_column(const std::string& path, const std::string& column, const std::string& joint,
                           const ReadOptions& read, std::size_t most_rows) {
    const std::vector<double> values = side_column(path, column, joint, read, most_rows);
    return std::accumulate(values.begin(), values.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

std::vector<double> held_side_column(const std::string& path, std::string column, const std::string& joint,
                                     const ReadOptions& read, std::vector<std::string>& notes) {
    Log side = read_log_in_part(path, held(read_as_torque(column, joint, read)));
    if (side.held_bad_values > 0) notes.push_back(held_in_words(path, column, side.held_bad_values));
    return std::move(side.trace.torque_nm);
}

std::string at_rows_temperature(const std::string& method, double degc) {
    return fmt::format("{},temperature={},temperature-of=rows", method,
                       shortest(std::round(1000.0 * degc) / 1000.0));
}

bool follows_temperature(const Contender& method) {
    return method.map != nullptr && method.map->form.by_temperature &&
           method.settings.has("temperature-of") && method.settings.text("temperature-of") == "rows";
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
    const std::string shown = named_for(column, joint_of(map, read));
    const auto reader = open_log(log, read);
    const auto& columns = reader->layout().columns;
    if (std::none_of(columns.begin(), columns.end(), [&](const auto& one) { return one.name == shown; }))
        raise<DataError>("{}: read no column '{}', expected the temperature that {} depends on; {}", log,
                         shown, path, remedy);
    return at_rows_temperature(method, mean_of_side_column(log, column, joint_of(map, read), held(read)));
}

FollowedRows::FollowedRows(const std::string& path, std::string column, const ReadOptions& side)
    : path_(path), column_(std::move(column)), reader_(open_log(path, side)) {}

std::span<const double> FollowedRows::next(std::size_t count) {
    values_.clear();
    while (values_.size() < count) {
        const std::vector<double>& column = block_.joints.front().torque_nm;
        if (used_ == column.size()) {
            used_ = 0;
            if (!reader_->next(block_))
                raise<DataError>(
                    "{}: column '{}' ends before the log does; read a copy that nobody writes to", path_,
                    column_);
            held_ += block_.held_bad_values;
            continue;
        }
        const std::size_t taken = std::min(count - values_.size(), column.size() - used_);
        const auto from = column.begin() + static_cast<std::ptrdiff_t>(used_);
        values_.insert(values_.end(), from, from + static_cast<std::ptrdiff_t>(taken));
        used_ += taken;
    }
    return values_;
}

std::vector<std::string> FollowedRows::notes() const {
    return held_ == 0 ? std::vector<std::string>{} : std::vector{held_in_words(path_, column_, held_)};
}

std::unique_ptr<FollowedRows> followed_rows(const Contender& method, const std::string& log,
                                            const ReadOptions& read) {
    if (!follows_temperature(method)) return nullptr;
    std::string column = method.map->temperature_column;
    const ReadOptions side = held(read_as_torque(column, joint_of(*method.map, read), read));
    return std::make_unique<FollowedRows>(log, column, side);
}

std::vector<double> followed_values(const Contender& method, const std::string& log, const ReadOptions& read,
                                    std::vector<std::string>& notes) {
    if (!follows_temperature(method)) return {};
    return held_side_column(log, method.map->temperature_column, joint_of(*method.map, read), read, notes);
}

}  // namespace ripplenotch
