// SPDX-License-Identifier: MIT
#include "cli/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <cstdio>

#include "cli/options_implementation.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/version.hpp"

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

std::string shell_quoted(const std::string& word) {
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
               std::string_view("-_=./:,@+%").find(c) != std::string_view::npos;
    };
    if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::vector<std::string> split_commas(const std::string& text) {
    std::vector<std::string> pieces(1);
    for (const char c : text) {
        if (c == ',') {
            pieces.emplace_back();
        } else {
            pieces.back() += c;
        }
    }
    return pieces;
}

}  // namespace

void Options::flag(std::string_view names, bool& target, std::string_view help) {
    implementation_.command->add_flag(owned(names), target, owned(help));
}

void Options::text(std::string_view names, std::string& target, std::string_view type_name,
                   std::string_view help) {
    CLI::Option* option =
        single(implementation_.command->add_option(owned(names), target, owned(help)), type_name);
    if (!target.empty()) option->default_str(target);
}

void Options::text(std::string_view names, std::optional<std::string>& target, std::string_view type_name,
                   std::string_view help) {
    single(implementation_.command->add_option_function<std::string>(
               owned(names), [&target](const std::string& value) { target = value; }, owned(help)),
           type_name);
}

void Options::texts(std::string_view names, std::vector<std::string>& target, std::string_view type_name,
                    std::string_view help) {
    implementation_.command->add_option(owned(names), target, owned(help))
        ->type_name(owned(type_name))
        ->allow_extra_args(false);
}

void Options::choice(std::string_view names, std::string& target, std::span<const std::string_view> choices,
                     std::string_view help) {
    const std::vector<std::string> allowed(choices.begin(), choices.end());
    CLI::Option* option = single(implementation_.command->add_option(owned(names), target, owned(help)),
                                 fmt::format("{}", fmt::join(choices, "|")));
    option->check([allowed, option](const std::string& value) {
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
                                     owned(names),
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

void Options::numbers(std::string_view names, std::vector<double>& target, Dimension dimension,
                      std::string_view help) {
    const std::string label = owned(names);
    single(implementation_.command->add_option_function<std::string>(
               owned(names),
               [&target, dimension, label](const std::string& value) {
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
}

void Options::arguments(std::string_view name, std::vector<std::string>& target, bool required,
                        std::string_view help) {
    implementation_.command->add_option(owned(name), target, owned(help))->required(required)->type_name("");
}

std::string Options::command_line() const {
    std::string line = owned(tool_name);
    const auto& words = implementation_.words;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "-o" || words[i] == "--output" || words[i] == "--plot") {
            ++i;
        } else if (words[i].rfind("--output=", 0) != 0 && words[i].rfind("--plot=", 0) != 0 && words[i] != "--force" && words[i] != "-q" &&
                   words[i] != "--quiet" && words[i] != "-v" && words[i] != "--verbose" &&
                   words[i] != "--json") {
            line += " " + shell_quoted(words[i]);
        }
    }
    return line;
}

void attach_common(Options& options, CommonOptions& common) {
    options.text("-o,--output", common.output, "FILE", "where the result goes; - is standard output");
    options.flag("--json", common.json, "one JSON object instead of text");
    options.flag("--force", common.force, "overwrite existing files");
    options.flag("-q,--quiet", common.quiet, "no warnings on standard error");
    options.flag("-v,--verbose", common.verbose, "say on standard error what was decided");
}

void attach_log(Options& options, LogOptions& log) {
    options.text("--format", log.format, "NAME",
                 "format of the log: csv, npy (default: found out from its first bytes)");
    options.quantity("--sample-rate", log.sample_rate, Dimension::frequency,
                     "rate of a log without time; overrides the log's own time");
    attach_log_columns(options, log);
}

void attach_log_columns(Options& options, LogOptions& log) {
    options.text("--joint", log.joint, "NAME",
                 "which joint of a file that holds several; all runs each where possible");
    options.text(
        "--columns", log.columns, "LIST",
        "what the columns are: by place 'time,velocity,torque' (- skips one), or by name 'torque=tau_J'");
    options.texts("--unit", log.units, "COLUMN=UNIT",
                  "unit of a column: velocity=rad/s, torque=mNm, time=ms; repeatable");
    options.text("--delimiter", log.delimiter, "CHAR", "between cells of a text log: , ; space or tab");
    options.text("--decimal", log.decimal, "MARK", "decimal mark of a text log: . or ,");
    options.flag("--no-header", log.no_header, "the first row of a text log is data");
    options.text("--kt", log.kt, "Nm/A", "torque constant, for logs of motor current");
    options.flag("--hold-bad-values", log.hold_bad_values,
                 "replace empty cells and nan by the value before, and count them");
}

ReadOptions LogOptions::resolve() const {
    ReadOptions read;
    read.format = format;
    read.joint = joint;
    if (columns) read.columns = split_commas(*columns);
    for (const std::string& entry : units) {
        for (const std::string& piece : split_commas(entry)) {
            const std::size_t equals = piece.find('=');
            if (equals == std::string::npos || equals == 0 || equals + 1 == piece.size()) {
                raise<UsageError>("--unit: '{}' is not COLUMN=UNIT, for example velocity=rad/s", piece);
            }
            read.units[piece.substr(0, equals)] = piece.substr(equals + 1);
        }
    }
    read.sample_rate = sample_rate;
    if (sample_rate && !(sample_rate->value() > 0.0)) raise<UsageError>("--sample-rate: must be above 0 Hz");
    const auto one_character = [](const std::string& text, std::string_view option) {
        if (text == "space") return ' ';
        if (text == "tab" || text == "\\t") return '\t';
        if (text.size() != 1) raise<UsageError>("{}: '{}' is not one character", option, text);
        return text.front();
    };
    if (delimiter) read.delimiter = one_character(*delimiter, "--delimiter");
    if (decimal) {
        read.decimal_mark = one_character(*decimal, "--decimal");
        if (*read.decimal_mark != '.' && *read.decimal_mark != ',') {
            raise<UsageError>("--decimal: '{}' is neither . nor ,", *decimal);
        }
    }
    if (no_header) read.header = false;
    if (kt) {
        std::string text = *kt;
        if (text.size() > 4 && text.compare(text.size() - 4, 4, "Nm/A") == 0) text.resize(text.size() - 4);
        read.nm_per_ampere = parse_quantity(text, Dimension::none, "--kt");
    }
    read.hold_bad_values = hold_bad_values;
    return read;
}

void say_warnings(const CommonOptions& common, std::span<const std::string> warnings) {
    if (common.quiet) return;
    Progress::current().step_aside();
    for (const std::string& warning : warnings) fmt::print(stderr, "{}: warning: {}\n", tool_name, warning);
}

void say(const CommonOptions& common, std::string_view sentence) {
    Progress::current().step_aside();
    if (common.verbose && !common.quiet) fmt::print(stderr, "{}: {}\n", tool_name, sentence);
}

void say_layout(const CommonOptions& common, const Layout& layout) {
    say(common, fmt::format("{}: read as if with {}", layout.source, layout.options));
    say_warnings(common, layout.warnings);
}

}  // namespace ripplenotch
