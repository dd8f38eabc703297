// SPDX-License-Identifier: MIT
#include "cli/options/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "cli/options/file_claims.hpp"
#include "cli/options/number_list.hpp"
#include "cli/options/options_implementation.hpp"
#include "cli/options/shell_word.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {
namespace {

std::string owned(std::string_view text) { return std::string(text); }

std::string unit_type_name(Dimension dimension) {
    const std::string_view unit = base_unit(dimension);
    return unit.empty() ? "NUMBER" : owned(unit);
}

// CLI11 lets an option of one value swallow positionals only when it may take several; these never do.
CLI::Option* single(CLI::Option* option, std::string_view type_name) {
    return option->type_name(owned(type_name))
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::Throw);
}

}  // namespace

std::string Options::Implementation::names_for_parser(std::string_view names) {
    std::vector<std::string> known, one_letter;
    for (const std::string& name : split_commas(owned(names))) {
        (name.size() == 3 && name.starts_with("--") ? one_letter : known).push_back(name);
    }
    for (const std::string& name : one_letter) spelled_out[name] = known.back();
    return fmt::format("{}", fmt::join(known, ","));
}

void Options::Implementation::spell_out(std::vector<std::string>& command_line) const {
    for (std::string& word : command_line) {
        if (word == "--") return;
        const std::size_t name_end = std::min(word.find('='), word.size());
        const auto entry = spelled_out.find(word.substr(0, name_end));
        if (entry != spelled_out.end()) word.replace(0, name_end, entry->second);
    }
}

void Options::flag(std::string_view names, bool& target, std::string_view help) {
    implementation_.command->add_flag(owned(names), target, owned(help));
}

void Options::text(std::string_view names, std::string& target, std::string_view type_name,
                   std::string_view help) {
    CLI::Option* option =
        single(implementation_.command->add_option(owned(names), target, owned(help)), type_name);
    if (!target.empty()) option->default_str(target);
    names_file(names, type_name, &target, [&target] { return std::vector{target}; });
}

void Options::text(std::string_view names, std::optional<std::string>& target, std::string_view type_name,
                   std::string_view help) {
    single(implementation_.command->add_option_function<std::string>(
               owned(names), [&target](const std::string& value) { target = value; }, owned(help)),
           type_name);
    names_file(names, type_name, &target,
               [&target] { return target ? std::vector{*target} : std::vector<std::string>{}; });
}

void Options::texts(std::string_view names, std::vector<std::string>& target, std::string_view type_name,
                    std::string_view help) {
    implementation_.command->add_option(owned(names), target, owned(help))
        ->type_name(owned(type_name))
        ->allow_extra_args(false);
    names_file(names, type_name, &target, [&target] { return target; });
}

void Options::choice(std::string_view names, std::string& target, std::span<const std::string_view> choices,
                     std::string_view help) {
    const std::vector<std::string> allowed(choices.begin(), choices.end());
    CLI::Option* option = single(implementation_.command->add_option(owned(names), target, owned(help)),
                                 fmt::format("{}", fmt::join(choices, "|")));
    option->check([allowed](const std::string& value) {
        if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return std::string();
        return fmt::format("'{}' is none of {}", value, fmt::join(allowed, ", "));
    });
    if (!target.empty()) option->default_str(target);
}

void Options::count(std::string_view names, int& target, int lowest, int highest, std::string_view help) {
    single(implementation_.command->add_option(owned(names), target, owned(help)), "INTEGER")
        ->check(CLI::Range(lowest, highest))
        ->default_str(std::to_string(target));
}

void Options::parsed_number(std::string_view names, Dimension dimension, std::string_view help,
                            double default_value, bool has_default, std::function<void(double)> assign) {
    const std::string label =
        owned(names.substr(names.rfind(',') == std::string_view::npos ? 0 : names.rfind(',') + 1));
    CLI::Option* option = single(implementation_.command->add_option_function<std::string>(
                                     implementation_.names_for_parser(names),
                                     [dimension, label, assign](const std::string& value) {
                                         assign(parse_quantity(value, dimension, label));
                                     },
                                     owned(help)),
                                 unit_type_name(dimension));
    if (has_default) option->default_str(shortest(default_value));
}

void Options::number(std::string_view names, double& target, Dimension dimension, std::string_view help) {
    parsed_number(names, dimension, help, target, true, [&target](double value) { target = value; });
}

void Options::number(std::string_view names, std::optional<double>& target, Dimension dimension,
                     std::string_view help) {
    parsed_number(names, dimension, help, 0.0, false, [&target](double value) { target = value; });
}

void Options::duration(std::string_view names, std::optional<Seconds>& target, std::string_view help) {
    const std::string label = owned(names);
    single(implementation_.command->add_option_function<std::string>(
               owned(names),
               [&target, label](const std::string& value) {
                   target = Seconds(parse_quantity(value, Dimension::time, label));
                   if (parse_number(value) && *target != Seconds(0.0))
                       raise<UsageError>("{0} {1}: ms or s? write {0} {1}ms or {0} {1}s", label, value);
               },
               owned(help)),
           "TIME");
}

void Options::numbers(std::string_view names, std::vector<double>& target, Dimension dimension,
                      std::string_view help) {
    const std::string label = owned(names);
    single(implementation_.command->add_option_function<std::string>(
               owned(names),
               [&target, dimension, label, &words = implementation_.words](const std::string& value) {
                   refuse_split_list(words, label, dimension);
                   if (value.find_first_of(" :;") != std::string::npos)
                       refuse_other_marks(label, value, dimension);
                   target.clear();
                   for (const std::string& piece : split_commas(value)) {
                       target.push_back(parse_quantity(piece, dimension, label));
                   }
               },
               owned(help)),
           unit_type_name(dimension) + ",...");
}

void Options::argument(std::string_view name, std::string& target, bool required, std::string_view help) {
    implementation_.command->add_option(owned(name), target, owned(help))->required(required)->type_name("");
    names_file(name, "LOG", &target, [&target] { return std::vector{target}; });
}

void Options::arguments(std::string_view name, std::vector<std::string>& target, bool required,
                        std::string_view help) {
    implementation_.command->add_option(owned(name), target, owned(help))->required(required)->type_name("");
    names_file(name, "LOG", &target, [&target] { return target; });
}

void Options::after_parse(std::function<void()> check) {
    implementation_.after_parse.push_back(std::move(check));
}

void Options::names_file(std::string_view names, std::string_view type_name, const void* target,
                         std::function<std::vector<std::string>()> values) {
    constexpr std::array types = {"FILE", "LOG", "OTHER", "SPEC", "NAME,KEY=VALUE,..."};
    if (std::find(types.begin(), types.end(), type_name) == types.end()) return;
    const std::string shown = owned(names.substr(0, names.find(',')));
    implementation_.files.push_back({shown, std::move(values), target});
}

void Options::writes(const void* target) { implementation_.written.push_back(target); }

void Options::Implementation::check_files() const {
    FileClaims claims;
    for (const FileOption& option : files) {
        const bool writes = std::find(written.begin(), written.end(), option.target) != written.end();
        for (const std::string& value : option.values())
            writes ? claims.writes(value, option.name) : claims.reads(value, option.name);
    }
    claims.check(command->get_option_no_throw("--in-place") != nullptr ? ", or say --in-place" : "");
}

namespace {

enum class Word { stays, goes, goes_with_the_next };

// Letters behind one dash: "-q", "-qv", "-oFILE", "-qo FILE".
Word letters(std::string_view word) {
    for (std::size_t i = 1; i < word.size(); ++i) {
        if (word[i] == 'o') return i + 1 == word.size() ? Word::goes_with_the_next : Word::goes;
        if (word[i] != 'q' && word[i] != 'v') return Word::stays;
    }
    return Word::goes;
}

// What says where a result goes and how much is told on the way is no part of how it was made.
Word in_command_line(std::string_view word) {
    if (word.size() < 2 || word.front() != '-') return Word::stays;
    if (word[1] != '-') return letters(word);
    for (const std::string_view flag : {"--force", "--no-sync", "--quiet", "--verbose", "--json"})
        if (word == flag) return Word::goes;
    for (const std::string_view option : {"--output", "--plot"}) {
        if (word == option) return Word::goes_with_the_next;
        if (word.starts_with(option) && word[option.size()] == '=') return Word::goes;
    }
    return Word::stays;
}

}  // namespace

std::string Options::command_name() const { return implementation_.command->get_name(); }

std::string Options::command_line() const {
    std::string line = owned(tool_name);
    const auto& words = implementation_.words;
    const auto options_end = std::find(words.begin(), words.end(), "--");
    for (auto word = words.begin(); word < options_end; ++word) {
        const Word what = in_command_line(*word);
        if (what == Word::stays) line += " " + shell_quoted(*word);
        if (what == Word::goes_with_the_next && word + 1 < options_end) ++word;
    }
    for (auto word = options_end; word != words.end(); ++word) line += " " + shell_quoted(*word);
    return line;
}

bool ends_with_json(std::string_view path) { return path.size() > 5 && path.ends_with(".json"); }

void attach_common(Options& options, CommonOptions& common, const OutputNames& names) {
    options.after_parse([&common, names] {
        if (!names.endings.empty()) {
            check_output_name(common.output, names.what, names.endings);
            if (common.json) check_output_name(common.output, "JSON", ".json .txt");
        }
        common.json = common.json || (names.json_is_option && ends_with_json(common.output));
    });
    options.text("-o,--output", common.output, "FILE", "where the result goes; - is standard output");
    options.writes(&common.output);
    options.flag("--json", common.json, "one JSON object instead of text");
    options.flag("--force", common.force, "overwrite existing files");
    options.flag("--no-sync", common.no_sync, "do not wait until written files are on the disk");
    options.flag("-q,--quiet", common.quiet, "no warnings on standard error");
    options.flag("-v,--verbose", common.verbose, "say on standard error what was decided");
}

void say_warnings(const CommonOptions& common, std::span<const std::string> warnings) {
    if (common.quiet) return;
    for (const std::string& warning : warnings) talk(fmt::format("{}: warning: {}", tool_name, warning));
}

void say_warnings(const CommonOptions& common, std::span<const LogWarning> warnings) {
    for (const LogWarning& warning : warnings) say_warnings(common, {&warning.text, 1});
}

void say(const CommonOptions& common, std::string_view sentence) {
    if (common.verbose && !common.quiet) talk(fmt::format("{}: {}", tool_name, sentence));
}

void say_layout(const CommonOptions& common, const Layout& layout) {
    say(common, fmt::format("{}: read as if with {}", layout.source, layout.options));
    if (layout.outside) say(common, fmt::format("{}: {}", layout.source, range_in_words(*layout.outside)));
    for (const Assumption& one : layout.inferences)
        say(common, fmt::format("{}: {} is {}: {}", layout.source, one.about, one.assumed, one.reason));
    say_warnings(common, layout.warnings);
}

}  // namespace ripplenotch
