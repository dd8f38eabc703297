// SPDX-License-Identifier: MIT
#pragma once
// Shared by options.cpp, run.cpp and reference.cpp only: the parsing library behind Options, and what is
// wrong with a command line that it cannot tell.

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/options/options.hpp"

namespace ripplenotch {

struct Options::Implementation {
    CLI::App* command = nullptr;
    std::vector<std::string> words;  ///< the command line after the program's name
    std::vector<std::function<void()>> after_parse = {};
    /// "--q" -> "--quality": what stands on the command line, and what CLI11 knows it as. CLI11 from 2.2 on
    /// takes a long name of one letter for the short name too, so that `--q` would be refused beside `-q`.
    std::map<std::string, std::string> spelled_out = {};
    /// What -o was before, and whether it was used (Options::was_output).
    std::string was_output = {};
    bool* old_output = nullptr;

    /// Options and arguments that name files, which are read, and those among them that are written.
    std::vector<std::string> files = {};
    std::set<std::string> written = {};
    CommonOptions* common = nullptr;  ///< how the answer is written
    /// Throws UsageError where files collide, FileError where one that is written exists and may
    /// not be overwritten: before any work is done.
    void check_files() const;

    /// The names for CLI11: "--quality" of "--quality,--q", which goes to `spelled_out`.
    [[nodiscard]] std::string names_for_parser(std::string_view names);
    /// Rewrites the options before "--" as CLI11 knows them; -o as what it was before.
    void spell_out(std::vector<std::string>& command_line) const;
};

/// A file, or a specification with files in it ("switching,table=table.json"), and what has it: "LOG", "-o".
struct NamedFile {
    std::string text, as;
};
/// Throws UsageError where one file is written twice, or written and read; each value of a key of what is
/// read may be a file. Pipes ("-") and what is no file (/dev/null, a folder) collide with nothing.
void refuse_collisions(std::span<const NamedFile> read, std::span<const NamedFile> written);

/// Throws UsageError with the list as it should be when `text` is one with other marks: "1 2", "1:2", "1, 2".
void refuse_other_marks(const std::string& option, const std::string& text, Dimension dimension);

/// The same for "--orders 1 2" among the words of a command line, whose second number would be taken for the
/// name of a log. A file of that name is one.
void refuse_split_list(const std::vector<std::string>& words, const std::string& option, Dimension dimension);

}  // namespace ripplenotch
