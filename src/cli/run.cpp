// SPDX-License-Identifier: MIT
// Parses a command line and runs the command that it names.
#include "cli/command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>

#include "cli/options/options_implementation.hpp"
#include "cli/reference/reference.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

ExitCode complain(ExitCode code, std::string_view command, std::string_view message) {
    talk(fmt::format("{}{}{}: {}", tool_name, command.empty() ? "" : " ", command, message));
    return code;
}

namespace {

std::vector<std::string> command_names() {
    std::vector<std::string> names;
    for (const Command* command : all_commands()) names.emplace_back(command->name);
    return names;
}

bool is_command(std::string_view word) {
    const auto commands = all_commands();
    return std::any_of(commands.begin(), commands.end(),
                       [&](const Command* command) { return command->name == word; });
}

// CLI11 answers a mistyped command with "A subcommand is required"; people want to know which one they meant.
[[noreturn]] void refuse_unknown_command(const std::string& word) {
    const auto names = command_names();
    std::error_code failed;
    if (std::filesystem::is_regular_file(word, failed))
        raise<UsageError>(
            "there is no command '{}'; for a log, {} report {} -o page.html shows what is in it and which "
            "filter it needs",
            word, tool_name, word);
    raise<UsageError>("there is no command '{}'{}; commands: {}", word, did_you_mean(word, names),
                      fmt::join(names, ", "));
}

// CLI11 checks that required arguments are there before it looks at unknown options, and would answer a
// mistyped option with "LOG is required".
std::optional<std::string> unknown_option(const CLI::App& command, const CommandWords& words) {
    for (const std::string& word : words) {
        if (word == "--") break;
        const std::string name = word.substr(0, word.find('='));
        if (name.size() < 3 || name.compare(0, 2, "--") != 0) continue;
        if (command.get_option_no_throw(name) == nullptr) return name;
    }
    return std::nullopt;
}

void refuse_unknown_option(const CLI::App& command, const CommandWords& words) {
    const auto name = unknown_option(command, words);
    if (!name) return;
    std::vector<std::string> known;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& long_name : option->get_lnames()) known.push_back("--" + long_name);
    }
    const std::string of = command.get_parent() == nullptr ? "" : command.get_name() + " ";
    raise<UsageError>("there is no option {}{}{}; see {} {}--help", *name,
                      of.empty() ? " before a command" : "", did_you_mean(*name, known), tool_name, of);
}

// The option of one value that came with several, if there is one.
std::optional<std::string> given_twice(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_multi_option_policy() == CLI::MultiOptionPolicy::Throw &&
            option->get_expected_max() == 1 && option->results().size() > 1)
            return option->get_name();
    }
    return std::nullopt;
}

/// A command line that is understood: what the parsing library and the answer refer to.
struct Run {
    CLI::App app{"Torque ripple of harmonic drives in joint logs: find it, filter it, measure the cost.",
                 std::string(tool_name)};
    std::vector<std::unique_ptr<Options::Implementation>> implementations;
    std::vector<std::unique_ptr<Options>> options;
    std::function<Answer()> work;
    CommonOptions of_help;
    CommonOptions* common = &of_help;  ///< how the answer is written
};

// "help identify", "help effects", "help --json" and "version", as people type them elsewhere.
CommandWords in_our_words(CommandWords words) {
    if (words.empty() || is_command(words.front())) return words;
    if (words.front() == "help" && words.size() == 2 && words[1] == "effects")
        return {"diagnose", "--effects"};
    if (words.front() == "help" && words.size() == 2 && words[1] == "--json")
        return {"--generate", "catalogue"};
    if (words.front() == "version") words.front() = "--version";
    if (words.front() != "help") return words;
    words.erase(words.begin());
    words.insert(words.empty() ? words.end() : words.begin() + 1, "--help");
    return words;
}

// "--generate man": what is asked for; it needs the options of all commands.
std::optional<std::string> kind_to_generate(const CommandWords& words) {
    constexpr std::string_view option = "--generate";
    if (words.size() == 2 && words.front() == option) return words.back();
    if (words.size() == 1 && words.front().starts_with(fmt::format("{}=", option)))
        return words.front().substr(option.size() + 1);
    return std::nullopt;
}

void declare_program(CLI::App& app) {
    app.set_version_flag("-V,--version", fmt::format("{} {}", tool_name, version()),
                         "print the version and end");
    app.set_help_flag("-h,--help", "print this help and end");
    app.add_option_function<std::string>(
           "--generate", [](const std::string& /*kind*/) {},
           fmt::format("print a man page, the completion for bash, or all that has a name as JSON: {}",
                       generated_kinds))
        ->type_name("KIND");
    app.footer(
        "Begin with: ripplenotch report LOG -o page.html\nEach command explains itself: ripplenotch COMMAND "
        "--help, or --help-all. A LOG of - is standard input.");
    app.require_subcommand(1);
}

constexpr std::string_view whole_help = "--help-all";

// By what they are for, as `--help` lists them; commands.def has them in this order.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> command_groups = {
    {{"identify", "Look at a log"},
     {"export", "Filter it"},
     {"diagnose", "Model the joint"},
     {"trend", "Fleets"},
     {"report", "Report"}}};

// What `--help` shows: a screen of 40 lines of 100 columns. Each option has the first clause of its
// description, and those of a form of the command ("--track: ...") are left to `--help-all`. The library
// hides options by taking their names away, which command lines that are printed need.
class ShortHelp : public CLI::Formatter {
  public:
    ShortHelp() { column_width(help_column); }
    std::string make_group(std::string group, bool is_positional,
                           std::vector<const CLI::Option*> options) const override {
        if (group == reading_group) return "";
        std::erase_if(options, [](const CLI::Option* option) {
            return option->check_name("--help") || option->get_description().rfind("--", 0) == 0;
        });
        return CLI::Formatter::make_group(group, is_positional, options);
    }
    std::string make_option_desc(const CLI::Option* option) const override {
        constexpr std::size_t room = 100 - help_column;
        const std::string& whole = option->get_description();
        std::string first = whole.substr(0, whole.find("; "));
        const auto is_open = [&] {
            return std::count(first.begin(), first.end(), '(') > std::count(first.begin(), first.end(), ')');
        };
        while (first.size() > room || is_open()) {
            const std::size_t end = first.find_last_of(is_open() ? "(" : ",:(", first.size() - 2);
            if (end == std::string::npos || end < shortest_clause) break;
            first.resize(first[end - 1] == ' ' ? end - 1 : end);
        }
        return first;
    }
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
        std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
        for (std::size_t at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n"))
            text.erase(at, 1);
        return text;
    }

  private:
    static constexpr std::size_t help_column = 40, shortest_clause = 14;
};

// How a log is read fills half a page, which is shown only where it is asked for.
void shorten_help(CLI::App& command) {
    const auto options = command.get_options();
    const bool reads = std::any_of(options.begin(), options.end(), [](const CLI::Option* option) {
        return option->get_group() == reading_group;
    });
    command.formatter(std::make_shared<ShortHelp>());
    command.footer(fmt::format(
        "{}: {} {} {}\n\n{}",
        reads ? "How the log is read (--columns, --unit, --joint, ...), and all else" : "All of each option",
        tool_name, command.get_name(), whole_help, command.get_footer()));
}

// The options of all commands, or of those that the words name.
void declare(Run& run, const CommandWords& words, bool all, bool whole, std::string& running) {
    const bool named_first = !words.empty() && is_command(words.front());
    const auto* group = command_groups.begin();
    for (const Command* command : all_commands()) {
        // Declaring the options of every command takes longer than filtering ten thousand rows.
        if (named_first && words.front() != command->name) continue;
        CLI::App* sub = run.app.add_subcommand(std::string(command->name), std::string(command->summary));
        sub->footer(std::string(command->description));
        sub->group(std::string(group->second));
        if (group->first == command->name) ++group;
        if (!all && std::find(words.begin(), words.end(), command->name) == words.end()) continue;
        run.implementations.push_back(
            std::make_unique<Options::Implementation>(Options::Implementation{sub, words}));
        run.options.push_back(std::make_unique<Options>(*run.implementations.back()));
        sub->callback([&running, &run, command, work = command->attach(*run.options.back()),
                       &parsed = *run.implementations.back()] {
            run.work = work;
            running = command->name;
            for (const auto& check : parsed.after_parse) check();
            parsed.check_files();
            if (parsed.common != nullptr) run.common = parsed.common;
        });
        if (!whole) shorten_help(*sub);
    }
}

// A word that is not understood would leave vectors on in silence.
void check_environment() {
    for (const char* const name : {"RIPPLENOTCH_SYNC", "RIPPLENOTCH_VECTORS"}) {
        const char* const value = std::getenv(name);
        if (value != nullptr && *value != '\0' && std::string_view(value) != "none")
            raise<UsageError>("{}={}: it is none, or not set at all", name, value);
    }
}

/// What the parsing library refuses, in our words.
UsageError refusal(const CLI::ParseError& error, const std::string& running) {
    return UsageError(
        fmt::format("{}; see {} {}--help", error.what(), tool_name, running.empty() ? "" : running + " "));
}

// Throws what goes wrong, in declaring options too: which names clash depends on the version of the library.
void parse(Run& run, CommandWords words, std::string& running) {
    CLI::App& app = run.app;
    words = in_our_words(std::move(words));
    const bool whole = std::find(words.begin(), words.end(), whole_help) != words.end();
    std::replace(words.begin(), words.end(), std::string(whole_help), std::string("--help"));
    declare_program(app);
    const auto kind = kind_to_generate(words);
    const bool named_first = !words.empty() && is_command(words.front());
    if (named_first) running = words.front();
    declare(run, words, kind.has_value(), whole || kind, running);
    if (kind) {
        run.work = [text = generated(reference_of(app), *kind)] { return Answer{text}; };
        return;
    }
    if (words.empty()) {
        talk_lines(app.help());
        run.work = [] { return Answer{.code = ExitCode::usage}; };
        return;
    }
    for (const auto& implementation : run.implementations) implementation->spell_out(words);
    if (words.front().empty() || words.front().front() != '-') {
        if (!named_first) refuse_unknown_command(words.front());
        refuse_unknown_option(*app.get_subcommand(running), words);
    } else {
        refuse_unknown_option(app, {words.front()});
    }
    try {
        app.parse(CommandWords(words.rbegin(), words.rend()));  // the library wants the last word first
    } catch (const CLI::ArgumentMismatch&) {
        const auto twice = named_first ? given_twice(*app.get_subcommand(running)) : std::nullopt;
        if (!twice) throw;
        raise<UsageError>("{} is given more than once; see {} {} --help", *twice, tool_name, running);
    }
    check_environment();
    watch_inputs(true);
    hash_inputs(run.common->hashes);
}

std::shared_ptr<Run> parsed(const CommandWords& words, std::string& running) {
    const auto run = std::make_shared<Run>();
    try {
        try {
            parse(*run, words, running);
        } catch (const CLI::Success& request) {  // --help or --version
            std::ostringstream asked;
            run->app.exit(request, asked, asked);
            run->work = [text = asked.str()] { return Answer{text}; };
        }
    } catch (const CLI::ParseError& error) {
        throw refusal(error, running);
    }
    return run;
}

}  // namespace

ExitCode run_command(const CommandWords& words, std::string& running) {
    const auto run = parsed(words, running);
    const ProgressBar bar(words);  // gone before a complaint is printed
    return give(run->work(), *run->common);
}

ExitCode run_within(const CommandWords& words) {
    std::string running;
    const auto run = parsed(words, running);
    return give(run->work(), *run->common);
}

Answer ask(const CommandWords& words) {
    std::string running;
    const auto run = parsed(words, running);
    run->common->in_memory = true;
    Answer answer = run->work();
    answer.request = run;
    return answer;
}

void parse_options(const std::string& of_command, CommandWords words,
                   const std::function<void(Options&)>& declare) {
    CLI::App app;
    CLI::App& command = *app.add_subcommand(of_command);
    Options::Implementation implementation{&command, words};
    Options options(implementation);
    declare(options);
    implementation.spell_out(words);
    refuse_unknown_option(command, words);
    words.insert(words.begin(), of_command);
    try {
        app.parse(CommandWords(words.rbegin(), words.rend()));
    } catch (const CLI::ParseError& error) {
        throw refusal(error, of_command);
    }
    for (const auto& check : implementation.after_parse) check();
}

namespace {
constexpr const Command* const list[] = {
#define COMMAND(name) &commands::name,
#include "cli/commands.def"
#undef COMMAND
    nullptr,
};
}  // namespace

std::span<const Command* const> all_commands() { return {list, std::size(list) - 1}; }

}  // namespace ripplenotch
