// SPDX-License-Identifier: MIT
#pragma once
// What every command and option is, as declared: the one source of --help, man pages and completions.

#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace ripplenotch {

struct OptionEntry {
    std::vector<std::string> names;  ///< "-o", "--output"; of an argument "LOG"
    std::string type;                ///< "FILE", "deg/s"; empty: the option is a flag, or an argument
    std::string default_text, help;
    bool is_argument = false, required = false, repeats = false;

    /// "automatic", "steady", ... of an option that takes one of them.
    [[nodiscard]] std::vector<std::string> choices() const;
    [[nodiscard]] bool names_file() const;
    [[nodiscard]] bool takes_value() const { return !type.empty(); }
};

struct CommandEntry {
    std::string name, summary, description;
    std::vector<OptionEntry> options;
};

struct Reference {
    CommandEntry program;
    std::vector<CommandEntry> commands;
};

/// Of an app whose commands have all declared their options.
[[nodiscard]] Reference reference_of(const CLI::App& app);

/// What --generate prints, for the ending of a message: "man, man-COMMAND, complete-bash, catalogue".
inline constexpr std::string_view generated_kinds = "man, man-COMMAND, complete-bash, catalogue";

/// A man page ("man", "man-identify"), the completion for bash ("complete-bash") or the catalogue. Throws
/// UsageError for a kind that there is not.
[[nodiscard]] std::string generated(const Reference& reference, std::string_view kind);

/// Schema ripplenotch/catalogue/1: commands with their options, methods, export targets, effects, formats of
/// logs and units, each as declared.
[[nodiscard]] std::string catalogue_text(const Reference& reference);

}  // namespace ripplenotch
