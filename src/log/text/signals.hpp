// SPDX-License-Identifier: MIT
#pragma once
// Text in which signals have times of their own, each read as one number over time.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/clock/stamp.hpp"
#include "log/numbers/columns.hpp"
#include "log/text/text_cells.hpp"

namespace ripplenotch {

/// Lines with their numbers, cut into cells; blank ones and comments are passed over.
class Lines {
  public:
    /// From the byte `at`, in front of which there are `number` lines.
    Lines(std::string_view bytes, std::string source, std::size_t at = 0, std::size_t number = 0)
        : bytes_(bytes), source_(std::move(source)), at_(at), number_(number) {}
    bool next();
    [[nodiscard]] std::vector<std::string> cells(char delimiter) const;
    void split(char delimiter) { split_cells(line_, delimiter, split_); }
    /// Of the line that was split; empty behind the end of a short one.
    [[nodiscard]] std::string_view cell(std::size_t column) const {
        return column < split_.cells.size() ? split_.cells[column].of(line_) : std::string_view();
    }
    [[nodiscard]] std::size_t cell_count() const { return split_.cells.size(); }
    [[nodiscard]] std::string_view line() const { return line_; }
    [[nodiscard]] std::size_t number() const { return number_; }
    /// `cell`: of the line, whose place is told; or text of something else.
    [[noreturn]] void complain(const std::string& sentence, std::string_view cell = {}) const;

  private:
    std::string_view bytes_, line_;
    std::string source_;
    std::size_t at_ = 0, number_ = 0;
    CellSplit split_;
};

/// One number over time.
struct Signal {
    std::string name, read_as, unit;  ///< as ColumnInfo has them
    ColumnNumbers time;               ///< its counts are those of whole numbers
    std::vector<double> values;
};

/// Signals that are read from lines.
class Signals {
  public:
    Signals(const Lines& lines, std::string time_name, StampForm form = {})
        : lines_(lines), time_name_(std::move(time_name)), form_(form) {}
    std::vector<Signal> all;

    /// The one of this name, which is added where there is none.
    std::size_t index_of(const std::string& name, const std::string& unit);
    /// Cells of numbers with either decimal mark, or of dates and times of day.
    void add(std::size_t signal, std::string_view time, std::string_view value, char delimiter);
    /// "time [s]" where the times are dates or times of day.
    [[nodiscard]] std::string time_name() const { return origin_s_ ? "time [s]" : time_name_; }
    /// In columns: those with the times of the signal `base` with it, the others joined to them. `clock`: how
    /// the column of times is called.
    [[nodiscard]] ColumnLog columns(const std::string& source, ColumnInfo clock, std::size_t base,
                                    const ReadOptions& options);

  private:
    [[nodiscard]] double ns_per_unit(const ColumnInfo& clock) const;

    const Lines& lines_;
    std::string time_name_;
    StampForm form_;
    std::map<std::string, std::size_t> places_;
    std::optional<std::int64_t> origin_s_;
    bool all_whole_ = true;  ///< the times
};

/// A number, with a comma for its decimals where that separates no cells.
[[nodiscard]] std::optional<double> number_in(std::string_view text, char delimiter);

/// The numbers of a list in one cell, "[0.1, 0.2]" or "(0.1 0.2)"; none where it is no such.
[[nodiscard]] std::optional<std::vector<double>> list_in(std::string_view cell);

}  // namespace ripplenotch
