// SPDX-License-Identifier: MIT
#include "log/numbers/columns.hpp"

#include <algorithm>

#include "log/numbers/column_reader.hpp"
#include "log/rows_in_range.hpp"

namespace ripplenotch {

void append_rows(const NumberRows& from, const std::vector<std::size_t>& rows, NumberRows& into) {
    for (std::size_t c = 0; c < from.size(); ++c) {
        for (const std::size_t row : rows) {
            if (row < from[c].values.size()) into[c].values.push_back(from[c].values[row]);
            if (row < from[c].counts.size()) into[c].counts.push_back(from[c].counts[row]);
        }
    }
}

std::size_t Columns::row_bytes() const {
    const auto wanted = static_cast<std::size_t>(std::ranges::count(wanted_, true));
    return sizeof(double) * std::max<std::size_t>(1, wanted);
}

HeldColumns::HeldColumns(std::string name, std::vector<ColumnInfo> info, NumberRows numbers,
                         std::string bytes)
    : Columns(std::move(name), std::move(info)), numbers_(std::move(numbers)), bytes_(std::move(bytes)) {
    for (const ColumnNumbers& column : numbers_) rows_ = std::max(rows_, column.values.size());
}

std::size_t HeldColumns::next(std::size_t rows, NumberRows& into, std::string& bytes) {
    const std::size_t count = std::min(rows, rows_ - row_);
    const auto append = [this, count](const auto& from, auto& to) {
        if (from.empty()) return;
        const auto first = from.begin() + static_cast<std::ptrdiff_t>(row_);
        to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(count));
    };
    for (std::size_t c = 0; c < numbers_.size(); ++c) {
        append(numbers_[c].values, into[c].values);
        append(numbers_[c].counts, into[c].counts);
    }
    const std::size_t size = bytes_.size() / std::max<std::size_t>(1, rows_);
    bytes.append(bytes_, row_ * size, count * size);
    row_ += count;
    return count;
}

std::unique_ptr<LogReader> read_columns(ColumnLog log, const ReadOptions& options) {
    return rows_in_range(std::make_unique<ColumnReader>(std::move(log), options_of_whole(options)), options);
}

std::unique_ptr<LogReader> read_columns(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                        const ReadOptions& options, MakeColumns make) {
    return read_columns(make(std::move(source), std::move(first_bytes), options), options);
}

}  // namespace ripplenotch
