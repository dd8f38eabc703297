// SPDX-License-Identifier: MIT
// For bash: commands, options, choices, and files where an option names one.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/reference/reference.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {

namespace {

// For fish, one line an option.

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

namespace {

// For zsh, by its _arguments.

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
