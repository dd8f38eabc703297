// SPDX-License-Identifier: MIT
#pragma once
// Formats that are read as records: how they are opened, and how rows outside a range are left out of them.

#include <memory>
#include <string>
#include <utility>

#include "log/records/record_table.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// A file as records.
struct Records {
    std::unique_ptr<ByteSource> bytes;
    RecordTable table;
};
/// Of a format. Throws DataError and UsageError, beginning with the source's name or the option.
using MakeRecords = Records (*)(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                const ReadOptions& options);

[[nodiscard]] std::unique_ptr<LogReader> read_records(std::unique_ptr<ByteSource> source,
                                                      std::string first_bytes, const ReadOptions& options,
                                                      MakeRecords make);
/// LogFormat::cut: the whole log is gone through first, and what is kept waits in a temporary file.
[[nodiscard]] LogCut cut_records(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                 const ReadOptions& options, MakeRecords make);

template <MakeRecords make>
std::unique_ptr<LogReader> open_as_records(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                           const ReadOptions& options) {
    return read_records(std::move(source), std::move(first_bytes), options, make);
}
template <MakeRecords make>
LogCut cut_as_records(std::unique_ptr<ByteSource> source, std::string first_bytes,
                      const ReadOptions& options) {
    return cut_records(std::move(source), std::move(first_bytes), options, make);
}

}  // namespace ripplenotch
