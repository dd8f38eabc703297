// SPDX-License-Identifier: MIT
#pragma once
// The one reader of columns of numbers: which of them are what, their factors, and what is wrong with a row.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/columns/decide_layout.hpp"
#include "log/numbers/columns.hpp"
#include "log/text/quick_rows.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

class ColumnReader final : public LogReader {
  public:
    ColumnReader(ColumnLog log, const ReadOptions& options);

    [[nodiscard]] const Layout& layout() const override { return layout_; }
    bool next(RowBlock& block) override;
    bool fetch(RowBlock& block) override;

    [[nodiscard]] const Columns& columns() const { return *log_.columns; }
    /// From here on only these columns are wanted, and those of the time.
    void keep(std::vector<bool> wanted);
    /// All that is known but the columns, for a reader of some of their rows.
    [[nodiscard]] ColumnLog same_log(std::unique_ptr<Columns> columns) const;
    /// The next rows as they stand in the file, without a judgement; 0 at the end.
    std::size_t take(NumberRows& numbers, std::string& bytes);
    /// What a row says, in the unit of its column, less the origin; only where there is a time column.
    [[nodiscard]] double time_at(const NumberRows& numbers, std::size_t row) const {
        return time_at(numbers, row, layout_);
    }

  private:
    void decide(const ReadOptions& options);
    [[nodiscard]] ColumnFacts column_facts();
    [[nodiscard]] std::vector<std::string> names() const;
    void read_ahead(std::size_t rows);
    [[nodiscard]] double time_at(const NumberRows& numbers, std::size_t row, const Layout& layout) const;
    /// Numbers of a column as in the file, up to the first of `rows` that is wrong, which it returns.
    std::size_t judge(RowBlock& block, const WantedColumn& wanted, std::size_t rows) const;
    [[noreturn]] void complain(const WantedColumn& wanted, std::size_t row, double value,
                               double before) const;

    ColumnLog log_;
    Layout layout_;
    bool hold_bad_values_ = false;
    NumberRows ahead_, numbers_;  ///< read to decide on the layout; of the rows that are taken
    std::string ahead_bytes_;
    std::optional<HeldColumns> held_;  ///< what was read ahead, when it is decided
    std::size_t ahead_rows_ = 0, rows_ = 0, at_once_ = 0;
    std::vector<WantedColumn> wanted_;
    std::vector<double> factors_, before_;  ///< by slot; before: the row before, as in the file
};

}  // namespace ripplenotch
