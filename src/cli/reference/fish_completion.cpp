// SPDX-License-Identifier: MIT
// For fish, one line an option.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/reference/reference.hpp"
#include "ripplenotch/core/version.hpp"

namespace ripplenotch {
namespace {

std::string in_quotes(std::string_view text) {
    std::string safe = "'";
    for (const char c : text) {
        if (c == '\'' || c == '\\') safe += '\\';
        safe += c;
    }
    return safe + "'";
}

std::string option_line(const OptionEntry& option, std::string_view condition) {
    std::string line = fmt::format("complete -c {} -n {}", tool_name, in_quotes(condition));
    for (const std::string& name : option.names)
        line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    const auto choices = option.choices();
    if (!choices.empty()) {
        line += fmt::format(" -x -a {}", in_quotes(fmt::format("{}", fmt::join(choices, " "))));
    } else if (option.takes_value()) {
        line += option.names_file() ? " -r -F" : " -x";
    }
    return line + " -d " + in_quotes(option.help) + "\n";
}

}  // namespace

std::string fish_completion(const Reference& reference) {
    std::string script =
        fmt::format("# fish completion of {0}, made by: {0} --generate complete-fish\n", tool_name);
    for (const OptionEntry& option : reference.program.options)
        script += option_line(option, "__fish_use_subcommand");
    for (const CommandEntry& command : reference.commands)
        script += fmt::format("complete -c {} -f -n '__fish_use_subcommand' -a {} -d {}\n", tool_name,
                              command.name, in_quotes(command.summary));
    for (const CommandEntry& command : reference.commands) {
        for (const OptionEntry& option : command.options) {
            if (!option.is_argument)
                script += option_line(option, "__fish_seen_subcommand_from " + command.name);
        }
    }
    return script;
}

}  // namespace ripplenotch
