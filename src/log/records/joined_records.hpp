// SPDX-License-Identifier: MIT
#pragma once
// Signals with clocks of their own, of another topic or another array, beside the rows of one.

#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "log/npy/npy_header.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

// What a dump or a container comes to for the reader of records: rows of numbers with names. Whatever the
// file is made of, from here on it is read as an array is.

/// The numbers of a row and where they stand in a record.
struct RecordTable {
    std::string format;                ///< "raw", "mcap"
    std::vector<NpyField> fields;      ///< named by path; no names where the file has none
    std::vector<std::string> read_as;  ///< what names mean beside each other: "q_3"; empty: the names
    std::vector<std::string> units;    ///< as the file states them; empty where it states none
    bool named = true;
    std::optional<std::size_t> rows;     ///< nobody knows of a stream
    std::size_t record_size = 0;         ///< bytes a row
    std::string options;                 ///< "--format raw --layout f8,f4,f4"
    std::vector<ContentEntry> contents;  ///< all that is in the file
    std::vector<std::string>
        columns;  ///< in place of ReadOptions::columns, where paths had to be settled; else empty
    std::vector<LogWarning> warnings;

    /// One more number at the end of a record.
    void add(NpyField field, std::string name, std::string meaning, std::string unit);
};

/// The records as bytes, made some rows at a time.
class RecordSource : public ByteSource {
  public:
    /// From here on, what was made ahead included, records hold only these of the fields, one behind the
    /// other. Whole records have been read until now. `fields` in ascending order.
    void keep(const std::vector<std::size_t>& fields);
    std::size_t read(char* into, std::size_t size) final;
    /// The bytes of each field, whether it is kept or not.
    [[nodiscard]] const std::vector<std::size_t>& sizes() const { return sizes_; }

  protected:
    /// `sizes`: of the fields in bytes, in their order.
    RecordSource(Name name, std::vector<std::size_t> sizes);
    /// Bytes of a record of the fields that are kept.
    [[nodiscard]] std::size_t record_size() const { return record_size_; }
    [[nodiscard]] const std::vector<std::size_t>& kept() const { return kept_; }

  private:
    /// The fields that are kept have changed.
    virtual void chosen() {}
    /// Puts whole records into `bytes`, which is empty; none at the end.
    virtual void refill(std::string& bytes) = 0;

    std::vector<std::size_t> sizes_, kept_;
    std::size_t record_size_ = 0, given_ = 0;
    std::string bytes_;
};

// Formats that are read as records.

/// A file as records.
struct Records {
    std::unique_ptr<ByteSource> bytes;
    RecordTable table;
};
/// Makes them from a file of one format. Throws DataError and UsageError, beginning with the source's name or
/// the option.
using MakeRecords = Records (*)(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                const ReadOptions& options);

[[nodiscard]] std::unique_ptr<LogReader> read_records(std::unique_ptr<ByteSource> source,
                                                      std::string first_bytes, const ReadOptions& options,
                                                      MakeRecords make);

template <MakeRecords make>
std::unique_ptr<LogReader> open_as_records(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                           const ReadOptions& options) {
    return read_records(std::move(source), std::move(first_bytes), options, make);
}

// Numbers from equal distances to equal distances: how columns become records, and records columns.

/// Where numbers lie: the first, and how many bytes further each next one.
template <class Byte>
struct Stride {
    Byte* first;
    std::size_t bytes;
};

namespace strided {

/// With a size that the compiler knows, a copy is one load and one store.
template <std::size_t Size>
void copy_numbers(Stride<const char> from, Stride<char> into, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        std::memcpy(into.first + i * into.bytes, from.first + i * from.bytes, Size);
}

}  // namespace strided

/// `count` numbers of `size` bytes each; the two places do not overlap.
inline void copy_numbers(Stride<const char> from, Stride<char> into, std::size_t size, std::size_t count) {
    switch (size) {
        case 8:
            return strided::copy_numbers<8>(from, into, count);
        case 4:
            return strided::copy_numbers<4>(from, into, count);
        case 2:
            return strided::copy_numbers<2>(from, into, count);
        default:
            for (std::size_t i = 0; i < count; ++i)
                std::memcpy(into.first + i * into.bytes, from.first + i * from.bytes, size);
    }
}

/// One number with a clock of its own.
struct SideSignal {
    std::string path;                       ///< "/ft.wrench.torque.z", "q_dot.Data"
    std::string read_as;                    ///< what the path means beside the others
    std::unique_ptr<RecordSource> records;  ///< its clock in nanoseconds and the number, nothing else
    NpyField type;                          ///< of the number, behind the clock
    std::int64_t limit_ns = 0;              ///< the farthest in time that is taken
    std::string unit;                       ///< as the file states it
    std::string_view noun = "message";      ///< what one number of it is called
};
/// The farthest in time that is taken of a signal with this usual step.
[[nodiscard]] std::int64_t join_limit_ns(double period_ns);

/// The rows of `base`, which gives all its fields, its clock first; behind them the sides, in 8 bytes each,
/// which `table` gets too. `how`: "nearest" takes the value of the message nearest in time, "hold" that of
/// the last one before, "linear" goes between the two around it; throws UsageError for others. Rows before
/// the first message of a side and behind its last are left out. read() throws DataError where a side is
/// farther than its limit.
[[nodiscard]] std::unique_ptr<RecordSource> join_records(std::unique_ptr<RecordSource> base,
                                                         std::vector<SideSignal> sides, std::string_view how,
                                                         RecordTable& table);

}  // namespace ripplenotch
