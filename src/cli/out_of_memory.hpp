// SPDX-License-Identifier: MIT
#pragma once
// What is said when memory runs out.

#include <string_view>

namespace ripplenotch {

/// One message on standard error: how much was asked for last, how much the process has, and what takes less.
/// Takes no memory.
void say_out_of_memory(std::string_view command) noexcept;

/// Where memory runs out in a function of a library that must not throw, the process ends with that message
/// and ExitCode::memory, and leaves no unfinished file.
void end_where_nothing_may_throw();

}  // namespace ripplenotch
