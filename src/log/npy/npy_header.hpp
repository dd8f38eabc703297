// SPDX-License-Identifier: MIT
#pragma once
// The header of a NumPy array file: which bytes of a record are which column. Format: NumPy Enhancement
// Proposal 1, versions 1.0, 2.0 and 3.0.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "log/numbers/columns.hpp"

namespace ripplenotch {

// One number in the records of a NumPy array.

/// One number in a record.
struct NpyField {
    std::string name;      ///< empty in plain arrays
    char kind = 'f';       ///< 'f' float, 'i' signed, 'u' unsigned, 0 anything that is no number
    std::size_t size = 8;  ///< bytes
    bool big_endian = false;
    std::size_t offset = 0;           ///< in the record
    double scale = 1.0, shift = 0.0;  ///< the number is what stands there times `scale` plus `shift`
    [[nodiscard]] bool scaled() const { return scale != 1.0 || shift != 0.0; }
    /// An integer that a double may not hold.
    [[nodiscard]] bool whole() const { return (kind == 'i' || kind == 'u') && size == 8 && !scaled(); }
};

/// Of "int16", "uint8", "float64" or, as NumPy has them, "i2", "u1", "f8"; none for other words.
[[nodiscard]] std::optional<NpyField> number_type(std::string_view word);

/// A number of a record; `record` points at its first byte.
[[nodiscard]] double load_field(const char* record, const NpyField& field);
/// The whole number of a field that is whole().
[[nodiscard]] std::int64_t load_count(const char* record, const NpyField& field);

/// Appends the numbers of `rows` records that stand `record_size` bytes from each other.
void load_column(const char* records, std::size_t record_size, const NpyField& field, std::size_t rows,
                 ColumnNumbers& into);

/// `values`, each divided by `factor`, into the floats of records that follow each other; records whose value
/// is that of `as_written` are left as they are. `as_written` is empty, or as long as `values`.
void store_column(char* records, std::size_t record_size, const NpyField& field,
                  std::span<const double> values, std::span<const double> as_written = {},
                  double factor = 1.0);

struct NpyHeader {
    std::vector<NpyField> fields;
    bool structured = false;
    std::size_t rows = 0;
    std::size_t record_size = 0;  ///< bytes a row
    std::size_t data_offset = 0;  ///< bytes before the first record
    std::string descr;            ///< as written in the file, for headers with a column more
    int version = 1;
    bool by_columns = false;  ///< the bytes of a column stand together: Fortran order, or one row a signal
    bool transposed = false;  ///< the file has one row a signal
    /// What stands behind the rows in the shape of an array that is stored row by row.
    [[nodiscard]] std::string after_rows(std::size_t more_columns = 0) const;
};

inline constexpr std::size_t largest_npy_header = std::size_t{1} << 20;
/// Of records without a header: the rows are as many as the file holds.
inline constexpr std::size_t rows_unknown = static_cast<std::size_t>(-1);
inline constexpr std::string_view npy_magic = "\x93NUMPY";

/// Bytes that the header occupies, from the first 12 bytes of a file; 0 when they are too few or no header.
[[nodiscard]] std::size_t npy_header_size(std::string_view first_bytes);

/// Throws DataError that begins with `source` on a damaged header and on arrays that are no log: objects,
/// more than two dimensions, columns stored one after the other (Fortran order), no numbers.
[[nodiscard]] NpyHeader parse_npy_header(std::string_view bytes, const std::string& source);

/// A whole header, padded to a multiple of 64 bytes as numpy.save does. `shape` is the text inside the
/// brackets. With `reserve_rows`, space for any number of rows is left, so that a later header of the same
/// fields has the same size.
[[nodiscard]] std::string make_npy_header(std::string_view descr, std::string_view shape, bool reserve_rows);

// Records of numbers one behind the other, of a NumPy array or without a head, as columns.

class RecordColumns final : public Columns {
  public:
    /// `first_bytes` of the records have been read from `source`. Where their number is not known, the
    /// end of the bytes is that of the rows, and header.rows is rows_unknown.
    RecordColumns(std::unique_ptr<ByteSource> source, std::string first_bytes, NpyHeader header,
                  std::string head);
    std::size_t next(std::size_t rows, NumberRows& into, std::string& bytes) override;
    [[nodiscard]] std::size_t row_bytes() const override { return header_.record_size; }

    [[nodiscard]] const NpyHeader& header() const { return header_; }
    /// The bytes before the first record.
    [[nodiscard]] const std::string& head() const { return head_; }
    /// The size of the whole log; 0 where it is not known.
    [[nodiscard]] std::uint64_t source_bytes() const { return source_->size(); }

  private:
    [[noreturn]] void complain_of_end(std::size_t left_over) const;

    std::unique_ptr<ByteSource> source_;
    std::string begun_;         ///< read, and not given yet
    std::size_t begun_at_ = 0;  ///< what of it has been given
    NpyHeader header_;
    std::string head_;
    std::size_t rows_ = 0;
};

}  // namespace ripplenotch
