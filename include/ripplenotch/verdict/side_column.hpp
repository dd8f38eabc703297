// SPDX-License-Identifier: MIT
#pragma once
// A column of a log that is no part of the motion: the joint's temperature.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// The numbers of `column`, as they stand there, at the rows at which read_log_in_part gives the joint's
/// motion.
/// "{joint}" in its name stands for the joint's. Throws what read_log_in_part throws.
[[nodiscard]] std::vector<double> side_column(const std::string& path, std::string column,
                                              const std::string& joint, ReadOptions read,
                                              std::size_t most_rows = most_rows_held);
/// Throws DataError where they are not as many as the rows of the motion beside which they stand.
void require_beside(const std::vector<double>& values, const Trace& motion, const std::string& path,
                    const std::string& column);
/// Their mean.
[[nodiscard]] double mean_of_side_column(const std::string& path, const std::string& column,
                                         const std::string& joint, const ReadOptions& read,
                                         std::size_t most_rows = most_rows_held);

/// The same for a method that follows the column: a cell without a number is the one before it, and `notes`
/// gets one sentence about such cells, if there were any.
[[nodiscard]] std::vector<double> held_side_column(const std::string& path, std::string column,
                                                   const std::string& joint, const ReadOptions& read,
                                                   std::vector<std::string>& notes);

/// A method whose map depends on the temperature, as it is on a log whose rows tell theirs; `degc` is their
/// mean.
[[nodiscard]] std::string at_rows_temperature(const std::string& method, double degc);
/// Whether this is such a method.
[[nodiscard]] bool follows_temperature(const Contender& method);

/// A method as --method takes it, with the temperature of this log behind it where its map depends on one and
/// the text states none: the mean of the column that the map was made by, and the word to follow that column
/// row by row. Throws DataError, naming log, column and remedy, where the log has none.
[[nodiscard]] std::string at_log_temperature(const std::string& method, const std::string& log,
                                             const ReadOptions& read);

/// The temperature that a method follows row by row, beside the rows that open_log gives of the same log. A
/// cell without a number is the one before it.
class FollowedRows final : public RowValues {
  public:
    FollowedRows(const std::string& path, std::string column, const ReadOptions& side);
    std::span<const double> next(std::size_t count) override;
    /// One sentence about cells without a number, if there were any.
    [[nodiscard]] std::vector<std::string> notes() const;

  private:
    std::string path_, column_;
    std::unique_ptr<LogReader> reader_;
    RowBlock block_;
    std::vector<double> values_;
    std::size_t used_ = 0, held_ = 0;
};
/// Null where the method follows none.
[[nodiscard]] std::unique_ptr<FollowedRows> followed_rows(const Contender& method, const std::string& log,
                                                          const ReadOptions& read);
/// The same at the rows at which read_log_in_part gives the motion; empty where the method follows none.
/// `notes`: gets the sentence of FollowedRows.
[[nodiscard]] std::vector<double> followed_values(const Contender& method, const std::string& log,
                                                  const ReadOptions& read, std::vector<std::string>& notes);

}  // namespace ripplenotch
