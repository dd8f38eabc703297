// SPDX-License-Identifier: MIT
// Man pages in the man macros of troff: man(7).

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

#include "cli/reference/reference.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/version.hpp"

namespace ripplenotch {
namespace {

struct ExitWords {
    ExitCode code;
    std::string_view words;
};
constexpr std::array exit_words = {
    ExitWords{ExitCode::done, "done; an honest \"nothing found\" included"},
    ExitWords{ExitCode::limit_violated, "a limit or check that the caller set is violated"},
    ExitWords{ExitCode::usage, "usage: an option or a specification is wrong"},
    ExitWords{ExitCode::data, "bad or ambiguous input data; the message names the place and the remedy"},
    ExitWords{ExitCode::file, "a file cannot be read, written or replaced, or changed while it was read"},
    ExitWords{ExitCode::inconclusive, "not conclusive, where the caller asked to be told"},
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

// Text as it flows; a line with an example stands by itself.
std::string paragraphs(const std::string& text) {
    std::string page;
    std::istringstream lines(text);
    bool after_example = false;
    for (std::string line; std::getline(lines, line);) {
        const bool example = line.starts_with("Example");
        if (example || after_example) page += ".PP\n";
        page += plain_roff(line) + "\n";
        after_example = example;
    }
    return page;
}

std::string argument_in_synopsis(const OptionEntry& argument) {
    const std::string name = slanted(argument.names.front()) + (argument.repeats ? "..." : "");
    return argument.required ? name : "[" + name + "]";
}

std::string option_item(const OptionEntry& option) {
    std::string head;
    for (const std::string& name : option.names)
        head += (head.empty() ? "" : ", ") + (option.is_argument ? slanted(name) : bold(name));
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
            slanted("ARGUMENT") + "...]\n.SH DESCRIPTION\n" + paragraphs(reference.program.description) +
            ".SH COMMANDS\n";
    for (const CommandEntry& command : reference.commands)
        page += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", plain_roff(page_name(&command)),
                            plain_roff(command.summary));
    return page + options_section(reference.program, false) + exit_section();
}

}  // namespace

std::string man_page(const Reference& reference, const CommandEntry* command) {
    if (command == nullptr) return program_page(reference);
    std::string page = head(command, command->summary);
    page += bold(fmt::format("{} {}", tool_name, command->name)) + " [" + slanted("OPTION") + "...]";
    for (const OptionEntry& option : command->options)
        if (option.is_argument) page += " " + argument_in_synopsis(option);
    page += "\n.SH DESCRIPTION\n" + paragraphs(command->description);
    page += options_section(*command, true) + options_section(*command, false) + exit_section();
    return page + fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", tool_name);
}

}  // namespace ripplenotch
