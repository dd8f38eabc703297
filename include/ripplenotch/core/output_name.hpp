// SPDX-License-Identifier: MIT
#pragma once
// What the ending of a file's name promises about what is in it.

#include <string_view>

namespace ripplenotch {

/// Refuses to write one kind of file under the name of another. `what` is what would be written, as "a log",
/// and `endings` those that fit it, with blanks between them: ".csv .npy". Endings that say no kind of file
/// which the tool knows are free, so are names without one. Throws UsageError with the endings that fit.
/// `option`: that was given the name.
void check_output_name(std::string_view path, std::string_view what, std::string_view endings,
                       std::string_view option = "-o");

}  // namespace ripplenotch
