// SPDX-License-Identifier: MIT
#pragma once
// Lists of numbers on the command line, "1,2" or "25Hz,50Hz", and the ways in which people write them
// instead.

#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

[[nodiscard]] std::vector<std::string> split_commas(const std::string& text);

/// Throws UsageError with the list as it should be when `text` is one with other marks: "1 2", "1:2", "1, 2".
void refuse_other_marks(const std::string& option, const std::string& text, Dimension dimension);

/// The same for "--orders 1 2" among the words of a command line, whose second number would be taken for the
/// name of a log. A file of that name is one.
void refuse_split_list(const std::vector<std::string>& words, const std::string& option, Dimension dimension);

}  // namespace ripplenotch
