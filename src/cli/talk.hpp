// SPDX-License-Identifier: MIT
#pragma once
// What the tool says: the only place where words go to standard error, and texts for people to a file or to
// standard output. Nothing said can act on a terminal, and nothing that becomes of standard error changes
// what a command does.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

// Tables for people: columns as wide as their widest cell, two spaces between them.

using TextRows = std::vector<std::vector<std::string>>;

/// Rows of cells, header rows included. `alignment` has one letter a column, 'l' or 'r'; the last letter
/// holds for all further columns. Cells are made visible. Rows may be of different length; no line ends in a
/// space.
[[nodiscard]] std::string text_table(const TextRows& cells, std::string_view alignment);

/// A cell with so many decimals of a number, or of a quantity times `factor`; a dash where there is none.
template <class Number>
[[nodiscard]] std::string cell_text(const std::optional<Number>& value, int decimals, double factor = 1.0) {
    return value ? rounded(factor * (*value / Number(1.0)), decimals) : "-";
}

// The bar on standard error for work that takes longer than a second; only on a terminal, and gone
// afterwards.

class ProgressBar {
  public:
    /// Shows nothing when standard error is no terminal, is one that cannot erase (TERM=dumb), or `words` of
    /// the command line hold -q or --quiet. One at a time.
    explicit ProgressBar(const std::vector<std::string>& words);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

  private:
    struct Painter;
    std::unique_ptr<Painter> painter_;
};

/// From now on what would go to standard error is added to `text`, for a program that the tool runs in; with
/// null it goes to standard error again.
void capture_talk(std::string* text) noexcept;

/// One line on standard error, made visible. Where nobody takes it (closed, full, gone), it is lost.
void talk(std::string_view line);

/// Several lines on standard error, each made visible.
void talk_lines(std::string_view lines);

/// Columns of standard output where it is a terminal, 80 where it does not say; empty where it is none.
[[nodiscard]] std::optional<std::size_t> terminal_columns();

/// write_all() of visible_lines().
void write_text(const std::string& path, std::string_view lines, ByteSink::Overwrite overwrite);

/// Takes the places of standard streams that are closed, so that no file opened later becomes one of them.
/// Reading or writing them fails as before.
void hold_closed_streams();

}  // namespace ripplenotch
