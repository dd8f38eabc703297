// SPDX-License-Identifier: MIT
#include "cli/reference/reference.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

#include "cli/options/options_implementation.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

namespace {

OptionEntry option_entry(const CLI::Option& option) {
    OptionEntry entry;
    for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
    entry.is_argument = option.get_positional();
    if (entry.is_argument) entry.names.push_back(option.get_name(true));
    const bool is_flag = option.get_items_expected_max() == 0;
    // "INTEGER:INT in [0 - 9]": behind the colon the parsing library tells its check.
    if (!is_flag) entry.type = option.get_type_name().substr(0, option.get_type_name().find(":INT in "));
    entry.default_text = option.get_default_str();
    entry.help = option.get_description();
    entry.required = option.get_required();
    entry.repeats = !is_flag && option.get_expected_max() > 1;
    return entry;
}

CommandEntry option_entry(const CLI::App& app) {
    CommandEntry entry{app.get_name(), app.get_description(), app.get_footer(), {}};
    for (const CLI::Option* option : app.get_options()) entry.options.push_back(option_entry(*option));
    return entry;
}

}  // namespace

std::vector<std::string> OptionEntry::choices() const {
    std::vector<std::string> found;
    if (type.find('|') == std::string::npos) return found;
    std::istringstream words(type);
    for (std::string word; std::getline(words, word, '|');) {
        if (std::islower(static_cast<unsigned char>(word.front())) != 0) found.push_back(word);  // not NUMBER
    }
    return found;
}

bool OptionEntry::names_file() const {
    constexpr std::array<std::string_view, 6> files = {"FILE", "LOG", "OTHER", "JOINT", "TABLE", "RESULT"};
    const std::string& word = is_argument ? names.front() : type;
    return std::find(files.begin(), files.end(), word) != files.end();
}

Reference reference_of(const CLI::App& app) {
    Reference reference{option_entry(app), {}};
    for (const CLI::App* command : app.get_subcommands({}))
        reference.commands.push_back(option_entry(*command));
    return reference;
}

namespace {

// Man pages in the man macros of troff: man(7).

struct ExitWords {
    ExitCode code;
    std::string_view words;
};
constexpr std::array exit_words = {
    ExitWords{ExitCode::done, "done; an honest \"nothing found\" included"},
    ExitWords{ExitCode::limit_violated, "a limit or check that the caller set is violated"},
    ExitWords{ExitCode::usage, "usage: an option or a specification is wrong"},
    ExitWords{ExitCode::data, "bad or ambiguous input data; the message names the position and the remedy"},
    ExitWords{ExitCode::file, "a file cannot be read, written or replaced, or changed while it was read"},
    ExitWords{ExitCode::inconclusive, "not conclusive, where the caller asked for an exit code"},
    ExitWords{ExitCode::memory, "what was asked for takes more memory than there is"},
    ExitWords{ExitCode::internal, "a fault of the tool itself"},
};

// Backslashes and dashes as they are, and no line that troff takes for a request.
std::string plain_roff(std::string_view text) {
    std::string escaped;
    for (const char c : text) {
        const bool opens_line = escaped.empty() || escaped.back() == '\n';
        if (opens_line && (c == '.' || c == '\'')) escaped += "\\&";
        if (c == '\\') {
            escaped += "\\e";
        } else if (c == '-') {
            escaped += "\\-";
        } else {
            escaped += c;
        }
    }
    return escaped;
}

std::string bold(std::string_view text) { return "\\fB" + plain_roff(text) + "\\fR"; }
std::string slanted(std::string_view text) { return "\\fI" + plain_roff(text) + "\\fR"; }

std::string upper(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

// A description in two parts: text as it flows, and lines to be typed as they are.
struct Described {
    std::string text, examples;
};
Described described(const std::string& description) {
    Described parts;
    std::istringstream lines(description);
    bool goes_on = false;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t behind = line.find(": ripplenotch ");
        if (behind != std::string::npos) {
            std::string before = line.substr(0, behind);
            if (before.ends_with("Example")) before.erase(before.size() - std::string_view("Example").size());
            if (!before.empty()) parts.text += plain_roff(before) + "\n";
            line.erase(0, behind + 2);
        }
        goes_on = line.starts_with("ripplenotch ") || line.starts_with("cat ") ||
                  (goes_on && (line.starts_with("-") || line.starts_with(" ")));
        if (goes_on && line.starts_with("-")) parts.examples.insert(parts.examples.size() - 1, " \\e");
        (goes_on ? parts.examples : parts.text) += plain_roff(line) + "\n";
    }
    if (!parts.examples.empty()) parts.examples = ".SH EXAMPLES\n.nf\n" + parts.examples + ".fi\n";
    return parts;
}

std::string argument_in_synopsis(const OptionEntry& argument) {
    const std::string name = slanted(argument.names.front()) + (argument.repeats ? "..." : "");
    return argument.required ? name : "[" + name + "]";
}

std::string option_item(const OptionEntry& option) {
    std::string head = joined(option.names, ", ", option.is_argument ? slanted : bold);
    if (option.takes_value() && !option.is_argument) head += " " + slanted(option.type);
    std::string item = ".TP\n" + head + "\n" + plain_roff(option.help) + "\n";
    if (!option.default_text.empty() && option.takes_value() && !option.is_argument)
        item += fmt::format("[default: {}]\n", plain_roff(option.default_text));
    if (option.repeats && !option.is_argument) item += "May be given several times.\n";
    return item;
}

std::string options_section(const CommandEntry& command, bool arguments) {
    std::string items;
    for (const OptionEntry& option : command.options) {
        if (option.is_argument == arguments) items += option_item(option);
    }
    if (items.empty()) return items;
    return (arguments ? ".SH ARGUMENTS\n" : ".SH OPTIONS\n") + items;
}

std::string exit_section() {
    std::string section = ".SH EXIT STATUS\n";
    for (const ExitWords& one : exit_words)
        section += fmt::format(".TP\n\\fB{}\\fR\n{}\n", static_cast<int>(one.code), plain_roff(one.words));
    return section;
}

std::string page_name(const CommandEntry* command) {
    return std::string(tool_name) + (command == nullptr ? "" : "-" + command->name);
}

std::string head(const CommandEntry* command, std::string_view summary) {
    const std::string name = page_name(command);
    return fmt::format(".TH {} 1 \"\" \"{} {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n",
                       upper(plain_roff(name)), tool_name, version(), plain_roff(name), plain_roff(summary));
}

std::string program_page(const Reference& reference) {
    std::string page = head(nullptr, reference.program.summary);
    page += bold(tool_name) + " " + slanted("COMMAND") + " [" + slanted("OPTION") + "...] [" +
            slanted("ARGUMENT") + "...]\n.SH DESCRIPTION\n" + described(reference.program.description).text +
            ".SH COMMANDS\n";
    for (const CommandEntry& command : reference.commands)
        page += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", plain_roff(page_name(&command)),
                            plain_roff(command.summary));
    return page + options_section(reference.program, false) + exit_section();
}

// `command`: null for the program's own page.
std::string man_page(const Reference& reference, const CommandEntry* command) {
    if (command == nullptr) return program_page(reference);
    std::string page = head(command, command->summary);
    page += bold(fmt::format("{} {}", tool_name, command->name)) + " [" + slanted("OPTION") + "...]";
    for (const OptionEntry& option : command->options)
        if (option.is_argument) page += " " + argument_in_synopsis(option);
    const Described about = described(command->description);
    page += "\n.SH DESCRIPTION\n" + about.text + options_section(*command, true) +
            options_section(*command, false) + about.examples + exit_section();
    return page + fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", tool_name);
}

// For bash: commands, options, choices, and files where an option names one.

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
        "    case ${{COMP_WORDS[1]}} in\n{3}        *) return ;;\n"
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

}  // namespace

std::string generated(const Reference& reference, std::string_view kind) {
    constexpr std::string_view page_of = "man-";
    if (kind == "man") return man_page(reference, nullptr);
    if (kind == "complete-bash") return bash_completion(reference);
    if (kind == "catalogue") return catalogue_text(reference);
    for (const CommandEntry& command : reference.commands) {
        if (kind.starts_with(page_of) && kind.substr(page_of.size()) == command.name)
            return man_page(reference, &command);
    }
    raise<UsageError>("--generate {}: expected one of {}", kind, generated_kinds);
}

}  // namespace ripplenotch
