// SPDX-License-Identifier: MIT
// A log made of arrays: which of them belong together, and their columns side by side as records.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "log/containers/stored_array.hpp"
#include "log/records/strided_copy.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t buffered = std::size_t{1} << 18;

/// One column of an array under its own path.
struct ArrayColumn {
    std::string path, read_as;
    const StoredArray* array;
    std::size_t number;
};

std::vector<std::size_t> sizes_of(const std::vector<ArrayColumn>& columns) {
    std::vector<std::size_t> sizes;
    for (const ArrayColumn& column : columns) sizes.push_back(column.array->type.size);
    return sizes;
}

class ArrayRecords final : public RecordSource {
  public:
    ArrayRecords(std::shared_ptr<StoredBytes> file, std::vector<StoredArray> arrays,
                 const std::vector<ArrayColumn>& columns)
        : RecordSource(Name{file->name()}, sizes_of(columns)),
          file_(std::move(file)),
          arrays_(std::move(arrays)) {
        rows_left_ = columns.front().array->shape.rows;
        for (const ArrayColumn& column : columns)
            columns_.push_back({column.array->type.size, column.array->open(column.number)});
    }

  private:
    struct Open {
        std::size_t size;
        std::unique_ptr<ColumnCursor> cursor;
    };
    void refill(std::string& bytes) override {
        const std::size_t rows = std::min(rows_left_, std::max<std::size_t>(64, buffered / record_size()));
        bytes.resize(rows * record_size());
        rows_left_ -= rows;
        std::size_t offset = 0;
        for (const std::size_t c : kept()) {
            const std::size_t size = columns_[c].size;
            column_.resize(rows * size);
            columns_[c].cursor->read(rows, column_.data());
            copy_numbers({column_.data(), size}, {bytes.data() + offset, record_size()}, size, rows);
            offset += size;
        }
        if (rows > 0 && rows_left_ == 0) file_->require_unchanged();
    }

    std::shared_ptr<StoredBytes> file_;
    std::vector<StoredArray> arrays_;  ///< what the cursors are made of
    std::vector<Open> columns_;
    std::size_t rows_left_ = 0;
    std::string column_;
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

// Without what all have in front, up to a separator: "log.q" and "log.dq" are q and dq.
std::size_t common_prefix(const std::vector<const StoredArray*>& arrays) {
    const std::string& first = arrays.front()->path;
    std::size_t common = first.size();
    for (const StoredArray* array : arrays) {
        const std::size_t most = std::min(common, array->path.size());
        common = static_cast<std::size_t>(std::mismatch(first.begin(),
                                                        first.begin() + static_cast<std::ptrdiff_t>(most),
                                                        array->path.begin())
                                              .first -
                                          first.begin());
    }
    const std::size_t end = first.substr(0, common).find_last_of("./");
    return end == std::string::npos ? 0 : end + 1;
}

// Without a last part that says nothing: Octave's HDF5 has "tau/value", Simulink's structs "tau.Data".
std::string without_empty_word(const std::string& path) {
    constexpr std::array empty_words = {"value", "Value", "data", "Data"};
    const std::size_t end = path.find_last_of("./");
    if (end == std::string::npos || end == 0) return path;
    const std::string last = path.substr(end + 1);
    return std::find(empty_words.begin(), empty_words.end(), last) == empty_words.end() ? path
                                                                                        : path.substr(0, end);
}

std::vector<ArrayColumn> columns_of(const std::vector<const StoredArray*>& arrays, PathStyle style) {
    const std::size_t prefix = common_prefix(arrays);
    std::vector<ArrayColumn> columns;
    for (const StoredArray* array : arrays) {
        const std::string below =
            array->read_as.empty() ? without_empty_word(array->path.substr(prefix)) : array->read_as;
        for (std::size_t c = 0; c < array->shape.columns; ++c) {
            const std::size_t number = style == PathStyle::matlab ? c + 1 : c;
            columns.push_back({column_path(*array, c, style),
                               array->shape.vector ? below : fmt::format("{}[{}]", below, number), array, c});
        }
    }
    return columns;
}

int names_tell(const std::vector<ArrayColumn>& columns) {
    std::vector<std::string> names;
    for (const ArrayColumn& column : columns) names.push_back(column.read_as);
    return ripplenotch::names_tell(names);
}

using Groups = std::map<std::size_t, std::vector<const StoredArray*>>;

// The rows of the arrays that --columns names; none where it names none by path.
std::optional<std::size_t> asked_rows(const std::string& source, const Groups& groups, PathStyle style,
                                      const ReadOptions& options) {
    std::optional<std::size_t> rows;
    std::string first;
    for (const std::string& entry : options.columns) {
        const std::size_t equals = entry.find('=');
        if (equals == std::string::npos) continue;
        const std::string path = entry.substr(equals + 1);
        for (const auto& [length, arrays] : groups) {
            const auto columns = columns_of(arrays, style);
            if (std::none_of(columns.begin(), columns.end(),
                             [&](const ArrayColumn& c) { return c.path == path; }))
                continue;
            if (rows && *rows != length) {
                raise<UsageError>(
                    "--columns: {} of {} has {} rows, {} has {}: their clocks differ; name arrays of one "
                    "length",
                    first, source, *rows, path, length);
            }
            rows = length;
            first = path;
        }
    }
    return rows;
}

std::string listed(const std::vector<ContentEntry>& contents) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(contents.size(), 8); ++i)
        text += fmt::format("{}{} ({})", i == 0 ? "" : ", ", contents[i].path, contents[i].shape);
    return text.empty() ? "nothing numeric" : text + (contents.size() > 8 ? ", ..." : "");
}

// The longest of the groups whose names say most; null where there is none.
const std::vector<const StoredArray*>* choose_group(const Groups& groups, std::optional<std::size_t> asked,
                                                    PathStyle style) {
    const std::vector<const StoredArray*>* chosen = nullptr;
    int best = 0;
    for (const auto& [rows, group] : groups) {
        if (asked && *asked != rows) continue;
        const int tells = asked ? 1 : names_tell(columns_of(group, style));
        if (tells < best) continue;
        best = tells;
        chosen = &group;
    }
    return chosen;
}

std::vector<ContentEntry> contents_of(const std::vector<StoredArray>& arrays,
                                      const std::vector<const StoredArray*>* chosen) {
    std::vector<ContentEntry> contents;
    for (const StoredArray& array : arrays) {
        const ArrayShape& shape = array.shape;
        const bool read =
            chosen != nullptr && std::find(chosen->begin(), chosen->end(), &array) != chosen->end();
        const std::string words = shape.vector          ? fmt::format("{}", shape.rows)
                                  : shape.time_is_first ? fmt::format("{} x {}", shape.rows, shape.columns)
                                                        : fmt::format("{} x {}", shape.columns, shape.rows);
        contents.push_back({array.path, words, type_name(array.type), array.unit, std::nullopt, read});
    }
    return contents;
}

void add_fields(const std::vector<ArrayColumn>& columns, RecordTable& table) {
    bool units = false;
    for (const ArrayColumn& column : columns) {
        NpyField field = column.array->type;
        field.name = column.path;
        field.offset = table.record_size;
        table.record_size += field.size;
        table.fields.push_back(field);
        table.read_as.push_back(column.read_as);
        table.units.push_back(column.array->unit);
        units = units || !column.array->unit.empty();
    }
    if (!units) table.units.clear();
}

}  // namespace

Records records_of_arrays(const std::shared_ptr<StoredBytes>& file, const std::string& format,
                          PathStyle style, std::vector<StoredArray> arrays, std::vector<ContentEntry> extra,
                          const ReadOptions& options) {
    RecordTable table;
    table.format = format;
    Groups groups;
    for (const StoredArray& array : arrays)
        if (array.shape.rows >= 2) groups[array.shape.rows].push_back(&array);
    const auto* const chosen = choose_group(groups, asked_rows(file->name(), groups, style, options), style);
    table.contents = contents_of(arrays, chosen);
    table.contents.insert(table.contents.end(), extra.begin(), extra.end());
    if (chosen == nullptr) {
        raise<DataError>(
            "{}: read {}, expected arrays of numbers, two rows or more, of time, velocity and torque; save "
            "them as vectors of one length",
            file->name(), listed(table.contents));
    }
    const std::vector<ArrayColumn> columns = columns_of(*chosen, style);
    add_fields(columns, table);
    table.rows = chosen->front()->shape.rows;
    auto bytes = std::make_unique<ArrayRecords>(file, std::move(arrays), columns);
    return {std::move(bytes), std::move(table)};
}

}  // namespace ripplenotch
