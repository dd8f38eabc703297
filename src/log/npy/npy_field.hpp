// SPDX-License-Identifier: MIT
#pragma once
// One number in the records of a NumPy array.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace ripplenotch {

/// One number in a record.
struct NpyField {
    std::string name;      ///< empty in plain arrays
    char kind = 'f';       ///< 'f' float, 'i' signed, 'u' unsigned, 0 anything that is no number
    std::size_t size = 8;  ///< bytes
    bool big_endian = false;
    std::size_t offset = 0;           ///< in the record
    double scale = 1.0, shift = 0.0;  ///< the number is what stands there times `scale` plus `shift`
    [[nodiscard]] bool scaled() const { return scale != 1.0 || shift != 0.0; }
};

/// A number of a record, and back; `record` points at its first byte.
[[nodiscard]] double load_field(const char* record, const NpyField& field);
/// A whole number less `origin`, exactly; other numbers are rounded first.
[[nodiscard]] double load_since(const char* record, const NpyField& field, std::int64_t origin);
/// The whole number of the field, without its decimals; 0 where there is none.
[[nodiscard]] std::int64_t load_count(const char* record, const NpyField& field);
void store_float(char* record, const NpyField& field, double value);

/// load_field of `rows` records that follow each other. False when a number is not finite.
bool load_column(const char* records, std::size_t record_size, const NpyField& field, std::span<double> into);

/// store_float of `values`, each divided by `factor`, into records that follow each other; records whose
/// value is that of `as_written` are left as they are. `as_written` is empty, or as long as `values`.
struct StoredColumn {
    std::span<const double> values, as_written;
    double factor = 1.0;
};
void store_column(char* records, std::size_t record_size, const NpyField& field, const StoredColumn& column);

}  // namespace ripplenotch
