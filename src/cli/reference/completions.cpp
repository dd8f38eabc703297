// SPDX-License-Identifier: MIT
// For bash: commands, options, choices, and files where an option names one.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/reference/reference.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {

namespace {

std::vector<std::string> all_names(const CommandEntry& command) {
    std::vector<std::string> names;
    for (const OptionEntry& option : command.options) {
        if (!option.is_argument) names.insert(names.end(), option.names.begin(), option.names.end());
    }
    return names;
}

// What may stand behind an option, as a branch of `case`.
std::string values_branch(const OptionEntry& option) {
    const std::string names = fmt::format("{}", fmt::join(option.names, "|"));
    const auto choices = option.choices();
    if (!choices.empty())
        return fmt::format("                {}) COMPREPLY=($(compgen -W \"{}\" -- \"$word\")); return ;;\n",
                           names, fmt::join(choices, " "));
    if (option.names_file())
        return fmt::format("                {}) COMPREPLY=($(compgen -f -- \"$word\")); return ;;\n", names);
    return fmt::format("                {}) return ;;\n", names);
}

std::string command_branch(const CommandEntry& command) {
    std::string values;
    for (const OptionEntry& option : command.options) {
        if (!option.is_argument && option.takes_value()) values += values_branch(option);
    }
    return fmt::format(
        "        {})\n            case $before in\n{}            esac\n            options=\"{}\"\n"
        "            ;;\n",
        command.name, values, fmt::join(all_names(command), " "));
}

}  // namespace

std::string bash_completion(const Reference& reference) {
    std::string branches;
    std::vector<std::string> names;
    for (const CommandEntry& command : reference.commands) {
        branches += command_branch(command);
        names.push_back(command.name);
    }
    return fmt::format(
        "# bash completion of {0}, made by: {0} --generate complete-bash\n"
        "_{0}() {{\n"
        "    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} options\n"
        "    COMPREPLY=()\n"
        "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
        "        COMPREPLY=($(compgen -W \"{1} {2}\" -- \"$word\"))\n"
        "        return\n"
        "    fi\n"
        "    case ${{COMP_WORDS[1]}} in\n{3}"
        "        *) return ;;\n"
        "    esac\n"
        "    if [[ $word == -* ]]; then\n"
        "        COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
        "    else\n"
        "        COMPREPLY=($(compgen -f -- \"$word\"))\n"
        "    fi\n"
        "}}\n"
        "complete -o filenames -F _{0} {0}\n",
        tool_name, fmt::join(names, " "), fmt::join(all_names(reference.program), " "), branches);
}

}  // namespace ripplenotch
