// SPDX-License-Identifier: MIT
#pragma once
// From what a file says about its columns to a Layout: roles, units, joints, the joint that is read. The same
// for every format, so that a CSV and an NPY of the same names are understood alike. Ambiguity is an error
// that lists the readings and the option that decides.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

struct ColumnName;

/// Rows of some columns, of equal lengths. Time in the file's unit, less its origin.
struct MotionSample {
    std::vector<double> time;
    std::vector<std::vector<double>> values;  ///< by column, in the order in which they were asked for
    bool whole = false;                       ///< the log has no more rows
};

/// A scale that the head of a file states for a column, and not whether the values have it.
struct HeadScale {
    std::string words;  ///< "ScaleFactor 2, Offset 10"; empty where there is none
    double factor = 1.0, offset = 0.0;
};

/// What a format knows of its columns before any decision.
struct ColumnFacts {
    std::vector<std::string> names;    ///< one a column; empty when the file names none
    std::vector<std::string> read_as;  ///< what paths mean beside each other; empty where names say it
    std::vector<std::string> units;    ///< from a unit row; empty when there is none
    [[nodiscard]] const std::vector<std::string>& meanings() const {
        return read_as.empty() ? names : read_as;
    }
    std::size_t columns = 0;
    std::string left_out;  ///< of a container: what might have been meant and is not read, with the reason
    std::vector<std::vector<double>>
        sample;  ///< the first rows by column; not-a-number where a cell is no number
    std::vector<std::int64_t> first_counts;  ///< whole numbers of the first row, exact; 0 where there is none
    std::vector<bool> clock_texts;  ///< by column: its cells are dates or times of day; empty when none is
    std::vector<StampForm> stamp_forms;  ///< by column, where clock_texts are
    bool sums_steps = false;             ///< the reader can sum a column of time steps
    std::vector<HeadScale> scales;       ///< by column; empty where the head states none
    std::optional<double> row_step_s;    ///< where the head of the file says how long a row is
    std::string row_step_key;            ///< the word in the head that says it
    std::string dialect_options;         ///< "--delimiter ',' --decimal ." and the like, for Layout::options
    /// Rows of velocities and positions, as they stand in the file, not-a-number where a cell is no number:
    /// those of the first `bytes`, and at least those at hand. Of all joints in one pass.
    std::function<MotionSample(const Layout& layout, const std::vector<std::size_t>& columns,
                               std::size_t bytes)>
        motion_sample;
};

/// Throws DataError (two possible columns, no time, several joints, a unit that does not fit) and UsageError
/// (an option that names what is not there). Messages begin with `source`.
[[nodiscard]] Layout decide_layout(const std::string& source, const std::string& format,
                                   const ColumnFacts& facts, const ReadOptions& options);

/// The role that --columns gives to what has this path, as it was written; empty where it names it not.
[[nodiscard]] std::string asked_role(const ReadOptions& options, std::string_view path);

/// Column's name and place as messages write it: "'dq_0' (column 7)".
[[nodiscard]] std::string column_label(const std::vector<std::string>& names, std::size_t column);

/// The parts that decide_layout is made of, each in a file of its own.

/// Role forced by --columns for each column, by index; Role::other with `forced` means "skip".
struct Forced {
    std::vector<std::optional<Role>> roles;
    bool by_place = false;
    [[nodiscard]] std::optional<std::size_t> column_of(Role role) const;
};

/// The time column, decided by the values as well as the name, into layout.chosen; seconds and nanoseconds in
/// two columns into layout.time_fraction too. None where there is none or a rate was stated.
void choose_time(const ColumnFacts& facts, const std::vector<ColumnName>& names, const Forced& forced,
                 const ReadOptions& options, Layout& layout);

/// The unit of the chosen time column where nothing states it, and what is taken off long stamps. Throws
/// DataError where no unit gives a rate that a log has.
void settle_clock(const ColumnFacts& facts, bool unit_is_stated, Layout& layout);

/// Bytes of the opening that are looked at for units, where those at hand do not tell: joints rest at first.
/// Where all units are stated, only the first of the two.
inline constexpr std::size_t longer_opening = std::size_t{1} << 20, longest_opening = std::size_t{1} << 23;

/// True when the values have two or more different numbers among them.
[[nodiscard]] bool varies(const std::vector<double>& values);

}  // namespace ripplenotch
