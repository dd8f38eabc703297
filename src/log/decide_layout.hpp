// SPDX-License-Identifier: MIT
#pragma once
// From what a file says about its columns to a Layout: roles, units, joints, the joint that is read. The same
// for every format, so that a CSV and an NPY of the same names are understood alike. Ambiguity is an error
// that lists the readings and the option that decides.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// What a format knows of its columns before any decision.
struct ColumnFacts {
    std::vector<std::string> names;  ///< one a column; empty when the file names none
    std::vector<std::string> units;  ///< from a unit row; empty when there is none
    std::size_t columns = 0;
    std::vector<std::vector<double>>
        sample;                   ///< the first rows by column; not-a-number where a cell is no number
    std::string dialect_options;  ///< "--delimiter ',' --decimal ." and the like, for Layout::options
};

/// Throws DataError (two possible columns, no time, several joints, a unit that does not fit) and UsageError
/// (an option that names what is not there). Messages begin with `source`.
[[nodiscard]] Layout decide_layout(const std::string& source, const std::string& format,
                                   const ColumnFacts& facts, const ReadOptions& options);

/// Column's name and place as messages write it: "'dq_0' (column 7)".
[[nodiscard]] std::string column_label(const std::vector<std::string>& names, std::size_t column);

/// The parts that decide_layout is made of, each in a file of its own.
namespace layout_detail {

/// Role forced by --columns for each column, by index; Role::other with `forced` means "skip".
struct Forced {
    std::vector<std::optional<Role>> roles;
    bool by_place = false;
    [[nodiscard]] std::optional<std::size_t> column_of(Role role) const;
};
[[nodiscard]] Forced read_columns_option(const std::string& source, const ColumnFacts& facts,
                                         const ReadOptions& options);

/// The time column, decided by the values as well as the name; empty when there is none or a rate was stated.
[[nodiscard]] std::optional<std::size_t> choose_time(const std::string& source, const ColumnFacts& facts,
                                                     const Forced& forced, const ReadOptions& options,
                                                     std::vector<std::string>& warnings);

/// The option line that would force this reading.
[[nodiscard]] std::string options_line(const Layout& layout, const ColumnFacts& facts,
                                       const ReadOptions& options);

/// True when the values have two or more different numbers among them.
[[nodiscard]] bool varies(const std::vector<double>& values);

}  // namespace layout_detail
}  // namespace ripplenotch
