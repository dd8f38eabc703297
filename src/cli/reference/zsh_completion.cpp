// SPDX-License-Identifier: MIT
// For zsh, by its _arguments.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/reference/reference.hpp"
#include "ripplenotch/core/version.hpp"

namespace ripplenotch {
namespace {

// Within single quotes, and where a mark would end a part of a specification.
std::string escaped_in_quotes(std::string_view text, std::string_view marks) {
    std::string safe;
    for (const char c : text) {
        if (c == '\'') {
            safe += "'\\''";
        } else if (c == '\\' || marks.find(c) != std::string_view::npos) {
            safe += {'\\', c};
        } else {
            safe += c;
        }
    }
    return safe;
}

std::string action_of(const OptionEntry& option) {
    const auto choices = option.choices();
    if (!choices.empty()) return fmt::format("({})", fmt::join(choices, " "));
    return option.names_file() ? "_files" : "";
}

std::string specification(const OptionEntry& option) {
    if (option.is_argument)
        return fmt::format("'{}:{}:{}'", option.repeats ? "*" : "",
                           escaped_in_quotes(option.longest_name(), ":[]"),
                           option.names_file() ? "_files" : "");
    std::string lines;
    for (const std::string& name : option.names) {
        // The other names of an option that was given are not offered.
        const std::string others = option.repeats ? "*" : fmt::format("({})", fmt::join(option.names, " "));
        lines += fmt::format("{}'{}{}[{}]", lines.empty() ? "" : " \\\n            ", others, name,
                             escaped_in_quotes(option.help, "[]:"));
        if (option.takes_value())
            lines += fmt::format(":{}:{}", escaped_in_quotes(option.type, "[]:"), action_of(option));
        lines += "'";
    }
    return lines;
}

std::string arguments_of(const CommandEntry& command) {
    std::string lines = "_arguments";
    for (const OptionEntry& option : command.options) lines += " \\\n            " + specification(option);
    return lines;
}

}  // namespace

std::string zsh_completion(const Reference& reference) {
    std::string names, branches;
    for (const CommandEntry& command : reference.commands) {
        names += fmt::format("        '{}:{}'\n", command.name, escaped_in_quotes(command.summary, ":"));
        branches +=
            fmt::format("        {})\n            {}\n            ;;\n", command.name, arguments_of(command));
    }
    return fmt::format(
        "#compdef {0}\n"
        "# zsh completion of {0}, made by: {0} --generate complete-zsh\n"
        "_{0}() {{\n"
        "    local -a commands=(\n{1}    )\n"
        "    if (( CURRENT == 2 )); then\n"
        "        _describe command commands\n"
        "        {2}\n"
        "        return\n"
        "    fi\n"
        "    local command=${{words[2]}}\n"
        "    shift words\n"
        "    (( CURRENT-- ))\n"
        "    case $command in\n{3}    esac\n"
        "}}\n"
        "_{0} \"$@\"\n",
        tool_name, names, arguments_of(reference.program), branches);
}

}  // namespace ripplenotch
