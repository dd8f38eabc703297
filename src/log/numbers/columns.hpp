// SPDX-License-Identifier: MIT
#pragma once
// Logs as columns of numbers: what every format but text comes to (docs/decisions/0043-columns.md).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "log/columns/decide_layout.hpp"
#include "log/text/quick_rows.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

struct ColumnInfo {
    std::string path;     ///< as --columns takes it; empty where the file names none
    std::string read_as;  ///< what the path means beside the others: "q_3"; empty: the path says it
    std::string unit;     ///< as the file states it
    bool whole = false;   ///< integers of eight bytes, of which a double may not hold all digits
    bool number = true;   ///< false: text and other things that are none
};

/// Numbers of a column in consecutive rows.
struct ColumnNumbers {
    std::vector<double> values;
    std::vector<std::int64_t> counts;  ///< the same as they are, of ColumnInfo::whole only
    void clear() {
        values.clear();
        counts.clear();
    }
};
using NumberRows = std::vector<ColumnNumbers>;  ///< by column

/// Appends these `rows` of `from`.
void append_rows(const NumberRows& from, const std::vector<std::size_t>& rows, NumberRows& into);

class Columns {
  public:
    virtual ~Columns() = default;
    /// As messages name the file.
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const std::vector<ColumnInfo>& info() const { return info_; }
    /// From here on only these columns are wanted; what becomes of the others' numbers does not matter.
    virtual void keep(std::vector<bool> wanted) { wanted_ = std::move(wanted); }
    /// Appends the next rows, about as many as are asked for, to `into`, which has an entry for each column,
    /// and their bytes to `bytes` where they can be written again. Returns how many; 0 at the end. Throws
    /// DataError, beginning with the name.
    virtual std::size_t next(std::size_t rows, NumberRows& into, std::string& bytes) = 0;
    /// In the file, where a range leaves rows out. Both count from 1.
    [[nodiscard]] virtual std::size_t number_in_file(std::size_t row) const { return row; }
    /// What a range left out; null where none was asked for.
    [[nodiscard]] virtual std::shared_ptr<const RowsOutside> outside() const { return nullptr; }
    /// Those of the file itself, without a range.
    [[nodiscard]] virtual const Columns& base() const { return *this; }
    /// What a row takes, of its bytes or of the numbers that are wanted.
    [[nodiscard]] virtual std::size_t row_bytes() const;

  protected:
    Columns(std::string name, std::vector<ColumnInfo> info)
        : name_(std::move(name)), info_(std::move(info)), wanted_(info_.size(), true) {}
    [[nodiscard]] bool wanted(std::size_t column) const { return wanted_[column]; }

  private:
    std::string name_;
    std::vector<ColumnInfo> info_;
    std::vector<bool> wanted_;
};

/// Rows in memory, given out in pieces.
class HeldColumns final : public Columns {
  public:
    HeldColumns(std::string name, std::vector<ColumnInfo> info, NumberRows numbers, std::string bytes = {});
    std::size_t next(std::size_t rows, NumberRows& into, std::string& bytes) override;

  private:
    NumberRows numbers_;
    std::string bytes_;
    std::size_t rows_ = 0, row_ = 0;
};

/// A file as columns, and what has to be said of it.
struct ColumnLog {
    std::unique_ptr<Columns> columns;
    std::string format;                  ///< "raw", "mcap"
    std::string options;                 ///< "--format raw --layout f8,f4,f4"
    std::vector<ContentEntry> contents;  ///< all that is in the file
    std::vector<std::string>
        asked;  ///< in place of ReadOptions::columns, where paths had to be settled; else empty
    std::vector<LogWarning> warnings;
    std::vector<Assumption> inferences;
};

/// The rows inside options.range, where one is given.
[[nodiscard]] std::unique_ptr<LogReader> read_columns(ColumnLog log, const ReadOptions& options);

/// A signal with a clock of its own.
struct SideColumn {
    std::unique_ptr<Columns> columns;  ///< its clock first
    std::size_t column = 1;            ///< of the signal
    double ns_per_unit = 1.0;          ///< of the clock
    std::string_view noun = "value";   ///< what one number of it is called
};

/// Puts `sides` beside the columns of `log`, whose clock comes first. --join nearest takes the value nearest
/// in time, hold that of the last one before, linear goes between the two around it; throws UsageError for
/// others. Rows before the first value of a side and behind its last are left out. next() throws DataError
/// where a side is farther away than three of its periods.
void join_columns(ColumnLog& log, double ns_per_unit, std::vector<SideColumn> sides,
                  const ReadOptions& options);

/// The one reader of columns of numbers: which of them are what, their factors, and what is wrong with a row.
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
