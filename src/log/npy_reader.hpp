// SPDX-License-Identifier: MIT
#pragma once
// Rows of a NumPy array file, a block at a time, in bounded memory.

#include <memory>
#include <string>
#include <vector>

#include "log/npy_header.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

class NpyReader : public LogReader {
  public:
    NpyReader(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options);

    [[nodiscard]] const Layout& layout() const override { return layout_; }
    [[nodiscard]] std::string_view head() const override { return head_; }
    bool next(RowBlock& block) override;

    [[nodiscard]] const NpyHeader& header() const { return header_; }

  private:
    void decide(const ReadOptions& options);
    void read_up_to(std::string& bytes, std::size_t size);
    void take_row(RowBlock& block, std::size_t offset);
    double take_value(RowBlock& block, const char* record, std::size_t column, double before);
    [[noreturn]] void complain(std::size_t column, const std::string& sentence) const;

    std::unique_ptr<ByteSource> source_;
    NpyHeader header_;
    Layout layout_;
    std::string head_, carry_;
    bool hold_bad_values_ = false;
    std::size_t rows_ = 0;
    double time_before_, velocity_before_, torque_before_, position_before_;  ///< as in the file
};

}  // namespace ripplenotch
