// SPDX-License-Identifier: MIT
#pragma once
// Rows of a text log, a block at a time, in bounded memory.

#include <memory>
#include <optional>
#include <string>

#include "log/columns/decide_layout.hpp"
#include "log/rows_in_range.hpp"
#include "log/text/quick_rows.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// A text log of which as much has been read as tells how it is written.
struct TextOpening {
    TextOpening(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options);
    /// All of it.
    [[nodiscard]] std::string whole();

    std::unique_ptr<ByteSource> source;
    std::string bytes;
    bool ended = false;  ///< the source has no more
    TextDialect dialect;
};

class CsvReader : public LogReader {
  public:
    CsvReader(TextOpening opening, const ReadOptions& options);
    CsvReader(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options)
        : CsvReader(TextOpening(std::move(source), std::move(first_bytes), options), options) {}

    [[nodiscard]] const Layout& layout() const override { return layout_; }
    /// The bytes before the first row (header, comments), to be passed on as they are.
    [[nodiscard]] std::string_view head() const { return head_; }
    /// The size of the whole log; 0 where it is not known.
    [[nodiscard]] std::uint64_t source_bytes() const { return source_->size(); }
    bool next(RowBlock& block) override;
    bool fetch(RowBlock& block) override;
    void parse(RowBlock& block) const override;
    void accept(RowBlock& block) override;

    [[nodiscard]] const TextDialect& dialect() const { return dialect_; }

  private:
    void decide(std::string& opening);
    void note_quick_rows(RowBlock& block, std::size_t before);
    [[nodiscard]] bool continues(const RowBlock& block) const;
    std::size_t accept_from(RowBlock& block, std::size_t begin);
    bool accept_line(RowBlock& block, std::size_t begin, std::size_t end);
    void refuse_controls(std::string_view line) const;
    void parse_carefully(std::string_view line, RowBlock& block, ParsedRow& row);
    double other_number(std::string_view line, const Cell& cell, const WantedColumn& wanted,
                        std::optional<double> number, RowBlock& block);
    void append_row(RowBlock& block, ParsedRow& row);
    [[nodiscard]] std::size_t line_in_file() const { return number_in_file(*source_, line_); }
    [[noreturn]] void complain(std::size_t column, const std::string& sentence) const;

    std::unique_ptr<ByteSource> source_;
    ReadOptions options_;
    TextDialect dialect_;
    Layout layout_;
    std::string head_;
    bool source_ended_ = false;  ///< the source has no more bytes
    std::string carry_;    ///< bytes after the last complete line; at first what the layout was decided on
    bool at_end_ = false;  ///< there is nothing left to fetch
    bool last_line_complete_ = true;  ///< the line being taken has its line end
    bool plain_row_ = false;          ///< the line taken last was a row that needed no care
    bool end_mark_seen_ = false;      ///< a line "EOF"
    std::size_t line_ = 1;            ///< number of the line being read
    std::size_t rows_ = 0;
    std::size_t bytes_without_row_ = 0;
    std::optional<RowParser> parser_;
    ParsedRow before_, row_;  ///< as in the file; `before_` is the row before
    CellSplit split_;
};

/// Opens any text log, `first_bytes` read already. The numbers of lists in the cells of a table are columns
/// each. Where a row or a block of rows holds one signal, or columns have times of their own
/// (TextDialect::own_clocks), all is held in memory, with a column for each signal; those with other times
/// than the torque's are joined to it by ReadOptions::join. Columns of one time in every row, up to half a
/// step, and traces of one block only are read as any text. Throws DataError.
[[nodiscard]] std::unique_ptr<LogReader> open_text(std::unique_ptr<ByteSource> source,
                                                   std::string first_bytes, const ReadOptions& options);

}  // namespace ripplenotch
