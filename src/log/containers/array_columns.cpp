// SPDX-License-Identifier: MIT
// A log made of arrays: which of them belong together.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "log/columns/column_name.hpp"
#include "log/columns/units.hpp"
#include "log/containers/stored_array.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

// Which arrays of a container were recorded at the same moments. Simulink's structs have a time beside each
// signal (tau.Time, tau.Data), HDF5 files a group for each device, dSPACE an axis for all.

/// One column of an array under its own path.
struct ArrayColumn {
    std::string path;     ///< "log.q_dot(:,3)"
    std::string read_as;  ///< what it means beside the others: "q_dot[3]"
    const StoredArray* array;
    std::size_t number;
};

/// Arrays of one clock, or of one length where nothing says whose clock they have.
struct ArrayGroup {
    std::size_t rows = 0;
    std::vector<const StoredArray*> arrays;  ///< in the order of the file; of equal clocks only the first
    const StoredArray* clock = nullptr;      ///< one of them
    std::vector<ArrayColumn> columns;        ///< of all of them
};

constexpr std::size_t compared_at_once = std::size_t{1} << 15;  // rows

// The last part of a path: "Data" of "log.tau.Data".
std::string last_word(const std::string& path) {
    const std::size_t end = path.find_last_of("./");
    return end == std::string::npos ? path : path.substr(end + 1);
}

// What is in front of it: "log.tau".
std::string path_around(const std::string& path) {
    const std::size_t end = path.find_last_of("./");
    return end == std::string::npos ? std::string() : path.substr(0, end);
}

// Without last parts that say nothing: "/tau/value" is "/tau", "tau.signals.values" is "tau".
std::string without_empty_words(const std::string& path) {
    std::string rest = path;
    while (has_word("value Value data Data values Values signals", last_word(rest)) &&
           !path_around(rest).empty())
        rest = path_around(rest);
    return rest;
}

bool names_time(const StoredArray& array) {
    if (!array.shape.vector) return false;
    const ColumnName name =
        read_column_name(array.read_as.empty() ? last_word(without_empty_words(array.path)) : array.read_as);
    return name.role == Role::time && !name.reference;
}

bool same_numbers(const StoredArray& one, const StoredArray& other) {
    if (one.type.kind != other.type.kind || one.type.size != other.type.size ||
        one.type.big_endian != other.type.big_endian)
        return false;
    const NextNumbers left = one.open(0), right = other.open(0);
    for (std::size_t done = 0; done < one.shape.rows; done += compared_at_once) {
        const std::size_t rows = std::min(compared_at_once, one.shape.rows - done);
        ColumnNumbers a, b;
        left(rows, a);
        right(rows, b);
        if (a.values != b.values || a.counts != b.counts) return false;
    }
    return true;
}

std::vector<ColumnInfo> info_of(const std::vector<ArrayColumn>& columns) {
    std::vector<ColumnInfo> info;
    for (const ArrayColumn& column : columns)
        info.push_back({column.path, column.read_as, column.array->unit, column.array->type.whole(), true});
    return info;
}

class ArrayColumns final : public Columns {
  public:
    ArrayColumns(std::shared_ptr<StoredBytes> file, const std::vector<ArrayColumn>& columns)
        : Columns(file->name(), info_of(columns)),
          file_(std::move(file)),
          rows_left_(columns.front().array->shape.rows) {
        for (const ArrayColumn& column : columns) numbers_.push_back(column.array->open(column.number));
    }
    std::size_t next(std::size_t rows, NumberRows& into, std::string& /*bytes*/) override {
        const std::size_t count = std::min(rows, rows_left_);
        rows_left_ -= count;
        for (std::size_t c = 0; c < numbers_.size(); ++c)
            if (wanted(c) && count > 0) numbers_[c](count, into[c]);
        if (count > 0 && rows_left_ == 0) file_->require_unchanged();
        return count;
    }

  private:
    std::shared_ptr<StoredBytes> file_;
    std::size_t rows_left_;
    std::vector<NextNumbers> numbers_;  ///< by column
};

std::string column_path(const StoredArray& array, std::size_t number, PathStyle style) {
    if (array.shape.vector) return array.path;
    if (style == PathStyle::matlab) {
        return array.shape.time_is_first ? fmt::format("{}(:,{})", array.path, number + 1)
                                         : fmt::format("{}({},:)", array.path, number + 1);
    }
    return array.shape.time_is_first ? fmt::format("{}[:,{}]", array.path, number)
                                     : fmt::format("{}[{},:]", array.path, number);
}

// What the names have in front in common, up to a separator: "log.q" and "log.dq" are q and dq.
std::size_t common_prefix(const std::vector<std::string>& names) {
    if (names.empty()) return 0;
    const std::string& first = names.front();
    std::size_t common = first.size();
    for (const std::string& name : names) {
        const auto most = static_cast<std::ptrdiff_t>(std::min(common, name.size()));
        common = static_cast<std::size_t>(
            std::mismatch(first.begin(), first.begin() + most, name.begin()).first - first.begin());
    }
    const std::size_t end = first.substr(0, common).find_last_of("./");
    return end == std::string::npos ? 0 : end + 1;
}

// "tau.Data" is tau where nothing but its own clock stands beside it.
std::vector<std::string> names_of(const ArrayGroup& group) {
    std::map<std::string, int> beside;
    for (const StoredArray* array : group.arrays)
        if (array != group.clock) ++beside[path_around(array->path)];
    std::vector<std::string> names;
    for (const StoredArray* array : group.arrays)
        names.push_back(beside[path_around(array->path)] > 1 ? array->path
                                                             : without_empty_words(array->path));
    std::vector<std::string> common;
    for (std::size_t a = 0; a < names.size(); ++a)
        if (group.arrays[a] != group.clock || names.size() == 1) common.push_back(names[a]);
    const std::size_t prefix = common_prefix(common);
    for (std::size_t a = 0; a < names.size(); ++a) {
        if (!group.arrays[a]->read_as.empty())
            names[a] = group.arrays[a]->read_as;
        else
            names[a] = group.arrays[a] == group.clock ? last_word(names[a]) : names[a].substr(prefix);
    }
    return names;
}

// The columns of all arrays of a group, without what their names have in front in common.
std::vector<ArrayColumn> columns_of(const ArrayGroup& group, PathStyle style) {
    const std::vector<std::string> names = names_of(group);
    std::vector<ArrayColumn> columns;
    for (std::size_t a = 0; a < group.arrays.size(); ++a) {
        const StoredArray& array = *group.arrays[a];
        for (std::size_t c = 0; c < array.shape.columns; ++c) {
            const std::size_t number = style == PathStyle::matlab ? c + 1 : c;
            columns.push_back({column_path(array, c, style),
                               array.shape.vector ? names[a] : fmt::format("{}[{}]", names[a], number),
                               &array, c});
        }
    }
    return columns;
}

// In order of their rows. The clock of an array is the vector named as a time in its own folder or in the
// nearest one around it, if it has as many rows; clocks that hold the same numbers are one. Reads clocks
// where several have the same length.
std::vector<ArrayGroup> groups_of(const std::vector<StoredArray>& arrays, PathStyle style) {
    const auto rows_of = [&](std::size_t a) { return arrays[a].shape.rows; };
    std::map<std::pair<std::string, std::size_t>, std::size_t>
        times;  // the first in a folder, of so many rows
    for (std::size_t a = 0; a < arrays.size(); ++a)
        if (rows_of(a) >= 2 && names_time(arrays[a]))
            times.emplace(std::pair(path_around(without_empty_words(arrays[a].path)), rows_of(a)), a);
    const auto nearest = [&](std::size_t a) -> std::optional<std::size_t> {
        std::string folder = path_around(arrays[a].path);
        while (true) {
            if (const auto found = times.find({folder, rows_of(a)}); found != times.end())
                return found->second;
            if (folder.empty()) return std::nullopt;
            folder = path_around(folder);
        }
    };
    std::vector<std::size_t> distinct;
    std::map<std::size_t, std::size_t> equal_to;
    const auto first_of_equals = [&](std::size_t clock) {
        if (const auto known = equal_to.find(clock); known != equal_to.end()) return known->second;
        const auto first = std::ranges::find_if(distinct, [&](std::size_t other) {
            return rows_of(other) == rows_of(clock) && same_numbers(arrays[other], arrays[clock]);
        });
        if (first != distinct.end()) return equal_to[clock] = *first;
        distinct.push_back(clock);
        return equal_to[clock] = clock;
    };
    std::vector<std::optional<std::size_t>> clocks;
    for (std::size_t a = 0; a < arrays.size(); ++a) {
        clocks.push_back(nearest(a));
        if (clocks[a]) clocks[a] = first_of_equals(*clocks[a]);
    }
    std::map<std::pair<std::size_t, std::size_t>, ArrayGroup> groups;  // by rows and clock
    for (std::size_t a = 0; a < arrays.size(); ++a) {
        if (rows_of(a) < 2) continue;
        // An array that nothing is said of has the only clock of its length.
        const auto fits = [&](std::size_t clock) { return rows_of(clock) == rows_of(a); };
        if (!clocks[a] && std::ranges::count_if(distinct, fits) == 1)
            clocks[a] = *std::ranges::find_if(distinct, fits);
        ArrayGroup& group = groups[{rows_of(a), clocks[a].value_or(arrays.size())}];
        group.rows = rows_of(a);
        if (clocks[a]) group.clock = &arrays[*clocks[a]];
        const bool copy = equal_to.count(a) > 0 && equal_to[a] != a;  // of a clock in another folder
        if (!copy) group.arrays.push_back(&arrays[a]);
    }
    std::vector<ArrayGroup> found;
    for (auto& [key, group] : groups) {
        group.columns = columns_of(group, style);
        found.push_back(std::move(group));
    }
    return found;
}

double ns_per_unit(const std::string& source, const StoredArray& clock) {
    if (const auto stated = stated_clock_ns(clock.unit, last_word(clock.path))) return *stated;
    if (clock.type.kind != 'f')
        raise<DataError>(
            "{}: read whole numbers without a unit in {}, expected seconds, or a name or attribute with the "
            "unit; read arrays of one clock, or save them with it",
            source, clock.path);
    return 1e9;
}

// The columns of `base`, its clock first, and next to them what --columns names of those of `others`. All
// groups have a clock.
void join_arrays(const std::shared_ptr<StoredBytes>& file, const ArrayGroup& base,
                 const std::vector<const ArrayGroup*>& others, const ReadOptions& options, ColumnLog& log) {
    std::vector<ArrayColumn> columns = base.columns;
    const auto clock_column =
        std::ranges::find_if(columns, [&](const ArrayColumn& column) { return column.array == base.clock; });
    std::rotate(columns.begin(), clock_column, clock_column + 1);
    std::vector<SideColumn> sides;
    for (const ArrayGroup* other : others) {
        for (const ArrayColumn& column : other->columns) {
            if (asked_role(options, column.path).empty()) continue;
            if (column.array == other->clock)
                raise<UsageError>(
                    "--columns: {} is not the clock of the torque, whose rows are taken; leave it out: each "
                    "array is joined by its own",
                    column.path);
            const std::vector<ArrayColumn> pair = {{other->clock->path, "", other->clock, 0}, column};
            sides.push_back({std::make_unique<ArrayColumns>(file, pair), 1,
                             ns_per_unit(file->name(), *other->clock), "value"});
        }
    }
    log.columns = std::make_unique<ArrayColumns>(file, columns);
    join_columns(log, ns_per_unit(file->name(), *base.clock), std::move(sides), options);
}

int column_names_tell(const ArrayGroup& group) {
    std::vector<std::string> names;
    for (const ArrayColumn& column : group.columns) names.push_back(column.read_as);
    return names_tell(names);
}

// The first of the group's columns that --columns names by path, the torque's before others; "" where there
// is none.
std::string first_asked(const ArrayGroup& group, const ReadOptions& options) {
    std::string first;
    for (const ArrayColumn& column : group.columns) {
        const std::string role = asked_role(options, column.path);
        if (role == "torque" || (first.empty() && !role.empty())) first = column.path;
    }
    return first;
}

// The groups that --columns names, that of the torque first.
std::vector<const ArrayGroup*> asked_groups(const std::string& source, const std::vector<ArrayGroup>& groups,
                                            const ReadOptions& options) {
    std::vector<const ArrayGroup*> found;
    for (const ArrayGroup& group : groups) {
        const std::string first = first_asked(group, options);
        const bool torque = asked_role(options, first) == "torque";
        if (!first.empty()) found.insert(torque ? found.begin() : found.end(), &group);
    }
    const bool joined = found.size() > 1;
    if (joined && std::ranges::any_of(found, [](const ArrayGroup* g) { return !g->clock; })) {
        raise<UsageError>(
            "--columns: {} of {} has {} rows, {} has {}: their clocks differ; name arrays of one length, or "
            "each with its own time",
            first_asked(*found[0], options), source, found[0]->rows, first_asked(*found[1], options),
            found[1]->rows);
    }
    return found;
}

std::string listed(const std::vector<ContentEntry>& contents) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(contents.size(), 8); ++i)
        text += (i == 0 ? "" : ", ") + in_words(contents[i]);
    return text.empty() ? "nothing numeric" : text + (contents.size() > 8 ? ", ..." : "");
}

// Vectors this short in a file with signals ten times as long are parameters: limits, gains, a calibration.
// It is the number of samples below which `diagnose` refuses a log, too.
constexpr std::size_t fewest_rows_of_signal = 200, times_longer = 10;

// The longest of the groups whose names say most; null where there is none.
const ArrayGroup* choose_group(const std::vector<ArrayGroup>& groups) {
    const ArrayGroup* chosen = nullptr;
    int best = -1;
    const auto is_parameter = [&](const ArrayGroup& group) {
        return group.rows < fewest_rows_of_signal &&
               std::ranges::any_of(groups, [&](const ArrayGroup& other) {
                   return other.rows >= times_longer * group.rows && column_names_tell(other) > 0;
               });
    };
    for (const ArrayGroup& group : groups) {
        if (is_parameter(group)) continue;
        const int tells = column_names_tell(group);
        if (tells < best || (tells == best && group.rows == chosen->rows)) continue;
        best = tells;
        chosen = &group;
    }
    return chosen;
}

std::vector<ContentEntry> contents_of(const std::vector<StoredArray>& arrays,
                                      const std::set<const StoredArray*>& read) {
    std::vector<ContentEntry> contents;
    for (const StoredArray& array : arrays) {
        const ArrayShape& shape = array.shape;
        const std::string words = shape.vector          ? fmt::format("{}", shape.rows)
                                  : shape.time_is_first ? fmt::format("{} x {}", shape.rows, shape.columns)
                                                        : fmt::format("{} x {}", shape.columns, shape.rows);
        contents.push_back(
            {array.path, words, type_name(array.type), array.unit, {}, read.count(&array) > 0});
    }
    return contents;
}

}  // namespace

ColumnLog columns_of_arrays(const std::shared_ptr<StoredBytes>& file, const std::string& format,
                            PathStyle style, const std::vector<StoredArray>& arrays,
                            const std::vector<ContentEntry>& extra, const ReadOptions& options) {
    ColumnLog log;
    log.format = format;
    const std::vector<ArrayGroup> groups = groups_of(arrays, style);
    std::vector<const ArrayGroup*> chosen = asked_groups(file->name(), groups, options);
    if (chosen.empty())
        if (const ArrayGroup* const best = choose_group(groups)) chosen.push_back(best);
    std::set<const StoredArray*> read;
    for (const ArrayGroup* group : chosen)
        for (const ArrayColumn& column : group->columns)
            if (group == chosen.front() || !asked_role(options, column.path).empty())
                read.insert(column.array);
    log.contents = contents_of(arrays, read);
    log.contents.insert(log.contents.end(), extra.begin(), extra.end());
    if (chosen.empty()) {
        raise<DataError>(
            "{}: read {}, expected arrays of numbers, two rows or more, of time, velocity and torque; save "
            "them as vectors of one length",
            file->name(), listed(log.contents));
    }
    if (chosen.size() > 1) {
        const ArrayGroup& base = *chosen.front();
        chosen.erase(chosen.begin());
        join_arrays(file, base, chosen, options, log);
    } else {
        log.columns = std::make_unique<ArrayColumns>(file, chosen.front()->columns);
    }
    return log;
}

}  // namespace ripplenotch
