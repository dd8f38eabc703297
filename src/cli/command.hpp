// SPDX-License-Identifier: MIT
#pragma once
// A command is a record: one folder in src/cli, one line in commands.def. It gives an answer, made once and
// in memory: give() writes it where the command line says; `report` and the Python module take of it what
// they need.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

struct Answer {
    /// How the text is written: for people, made visible; rows of CSV, whose place a figure in the terminal
    /// takes; byte for byte.
    enum class Text { words, rows, bytes };
    /// A file of its own option (--metrics, --improved-model): `said` with -v when it is written.
    struct File {
        std::string path, text, said;
    };

    std::string text = {};
    Text kind = Text::words;
    std::function<std::string()> document = {};  ///< the same as JSON
    std::function<Figure()> figure = {};         ///< --plot
    Provenance provenance = {};                  ///< what the data of the figure tell of their origin
    ExitCode code = ExitCode::done;
    /// A log that was computed, written in place of the text in this format; of filter, whose answer is asked
    /// for in memory, its torque.
    std::vector<NumberColumn> columns = {};
    const LogFormat* format = nullptr;
    /// -o has something else (a log, exported code): text and document go to standard output.
    bool own_output = false;
    std::vector<File> files = {};
    std::vector<std::string> complaints = {};  ///< lines on standard error when all is written
    std::string joint = {};                    ///< that it is about, where the log names it
    /// Of several joints, each by itself; text, document and code are of all of them.
    std::vector<Answer> joints = {};
    std::shared_ptr<const void> request = {};  ///< what its functions refer to
};

/// --plot FILE.
void attach_plot(Options& options, CommonOptions& common);

/// Writes files, document or text, and draws. {joint} in a name: each joint has a file of its own. Without
/// gnuplot the data of a picture are written beside where it would be, and FileError is thrown.
ExitCode give(const Answer& answer, const CommonOptions& common);

struct Command {
    std::string_view name;
    std::string_view summary;      ///< one line, for the list of commands
    std::string_view description;  ///< a few lines for its own help: what goes in, what comes out, an example
    /// Declares the options; must not touch a file. The function returned gives the answer, after a
    /// successful parse, and writes nothing but what is too long to be held: a filtered log.
    std::function<Answer()> (*attach)(Options& options) = nullptr;
};

[[nodiscard]] std::span<const Command* const> all_commands();

namespace commands {
#define COMMAND(name) extern const Command name;
#include "cli/commands.def"
#undef COMMAND
}  // namespace commands

// Command lines as words without the program's name.

using CommandWords = std::vector<std::string>;

/// Prints "ripplenotch identify: message" on standard error, and returns the code.
ExitCode complain(ExitCode code, std::string_view command, std::string_view message);

/// Runs the command that the words name, or prints the help or the version that they ask for; the command's
/// name goes to `running` as soon as it is known. Throws Error.
ExitCode run_command(const CommandWords& words, std::string& running);

/// The same as part of another program: without a progress bar of its own.
ExitCode run_within(const CommandWords& words);

/// The answer of the command, in memory: nothing is written, wherever its words say that it should go.
[[nodiscard]] Answer ask(const CommandWords& words);

/// The data of its figure, as JSON. Throws UsageError where the command draws none.
[[nodiscard]] std::string figure_data(const Answer& answer);

/// Reads words that are nothing but the options which `declare` declares; refusals name the command, whose
/// help explains them. Throws UsageError.
void parse_options(const std::string& of_command, CommandWords words,
                   const std::function<void(Options&)>& declare);

}  // namespace ripplenotch
