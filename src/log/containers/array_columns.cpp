// SPDX-License-Identifier: MIT
#include "log/containers/array_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "log/records/strided_copy.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t buffered = std::size_t{1} << 18;

std::vector<std::size_t> sizes_of(const std::vector<ArrayColumn>& columns) {
    std::vector<std::size_t> sizes;
    for (const ArrayColumn& column : columns) sizes.push_back(column.array->type.size);
    return sizes;
}

class ArrayRecords final : public RecordSource {
  public:
    ArrayRecords(std::shared_ptr<StoredBytes> file, const std::vector<ArrayColumn>& columns)
        : RecordSource(Name{file->name()}, sizes_of(columns)), file_(std::move(file)) {
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

// Of the names, up to a separator: "log.q" and "log.dq" are q and dq.
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

}  // namespace

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

std::unique_ptr<RecordSource> array_records(std::shared_ptr<StoredBytes> file,
                                            const std::vector<ArrayColumn>& columns) {
    return std::make_unique<ArrayRecords>(std::move(file), columns);
}

}  // namespace ripplenotch
