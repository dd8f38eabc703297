// SPDX-License-Identifier: MIT
#include "cli/reference/reference.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

#include "cli/options/options_implementation.hpp"
#include "ripplenotch/core/error.hpp"

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

const std::string& OptionEntry::longest_name() const {
    return *std::max_element(names.begin(), names.end(),
                             [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
}

Reference reference_of(const CLI::App& app) {
    Reference reference{option_entry(app), {}};
    for (const CLI::App* command : app.get_subcommands({}))
        reference.commands.push_back(option_entry(*command));
    return reference;
}

std::string generated(const Reference& reference, std::string_view kind) {
    constexpr std::string_view page_of = "man-";
    if (kind == "man") return man_page(reference, nullptr);
    if (kind == "complete-bash") return bash_completion(reference);
    if (kind == "complete-zsh") return zsh_completion(reference);
    if (kind == "complete-fish") return fish_completion(reference);
    for (const CommandEntry& command : reference.commands) {
        if (kind.starts_with(page_of) && kind.substr(page_of.size()) == command.name)
            return man_page(reference, &command);
    }
    raise<UsageError>("--generate {}: expected one of {}", kind, generated_kinds);
}

}  // namespace ripplenotch
