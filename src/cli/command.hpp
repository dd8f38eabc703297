// SPDX-License-Identifier: MIT
#pragma once
// A command is a record: one folder in src/cli, one line in commands.def.

#include <functional>
#include <span>
#include <string_view>

#include "cli/options/options.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

struct Command {
    std::string_view name;
    std::string_view summary;      ///< one line, for the list of commands
    std::string_view description;  ///< a few lines for its own help: what goes in, what comes out, an example
    /// Declares the options; must not touch a file. The function returned does the work, after a successful
    /// parse.
    std::function<ExitCode()> (*attach)(Options& options) = nullptr;
};

[[nodiscard]] std::span<const Command* const> all_commands();

namespace commands {
#define COMMAND(name) extern const Command name;
#include "cli/commands.def"
#undef COMMAND
}  // namespace commands

}  // namespace ripplenotch
