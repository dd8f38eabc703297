// SPDX-License-Identifier: MIT
#pragma once
// Records of numbers one behind the other, of a NumPy array or without a head, as columns.

#include <memory>
#include <string>
#include <vector>

#include "log/npy/npy_header.hpp"
#include "log/numbers/columns.hpp"

namespace ripplenotch {

class RecordColumns final : public Columns {
  public:
    /// `first_bytes` of the records have been read from `source`. Where nobody knows how many there are, the
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
