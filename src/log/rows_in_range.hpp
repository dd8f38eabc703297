// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: the rows that --from and --to keep. Names, units, dialect and clock are decided
// from the rows inside alone, as in a log that holds no others (docs/decisions/0014-one-account.md). So the
// others are left out of the bytes, before the reader of the rows inside sees them; a reader of the whole log
// is asked only how it writes its times.

#include <cstddef>
#include <memory>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// The number in the file of the `number`th line or record of what `source` gives. Both count from 1.
[[nodiscard]] std::size_t number_in_file(const ByteSource& source, std::size_t number);
/// What a range left out of `source`; null where none was asked for.
[[nodiscard]] std::shared_ptr<const RowsOutside> rows_outside(const ByteSource& source);

class LogReader;
class CsvReader;
class ColumnReader;

/// For the reader of the whole log: where a range is given, whatever it lacks but a clock is not its affair.
[[nodiscard]] ReadOptions options_of_whole(ReadOptions options);
/// `whole`, read by options_of_whole(), or a reader of its rows inside options.range, where one is given.
/// Lines pass as they stand; comments and blank lines go with the row before them.
[[nodiscard]] std::unique_ptr<LogReader> rows_in_range(std::unique_ptr<CsvReader> whole,
                                                       const ReadOptions& options);
[[nodiscard]] std::unique_ptr<LogReader> rows_in_range(std::unique_ptr<ColumnReader> whole,
                                                       const ReadOptions& options);

}  // namespace ripplenotch
