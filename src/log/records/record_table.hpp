// SPDX-License-Identifier: MIT
#pragma once
// What a dump or a container comes to for the reader of records: rows of numbers with names. Whatever the
// file is made of, from here on it is read as an array is.

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "log/npy/npy_field.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

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
};

/// The records as bytes, made some rows at a time.
class RecordSource : public ByteSource {
  public:
    /// From here on, what was made ahead included, records hold only these of the fields, one behind the
    /// other. Whole records have been read until now. `fields` in ascending order.
    void keep(const std::vector<std::size_t>& fields);
    std::size_t read(char* into, std::size_t size) final;

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

}  // namespace ripplenotch
