// SPDX-License-Identifier: MIT
#pragma once
// Rows of a NumPy array file, a block at a time, in bounded memory.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "log/columns/decide_layout.hpp"
#include "log/npy/npy_header.hpp"
#include "log/records/joined_records.hpp"
#include "log/text/quick_rows.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

class NpyReader : public LogReader {
  public:
    NpyReader(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options);

    /// Records of a dump or a container: bytes without a head, that fields say how to read.
    /// Only those that are wanted are asked for, unless a range is still to choose among the rows.
    NpyReader(std::unique_ptr<ByteSource> records, RecordTable table, const ReadOptions& options);

    /// Some `rows` of another reader's records, none of which has been read.
    NpyReader(std::unique_ptr<ByteSource> records, const NpyReader& whole, std::size_t rows,
              const ReadOptions& options);

    [[nodiscard]] const Layout& layout() const override { return layout_; }
    [[nodiscard]] std::string_view head() const override { return head_; }
    /// The size of the whole log; 0 where it is not known.
    [[nodiscard]] std::uint64_t source_bytes() const { return source_->size(); }
    bool next(RowBlock& block) override;
    bool fetch(RowBlock& block) override;
    void parse(RowBlock& block) const override;
    void accept(RowBlock& block) override;

    [[nodiscard]] const NpyHeader& header() const { return header_; }
    /// What a record says, in the unit of its column, less the origin; only where there is a time column.
    [[nodiscard]] double time_of(const char* record) const { return time_at(record, layout_); }

  private:
    void begin_records(const ReadOptions& options);
    void read_whole(std::string& first_bytes);
    void decide(const ReadOptions& options);
    [[nodiscard]] ColumnFacts column_facts();
    void keep_wanted(RecordSource& records);
    [[nodiscard]] std::size_t sample_rows() const;
    [[noreturn]] void complain_of_end(std::size_t left_over) const;
    [[nodiscard]] double time_at(const char* record, const Layout& layout) const;
    [[nodiscard]] double value_at(const char* record, const WantedColumn& wanted) const;
    [[nodiscard]] MotionSample motion_sample(const MotionPlaces& places) const;
    bool read_column(const char* records, const WantedColumn& wanted, std::span<double> numbers) const;
    void read_up_to(std::string& bytes, std::size_t size);
    std::size_t unload(std::string& bytes, std::size_t most);
    void plan_columns(const std::vector<std::string>& names);
    bool read_columns(RowBlock& block) const;
    [[nodiscard]] bool continues(const RowBlock& block) const;
    void count_rows(RowBlock& block);
    void read_row(RowBlock& block, std::size_t offset);
    double read_value(RowBlock& block, const char* record, const WantedColumn& wanted);
    [[noreturn]] void complain(std::size_t column, const std::string& sentence) const;

    std::unique_ptr<ByteSource> source_;
    NpyHeader header_;
    RecordTable table_;  ///< of records without a head
    Layout layout_;
    std::string head_, carry_;
    std::size_t carried_ = 0;  ///< of carry_, into blocks
    bool hold_bad_values_ = false;
    bool endless_ = false;  ///< the end of the bytes is the end of the rows
    std::size_t fetched_ = 0, rows_ = 0;
    std::vector<WantedColumn> wanted_;
    std::vector<double> factors_, before_;  ///< by slot; before: the row before, as in the file
};

}  // namespace ripplenotch
