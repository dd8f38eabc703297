// SPDX-License-Identifier: MIT
// A log made of arrays: which of them belong together.

#include <fmt/format.h>

#include <algorithm>

#include "log/containers/joined_arrays.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

int column_names_tell(const std::vector<ArrayColumn>& columns) {
    std::vector<std::string> names;
    for (const ArrayColumn& column : columns) names.push_back(column.read_as);
    return names_tell(names);
}

// What --columns names by path.
class AskedPaths {
  public:
    explicit AskedPaths(const ReadOptions& options) {
        for (const std::string& entry : options.columns) {
            const std::size_t equals = entry.find('=');
            if (equals != std::string::npos)
                paths_.push_back({entry.substr(0, equals), entry.substr(equals + 1)});
        }
    }
    [[nodiscard]] bool has(const std::string& path) const { return !role_of(path).empty(); }
    // The first of the group's columns that is asked for, the torque's before others; "" where there is none.
    [[nodiscard]] std::string first_of(const ArrayGroup& group, PathStyle style) const {
        std::string first;
        for (const ArrayColumn& column : columns_of(group, style)) {
            const std::string role = role_of(column.path);
            if (role == "torque" || (first.empty() && !role.empty())) first = column.path;
        }
        return first;
    }
    [[nodiscard]] bool torque_in(const ArrayGroup& group, PathStyle style) const {
        return role_of(first_of(group, style)) == "torque";
    }

  private:
    struct Entry {
        std::string role, path;
    };
    [[nodiscard]] std::string role_of(const std::string& path) const {
        for (const Entry& entry : paths_)
            if (entry.path == path) return entry.role;
        return {};
    }
    std::vector<Entry> paths_;
};

// The groups that --columns names, that of the torque first.
std::vector<const ArrayGroup*> asked_groups(const std::string& source, const std::vector<ArrayGroup>& groups,
                                            PathStyle style, const AskedPaths& asked) {
    std::vector<const ArrayGroup*> found;
    for (const ArrayGroup& group : groups) {
        if (asked.first_of(group, style).empty()) continue;
        found.insert(asked.torque_in(group, style) ? found.begin() : found.end(), &group);
    }
    const bool joined = found.size() > 1;
    if (joined && std::any_of(found.begin(), found.end(), [](const ArrayGroup* g) { return !g->clock; })) {
        raise<UsageError>(
            "--columns: {} of {} has {} rows, {} has {}: their clocks differ; name arrays of one length, or "
            "with a time of their own beside each",
            asked.first_of(*found[0], style), source, found[0]->rows, asked.first_of(*found[1], style),
            found[1]->rows);
    }
    return found;
}

std::string listed(const std::vector<ContentEntry>& contents) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(contents.size(), 8); ++i) {
        const ContentEntry& entry = contents[i];
        text += fmt::format("{}{} ({}{}{})", i == 0 ? "" : ", ", entry.path, entry.shape,
                            entry.shape.empty() ? "" : ", ", entry.type);
    }
    return text.empty() ? "nothing numeric" : text + (contents.size() > 8 ? ", ..." : "");
}

// The longest of the groups whose names say most; null where there is none.
const ArrayGroup* choose_group(const std::vector<ArrayGroup>& groups, PathStyle style) {
    const ArrayGroup* chosen = nullptr;
    int best = -1;
    for (const ArrayGroup& group : groups) {
        const int tells = column_names_tell(columns_of(group, style));
        if (tells < best || (tells == best && group.rows == chosen->rows)) continue;
        best = tells;
        chosen = &group;
    }
    return chosen;
}

std::vector<ContentEntry> contents_of(const std::vector<StoredArray>& arrays,
                                      const std::function<bool(const StoredArray&)>& is_read) {
    std::vector<ContentEntry> contents;
    for (const StoredArray& array : arrays) {
        const ArrayShape& shape = array.shape;
        const std::string words = shape.vector          ? fmt::format("{}", shape.rows)
                                  : shape.time_is_first ? fmt::format("{} x {}", shape.rows, shape.columns)
                                                        : fmt::format("{} x {}", shape.columns, shape.rows);
        contents.push_back(
            {array.path, words, type_name(array.type), array.unit, std::nullopt, is_read(array)});
    }
    return contents;
}

}  // namespace

Records records_of_arrays(const std::shared_ptr<StoredBytes>& file, const std::string& format,
                          PathStyle style, const std::vector<StoredArray>& arrays,
                          const std::vector<ContentEntry>& extra, const ReadOptions& options) {
    RecordTable table;
    table.format = format;
    const std::vector<ArrayGroup> groups = groups_by_clock(arrays);
    const AskedPaths asked(options);
    std::vector<const ArrayGroup*> chosen = asked_groups(file->name(), groups, style, asked);
    if (chosen.empty())
        if (const ArrayGroup* const best = choose_group(groups, style)) chosen.push_back(best);
    const auto reads = [&](const StoredArray& array) {
        if (chosen.empty()) return false;
        const auto& whole = chosen.front()->arrays;
        if (std::find(whole.begin(), whole.end(), &array) != whole.end()) return true;
        return std::any_of(chosen.begin() + 1, chosen.end(), [&](const ArrayGroup* group) {
            const auto columns = columns_of(*group, style);
            return std::any_of(columns.begin(), columns.end(), [&](const ArrayColumn& column) {
                return column.array == &array && asked.has(column.path);
            });
        });
    };
    table.contents = contents_of(arrays, reads);
    table.contents.insert(table.contents.end(), extra.begin(), extra.end());
    if (chosen.empty()) {
        raise<DataError>(
            "{}: read {}, expected arrays of numbers, two rows or more, of time, velocity and torque; save "
            "them as vectors of one length",
            file->name(), listed(table.contents));
    }
    if (chosen.size() > 1) {
        const std::vector<const ArrayGroup*> others(chosen.begin() + 1, chosen.end());
        auto joined = joined_arrays(
            file, *chosen.front(), others, style, [&](const std::string& path) { return asked.has(path); },
            options.join.value_or("linear"), table);
        return {std::move(joined), std::move(table)};
    }
    const std::vector<ArrayColumn> columns = columns_of(*chosen.front(), style);
    add_fields(columns, table);
    table.rows = chosen.front()->rows;
    return {array_records(file, columns), std::move(table)};
}

}  // namespace ripplenotch
