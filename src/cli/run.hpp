// SPDX-License-Identifier: MIT
#pragma once
// Command lines as words without the program's name, for main() and for commands that run others.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

using CommandWords = std::vector<std::string>;

/// Prints "ripplenotch identify: message" on standard error, and returns the code.
ExitCode complain(ExitCode code, std::string_view command, std::string_view message);

/// Runs the command that the words name, or prints the help or the version that they ask for; the command's
/// name goes to `running` as soon as it is known. Throws Error.
ExitCode run_command(const CommandWords& words, std::string& running);

/// The same as part of another command or program: without a progress bar of its own.
ExitCode run_within(const CommandWords& words);

class Options;

/// Reads words that are nothing but the options which `declare` declares; refusals name the command, whose
/// help explains them. Throws UsageError.
void parse_options(const std::string& of_command, CommandWords words,
                   const std::function<void(Options&)>& declare);

}  // namespace ripplenotch
