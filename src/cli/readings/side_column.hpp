// SPDX-License-Identifier: MIT
#pragma once
// A column of a log that is no part of the motion: the joint's temperature.

#include <string>
#include <vector>

#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// The numbers of `column`, as they stand there, at the rows at which read_log_in_part gives the joint's
/// motion.
/// "{joint}" in its name stands for the joint's. Throws what read_log_in_part throws.
[[nodiscard]] std::vector<double> side_column(const std::string& path, std::string column,
                                              const std::string& joint, ReadOptions read,
                                              std::size_t most_rows = most_rows_held);
/// Their mean.
[[nodiscard]] double mean_of_side_column(const std::string& path, const std::string& column,
                                         const std::string& joint, const ReadOptions& read,
                                         std::size_t most_rows = most_rows_held);

/// A method as --method takes it, with the temperature of this log behind it where its map depends on one and
/// the text states none: the mean of the column that the map was made by. Throws DataError, naming log,
/// column and remedy, where the log has none.
[[nodiscard]] std::string at_log_temperature(const std::string& method, const std::string& log,
                                             const ReadOptions& read);

}  // namespace ripplenotch
