// SPDX-License-Identifier: MIT
#include "cli/options/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string>

#include "cli/options/options_implementation.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/log/format.hpp"

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
    for (const std::string_view name : split(names, ','))
        (name.size() == 3 && name.starts_with("--") ? one_letter : known).emplace_back(name);
    for (const std::string& name : one_letter) spelled_out[name] = known.back();
    return fmt::format("{}", fmt::join(known, ","));
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

// "-oFILE" as "--output=FILE", "-qo FILE" as "-q --output FILE".
void spell_output(std::vector<std::string>& words, std::size_t at) {
    const std::string word = words[at];
    if (word.size() < 2 || word[0] != '-' || word[1] == '-' || letters(word) == Word::stays) return;
    const std::size_t o = word.find('o');
    if (o == std::string::npos) return;
    words[at] = "--output" + (o + 1 < word.size() ? "=" + word.substr(o + 1) : "");
    if (o > 1) words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), word.substr(0, o));
}

}  // namespace

void Options::Implementation::spell_out(std::vector<std::string>& command_line) const {
    for (std::size_t i = 0; i < command_line.size() && command_line[i] != "--"; ++i) {
        if (old_output != nullptr) spell_output(command_line, i);
        std::string& word = command_line[i];
        const std::size_t name_end = std::min(word.find('='), word.size());
        const std::string name = word.substr(0, name_end);
        if (old_output != nullptr && name == "--output") {
            word.replace(0, name_end, was_output);
            *old_output = true;
        }
        const auto entry = spelled_out.find(name);
        if (entry != spelled_out.end()) word.replace(0, name_end, entry->second);
    }
}

bool Options::has(std::string_view name) const {
    return implementation_.command->get_option_no_throw(owned(name)) != nullptr;
}

void Options::flag(std::string_view names, bool& target, std::string_view help) {
    implementation_.command->add_flag(owned(names), target, owned(help));
}

void Options::flag(std::string_view names, std::function<void()> set, std::string_view help) {
    implementation_.command->add_flag_callback(owned(names), std::move(set), owned(help));
}

void Options::parsed(std::string_view names, std::function<void(const std::string&)> read,
                     std::string_view type_name, std::string_view help, bool repeats,
                     const std::string& standing) {
    CLI::App& command = *implementation_.command;
    names_file(names, type_name);
    if (!repeats) {
        CLI::Option* option = single(
            command.add_option_function<std::string>(owned(names), std::move(read), owned(help)), type_name);
        if (!standing.empty()) option->default_str(standing);
        return;
    }
    const auto read_all = [read = std::move(read)](const std::vector<std::string>& values) {
        for (const std::string& value : values) read(value);
    };
    command.add_option_function<std::vector<std::string>>(owned(names), read_all, owned(help))
        ->type_name(owned(type_name))
        ->allow_extra_args(false);
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

void Options::parsed_count(std::string_view names, int default_value, int lowest, int highest,
                           std::string_view help, std::function<void(int)> assign) {
    single(implementation_.command->add_option_function<int>(owned(names), std::move(assign), owned(help)),
           "INTEGER")
        ->check(CLI::Range(lowest, highest).description(""))
        ->default_str(std::to_string(default_value));
}

void Options::parsed_number(std::string_view names, Dimension dimension, std::string_view help,
                            std::optional<double> standing, bool above_zero,
                            std::function<void(double)> assign) {
    const std::string label =
        owned(names.substr(names.rfind(',') == std::string_view::npos ? 0 : names.rfind(',') + 1));
    const auto read = [dimension, label, above_zero, assign](const std::string& text) {
        const double value = parse_quantity(text, dimension, label);
        if (above_zero && !(value > 0.0))
            raise<UsageError>("{} must be above 0{}{}", label, base_unit(dimension).empty() ? "" : " ",
                              base_unit(dimension));
        assign(value);
    };
    parsed(implementation_.names_for_parser(names), read, unit_type_name(dimension), help, false,
           standing ? shortest(*standing) : "");
}

void Options::duration(std::string_view names, std::optional<Seconds>& target, std::string_view help) {
    const std::string label = owned(names);
    const auto read = [&target, label](const std::string& value) {
        target = Seconds(parse_quantity(value, Dimension::time, label));
        if (parse_number(value) && *target != Seconds(0.0))
            raise<UsageError>("{0} {1}: ms or s? write {0} {1}ms or {0} {1}s", label, value);
    };
    parsed(names, read, "TIME", help);
}

void Options::list(std::string_view names, Dimension dimension, std::string_view help,
                   std::function<void(std::span<const std::string_view>)> read_pieces) {
    const auto read = [read_pieces = std::move(read_pieces), dimension, label = owned(names),
                       &words = implementation_.words](const std::string& value) {
        refuse_split_list(words, label, dimension);
        if (value.find_first_of(" :;") != std::string::npos) refuse_other_marks(label, value, dimension);
        read_pieces(split(value, ','));
    };
    parsed(names, read, unit_type_name(dimension) + ",...", help);
}

void Options::orders(std::string_view names, std::vector<StatedOrder>& target, std::string_view help) {
    list(names, Dimension::none, help, [&target, label = owned(names)](const auto& pieces) {
        target.clear();
        for (const std::string_view piece : pieces) target.push_back(parse_order(piece, label));
    });
}

void Options::numbers(std::string_view names, std::vector<double>& target, Dimension dimension,
                      std::string_view help) {
    list(names, dimension, help, [&target, dimension, label = owned(names)](const auto& pieces) {
        target.clear();
        for (const std::string_view piece : pieces) target.push_back(parse_quantity(piece, dimension, label));
    });
}

void Options::argument(std::string_view name, std::string& target, bool required, std::string_view help) {
    implementation_.command->add_option(owned(name), target, owned(help))->required(required)->type_name("");
    names_file(name, "LOG");
}

void Options::arguments(std::string_view name, std::vector<std::string>& target, bool required,
                        std::string_view help) {
    implementation_.command->add_option(owned(name), target, owned(help))->required(required)->type_name("");
    names_file(name, "LOG");
}

void Options::was_output(std::string_view name, bool& used) {
    implementation_.was_output = owned(name);
    implementation_.old_output = &used;
}

void Options::after_parse(std::function<void()> check) {
    implementation_.after_parse.push_back(std::move(check));
}

void Options::names_file(std::string_view names, std::string_view type_name) {
    constexpr std::array types = {"FILE", "LOG", "OTHER", "SPEC", "NAME,KEY=VALUE,..."};
    if (std::find(types.begin(), types.end(), type_name) != types.end())
        implementation_.files.emplace_back(names.substr(0, names.find(',')));
}

void Options::writes(std::string_view name) { implementation_.written.insert(owned(name)); }

void Options::Implementation::check_files() const {
    std::vector<NamedFile> in, out;
    for (const std::string& name : files)
        for (const std::string& value : command->get_option(name)->results())
            (written.contains(name) ? out : in).push_back({value, name});
    refuse_collisions(in, out);
    std::error_code failed;
    for (const std::string& name : written)
        for (const std::string& path : command->get_option(name)->results())
            if (common != nullptr && !common->force && std::filesystem::is_regular_file(path, failed))
                raise<FileError>("{}: exists already; choose another name or overwrite it with --force",
                                 path);
}

namespace {

// What says where a result goes and how much is told on the way is no part of how it was made.
Word in_command_line(std::string_view word) {
    if (word.size() < 2 || word.front() != '-') return Word::stays;
    if (word[1] != '-') return letters(word);
    for (const std::string_view flag : {"--force", "--quiet", "--verbose", "--json"})
        if (word == flag) return Word::goes;
    for (const std::string_view option : {"--output", "--improved-model", "--plot"}) {
        if (word == option) return Word::goes_with_the_next;
        if (word.starts_with(option) && word[option.size()] == '=') return Word::goes;
    }
    return Word::stays;
}

}  // namespace

void Options::answers_by(CommonOptions& common) { implementation_.common = &common; }

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

Options::Group::Group(Options& options, std::string_view name)
    : command_(*options.implementation_.command), name_(name), first_(command_.get_options().size()) {}

Options::Group::~Group() {
    const auto all = command_.get_options();
    for (std::size_t i = first_; i < all.size(); ++i) all[i]->group(name_);
}

namespace {

// What is given of an option, as words: its name before each value.
void add_words(const CLI::Option& option, const std::vector<std::string>& values,
               std::vector<std::string>& words) {
    for (const std::string& value : values) {
        words.push_back(option.get_name());
        if (option.get_items_expected_max() > 0) words.push_back(value);
    }
}

}  // namespace

std::vector<std::string> Options::given(std::string_view group) const {
    std::vector<std::string> words;
    for (const CLI::Option* option : implementation_.command->get_options())
        if (option->get_group() == group) add_words(*option, option->results(), words);
    return words;
}

std::string Options::log_words(const std::optional<std::string>& from, const std::optional<std::string>& to,
                               const std::optional<std::string>& joint) const {
    // The rows first, which differ between the lines of one log; then what the columns are and their clock.
    constexpr std::array<std::string_view, 10> first = {
        "--from", "--to",    "--format",      "--joint",          "--columns",
        "--unit", "--scale", "--sample-rate", "--constant-speed", "--side"};
    std::vector<const CLI::Option*> all;
    for (const CLI::Option* option : implementation_.command->get_options())
        if (option->get_group() == reading_group) all.push_back(option);
    const auto place = [&](const CLI::Option* option) {
        return std::find(first.begin(), first.end(), option->get_name()) - first.begin();
    };
    std::stable_sort(all.begin(), all.end(),
                     [&](const auto* a, const auto* b) { return place(a) < place(b); });
    std::vector<std::string> words;
    for (const CLI::Option* option : all) {
        const std::string name = option->get_name();
        std::vector<std::string> values = option->results();
        if (name == "--from" && from) values = {*from};
        if (name == "--to" && to) values = {*to};
        if (name == "--joint" && joint) values = {*joint};
        for (std::string& value : values) {
            if (name == "--sample-rate")
                value = shortest(parse_quantity(value, Dimension::frequency, name)) + "Hz";
            if (name == "--constant-speed")
                value = shortest(parse_quantity(value, Dimension::speed, name)) + "deg/s";
        }
        add_words(*option, values, words);
    }
    std::string line;
    for (const std::string& word : words) line += " " + shell_quoted(word);
    return line;
}

std::vector<std::string> heading_of(const Provenance& provenance) {
    std::vector<std::string> lines = {fmt::format("Made by {} {}:", tool_name, version()),
                                      provenance.command};
    for (const InputRecord& input : provenance.inputs) {
        lines.push_back(input.sha256.empty() ? fmt::format("from {}", input.name)
                                             : fmt::format("from {}, SHA-256 {}", input.name, input.sha256));
    }
    return lines;
}

bool ends_with_json(std::string_view path) { return path.size() > 5 && path.ends_with(".json"); }

void attach_manner(Options& options, CommonOptions& common) {
    options.answers_by(common);
    const Options::Group group(options, output_group);
    options.flag("--force", common.force, "overwrite existing files");
    options.flag("-q,--quiet", common.quiet, "no warnings on standard error");
    options.flag("-v,--verbose", common.verbose, "print the decisions on standard error");
}

void attach_common(Options& options, CommonOptions& common, const OutputNames& names) {
    options.after_parse([&common, names] {
        if (!names.endings.empty()) {
            check_output_name(common.output, names.what, names.endings);
            if (common.json) check_output_name(common.output, "JSON", ".json .txt");
        }
        common.json = common.json || (names.json_is_option && ends_with_json(common.output));
        // Only who tells what was read needs its hash, which costs more than reading it.
        if (!names.endings.empty())
            common.hashes = common.json || ends_with_json(common.output) || common.plot;
    });
    attach_output(options, common.output, "where the result goes; - is standard output");
    attach_json(options, common);
    attach_manner(options, common);
}

void attach_output(Options& options, std::string& output, std::string_view help) {
    const Options::Group group(options, output_group);
    options.text("-o,--output", output, "FILE", help);
    options.writes("-o");
}

void attach_other_motors(Options& options, std::string& wanted) {
    static constexpr std::array<std::string_view, 2> yes_or_no = {"yes", "no"};
    options.choice("--other-motors", wanted, yes_or_no,
                   "look for ripple of the motors of the log's other joints; no takes a fifth of the time");
}

void attach_conclusive(Options& options, bool& required) {
    const Options::Group group(options, output_group);
    options.flag("--require-conclusive", required, "exit with code 5 when the log does not settle it");
}

void attach_json(Options& options, CommonOptions& common, std::string_view help) {
    const Options::Group group(options, output_group);
    options.flag("--json", common.json, help);
}

std::string joints_in_words(std::span<const std::string> joints) {
    return fmt::format("joint{} {}", joints.size() == 1 ? "" : "s", fmt::join(joints, ", "));
}

void JointMessages::add(const std::string& joint, bool is_warning, std::string_view sentence,
                        std::string_view about) {
    auto same = std::find_if(messages_.begin(), messages_.end(), [&](const Message& known) {
        return known.is_warning == is_warning &&
               (known.sentence == sentence || (!about.empty() && known.about == about));
    });
    if (same == messages_.end())
        same = messages_.insert(same, {is_warning, false, std::string(sentence), std::string(about), {}});
    same->of_first_joint = same->of_first_joint || same->sentence != sentence;
    if (std::find(same->joints.begin(), same->joints.end(), joint) == same->joints.end())
        same->joints.push_back(joint);
}

void JointMessages::say_all(std::size_t joints) {
    for (const Message& one : messages_) {
        const bool of_all = one.joints.size() == joints && !one.of_first_joint;
        talk(fmt::format(
            "{}: {}{}{}{}", tool_name, one.is_warning ? "warning: " : "",
            of_all ? "" : joints_in_words(one.joints) + ": ", one.sentence,
            one.of_first_joint ? fmt::format(" (so in {}; similar in the others)", one.joints.front()) : ""));
    }
    messages_.clear();
}

namespace {

void say_or_gather(const CommonOptions& common, bool is_warning, std::string_view sentence,
                   std::string_view about = {}) {
    if (common.messages)
        common.messages->add(common.joint, is_warning, sentence, about);
    else
        talk(fmt::format("{}: {}{}", tool_name, is_warning ? "warning: " : "", sentence));
}

}  // namespace

void warn(const CommonOptions& common, std::string_view sentence) {
    if (!common.quiet) say_or_gather(common, true, sentence);
}

void say_warnings(const CommonOptions& common, std::span<const std::string> warnings) {
    for (const std::string& warning : warnings) warn(common, warning);
}

void say_warnings(const CommonOptions& common, std::span<const LogWarning> warnings) {
    for (const LogWarning& warning : warnings) {
        if (!common.quiet)
            say_or_gather(common, true, warning.text,
                          warning.of_one_joint ? warning.about : std::string_view());
    }
}

void say(const CommonOptions& common, std::string_view sentence) {
    if (common.verbose && !common.quiet) say_or_gather(common, false, sentence);
}

std::string paragraph(const CommonOptions& common, std::string_view sentence, std::size_t before,
                      std::size_t indent) {
    const auto width =
        common.output == "-" || ends_with_json(common.output) ? terminal_columns() : std::nullopt;
    if (!width) return fmt::format("{}\n", sentence);
    const std::string visible = visible_text(sentence);
    std::string text = wrapped(std::string(before, '.') + visible, *width).front().substr(before);
    std::string_view rest = std::string_view(visible).substr(text.size());
    text += "\n";
    if (rest.starts_with(' ')) rest.remove_prefix(1);
    if (rest.empty()) return text;
    for (const std::string& line : wrapped(rest, *width - std::min(indent, *width - 1)))
        text += std::string(indent, ' ') + line + "\n";
    return text;
}

std::size_t joint_columns(const CommonOptions& common) {
    return common.messages ? text_width(visible_text(common.joint)) + 2 : 0;
}

void take_log(const CommonOptions& common, const std::string& path, const Log& log, Provenance& provenance) {
    say_layout(common, log.layout);
    say_warnings(common, log.recording.warnings);
    provenance.inputs.push_back(input_record(path));
    provenance.inputs.back().rows = log.recording.rows();
    provenance.recordings.push_back({log.recording});
}

void say_layout(const CommonOptions& common, const Layout& layout) {
    say(common, fmt::format("{}: read as if with {}", layout.source, layout.options));
    if (layout.outside) say(common, fmt::format("{}: {}", layout.source, range_in_words(*layout.outside)));
    for (const Assumption& one : layout.inferences)
        say(common, fmt::format("{}: {} is {}: {}", layout.source, one.about, one.assumed, one.reason));
    say_warnings(common, layout.warnings);
}

// The options that every command with a log shares.

namespace {

// A path into a container may hold commas: "torque=log.tau(:,3)".
std::vector<std::string> split_outside_brackets(const std::string& text) {
    std::vector<std::string> pieces;
    int depth = 0;
    for (const std::string_view piece : split(text, ',')) {
        if (depth > 0)
            pieces.back().append(",").append(piece);
        else
            pieces.emplace_back(piece);
        for (const char c : piece) depth += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
    }
    return pieces;
}

void read_units(const std::string& text, std::map<std::string, std::string>& units) {
    for (const std::string_view piece : split(text, ',')) {
        const std::size_t equals = piece.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == piece.size())
            raise<UsageError>("--unit: '{}' is not COLUMN=UNIT, for example velocity=rad/s", piece);
        units[owned(piece.substr(0, equals))] = piece.substr(equals + 1);
    }
}

void read_scale(const std::string& text, std::map<std::string, ColumnScale>& scales) {
    // Names of columns have '=' seldom, scales never.
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0)
        raise<UsageError>("--scale: '{}' is not COLUMN=FACTOR, for example position=360deg/524288", text);
    scales[text.substr(0, equals)] = parse_scale(std::string_view(text).substr(equals + 1), "--scale");
}

// "motor", "velocity=motor,position=joint"
void read_sides(const std::string& text, std::map<Role, Shaft>& sides) {
    for (const std::string_view piece : split(text, ',')) {
        const std::size_t equals = piece.find('=');
        const std::string_view role = equals == std::string::npos ? "" : piece.substr(0, equals);
        const std::string_view side = equals == std::string::npos ? piece : piece.substr(equals + 1);
        const bool known_role = role.empty() || role == "velocity" || role == "position";
        if (!known_role || (side != "motor" && side != "joint"))
            raise<UsageError>("--side: '{}' is none of motor, joint, velocity=motor, position=motor", piece);
        const Shaft shaft = side == "motor" ? Shaft::motor : Shaft::joint;
        if (role != "position") sides[Role::velocity] = shaft;
        if (role != "velocity") sides[Role::position] = shaft;
    }
}

char one_character(const std::string& text, std::string_view option) {
    if (text == "space") return ' ';
    if (text == "tab" || text == "\\t") return '\t';
    if (text.size() != 1) raise<UsageError>("{}: '{}' is not one character", option, text);
    return text.front();
}

std::string one_of(std::initializer_list<std::string_view> all, const std::string& text,
                   std::string_view option) {
    if (std::find(all.begin(), all.end(), text) == all.end())
        raise<UsageError>("{}: '{}' is none of {}", option, text, fmt::join(all, ", "));
    return text;
}

}  // namespace

void attach_log(Options& options, ReadOptions& log) {
    const Options::Group group(options, reading_group);
    options.text("--format", log.format, "NAME",
                 fmt::format("format of the log: {} (default: found out from its first bytes)",
                             name_list(log_formats())));
    options.number("--sample-rate", log.sample_rate, Dimension::frequency,
                   "rate of a log without time; overrides the log's own time");
    options.after_parse([&log] {
        if (log.sample_rate && !(log.sample_rate->value() > 0.0))
            raise<UsageError>("--sample-rate: must be above 0 Hz");
    });
    attach_log_columns(options, log);
}

void attach_log_columns(Options& options, ReadOptions& log) {
    using Text = const std::string&;
    const Options::Group group(options, reading_group);
    options.parsed(
        "--from", [&log](Text text) { log.range.from = parse_time_point(text, "--from"); }, "TIME",
        "earlier rows are ignored: 2s, 500ms, 1.5min or 1:30 on the log's own time axis; 12:30:05 where it "
        "has times of day");
    options.parsed(
        "--to", [&log](Text text) { log.range.to = parse_time_point(text, "--to"); }, "TIME",
        "later rows are ignored; the row at TIME counts");
    options.parsed(
        "--joint", [&log](Text text) { log.joint = log.joint ? *log.joint + "," + text : text; }, "JOINTS",
        "which joints of a file that holds several: a name or number, j1,j3-j5, or all; repeatable", true);
    options.parsed(
        "--columns", [&log](Text text) { log.columns = split_outside_brackets(text); }, "LIST",
        "what the columns are: by place 'time,velocity,torque' (- skips one), or by name 'torque=tau_J'");
    options.parsed(
        "--unit", [&log](Text text) { read_units(text, log.units); }, "COLUMN=UNIT",
        "unit of a column: velocity=rad/s, torque=mNm, time=ms; repeatable", true);
    options.parsed(
        "--scale", [&log](Text text) { read_scale(text, log.scales); }, "COLUMN=FACTOR",
        "what 1 in a column is: position=360deg/524288 (counts), torque=0.04Nm (per mille), torque=2Nm+10Nm "
        "with an offset; repeatable",
        true);
    options.parsed(
        "--side", [&log](Text text) { read_sides(text, log.sides); }, "SIDE",
        "where motion is measured: motor (before the gear) or joint; or by column, velocity=motor");
    options.parsed(
        "--constant-speed",
        [&log](Text text) {
            log.constant_speeds.clear();
            for (const std::string_view piece : split(text, ','))
                log.constant_speeds.emplace_back(parse_quantity(piece, Dimension::speed, "--constant-speed"));
            if (log.constant_speeds.size() > 1) return;
            log.constant_speed = log.constant_speeds.front();
            log.constant_speeds.clear();
        },
        "SPEED",
        "of the joint (of the motor with --side motor), throughout a log that holds no motion: 60rpm; of "
        "several logs in their order: 60rpm,120rpm");
    options.parsed(
        "--delimiter", [&log](Text text) { log.delimiter = one_character(text, "--delimiter"); }, "CHAR",
        "between cells of a text log: , ; space or tab");
    options.parsed(
        "--decimal",
        [&log](Text text) {
            log.decimal_mark = one_character(text, "--decimal");
            if (log.decimal_mark != '.' && log.decimal_mark != ',')
                raise<UsageError>("--decimal: '{}' is neither . nor ,", text);
        },
        "MARK", "decimal mark of a text log: . or ,");
    options.flag(
        "--no-header", [&log] { log.header = false; }, "the first row of a text log is data");
    options.count("--skip-lines", log.skip_lines, 0, 1000000,
                  "lines at the top of a text log that are not read");
    options.text(
        "--layout", log.records, "FIELDS",
        "of a record of a raw dump (--format raw): 'f8:time_s,f4:velocity_deg_s,<i2*0.01:torque_nm'");
    options.parsed(
        "--clock",
        [&log](Text text) {
            log.clock = one_of({"header", "log"}, text, "--clock");
        },
        "CLOCK",
        "of recorded messages: header (their own stamps, the default where they have them) or log (when they "
        "were recorded)");
    options.parsed(
        "--join",
        [&log](Text text) {
            log.join = one_of({"nearest", "hold", "linear"}, text, "--join");
        },
        "HOW", "of signals with times of their own: linear (the default), hold or nearest");
    options.parsed(
        "--kt",
        [&log](std::string text) {
            if (text.size() > 4 && text.ends_with("Nm/A")) text.resize(text.size() - 4);
            log.nm_per_ampere = parse_quantity(text, Dimension::none, "--kt");
        },
        "Nm/A", "torque constant, for logs of motor current");
    options.parsed(
        "--lead",
        [&log](Text text) {
            log.lead_m = parse_quantity(text, Dimension::length, "--lead");
            if (!(*log.lead_m > 0.0)) raise<UsageError>("--lead: '{}' is not above 0", text);
        },
        "LENGTH",
        "travel of a linear axis in one turn of its screw, for logs in m, m/s and N: 5mm; results are the "
        "screw's");
    options.flag("--hold-bad-values", log.hold_bad_values,
                 "replace empty cells and nan by the value before, and count them");
}

namespace {

constexpr std::string_view simulated_option_help =
    "torque of your own simulation, as a known part of the model: a column of the log, tau_model, or of "
    "another file, log,file=sim.csv,column=torque; scale=1 states that its size is right, delay=2ms how much "
    "later it is";

constexpr std::string_view arm_option_help =
    "rigid bodies of the whole arm: urdf,file=FILE[,tip=LINK], mjcf,file=FILE[,tip=BODY], mdh,file=FILE, "
    "dh,file=FILE, or axes,word=zyyzyz (which way each axis points); each with [,gravity=0:0:-9.81] and "
    "[,joints=NAME:NAME IN THE LOG|NAME:=0deg]";

}  // namespace

void attach_gear(Options& options, GearOptions& gear, const GearHelp& help) {
    const Options::Group group(options, gear_group);
    options.number("--gear-ratio", gear.ratio, Dimension::none, help.ratio);
    if (!help.orders.empty()) options.orders("--orders", gear.orders, help.orders);
    if (!help.joint_file.empty()) options.text("--joint-file", gear.joint_file, "FILE", help.joint_file);
}

ReadOptions read_options(ReadOptions log, const std::optional<GearAccount>& gear) {
    if (gear && gear->has_ratio()) log.gear_ratio = gear->ratio.value();
    return log;
}

void attach_given(Options& options, GivenOptions& given) {
    options.text("--simulated", given.simulated, "SPEC", simulated_option_help);
    options.text("--arm", given.arm, "SPEC", arm_option_help);
}

void attach_drive(Options& options, std::optional<std::string>& drive) {
    options.text("--drive", drive, "SPEC",
                 "the torque that a control law makes of a command: pd,kp=60,kd=2,command=COLUMN (Nm/rad, Nm "
                 "s/rad), with [,velocity-command=COLUMN][,delay=4ms|fit][,limit=90Nm]");
}

void attach_residual(Options& options, ResidualOptions& residual) {
    options.text("--residual", residual.model, "FILE",
                 "look into measured less predicted torque: of this model.json, along the log");
    options.text("--simulated", residual.simulated, "SPEC",
                 "the same of your own simulation: tau_model (a column) or log,file=sim.csv,column=torque; "
                 "its scale is fitted unless scale=1 keeps it");
}

void take_residual(const ResidualOptions& residual, const ReadOptions& reading, std::size_t logs,
                   const GivenLog& log, const CommonOptions& common, Provenance& provenance) {
    if (!residual.any()) return;
    const Residual left = subtract_predicted(residual, reading, logs, log);
    if (left.model) provenance.inputs.push_back(input_record(*left.model));
    say(common, fmt::format("{}: {:.4g} Nm rms of torque, {:.4g} less what is predicted", log.path,
                            left.before_nm, left.after_nm));
}

namespace {

std::string excess(const Gates& gates, double delay_ms) {
    const double limit_ms = 1e3 * gates.max_delay->value();
    return fmt::format("delays by {:.1f} ms, {:.1f} ms more than --max-delay {:.6g}ms", delay_ms,
                       delay_ms - limit_ms, limit_ms);
}

}  // namespace

void attach_gates(Options& options, Gates& gates) {
    options.duration("--max-delay", gates.max_delay,
                     "exit code 1 when a method's DC delay is longer, e.g. 20ms");
    options.number("--min-attenuation", gates.min_attenuation_db, Dimension::decibel,
                   "exit code 1 when an order is attenuated less, e.g. 20dB");
}

std::vector<std::string> delay_violations(const Gates& gates, const Contender& contender, Hertz sample_rate,
                                          DegPerSec slowest, DegPerSec fastest) {
    std::vector<std::string> sentences;
    if (!gates.max_delay) return sentences;
    if (contender.table != nullptr) {
        for (const Band& band : contender.table->bands()) {
            if (!(band.from < fastest) || band.to < slowest) continue;
            const double delay_ms =
                1e3 * group_delay(band.cascade(), Hertz(0.0), SampledAt(sample_rate)).value();
            if (delay_ms <= 1e3 * gates.max_delay->value()) continue;
            sentences.push_back(fmt::format("{}: band {} ({:.6g}-{:.6g} deg/s) {}", contender.text,
                                            band.number, band.from.value(), band.to.value(),
                                            excess(gates, delay_ms)));
        }
        return sentences;
    }
    const LongestDelay longest = longest_delay(contender, sample_rate, {slowest, fastest});
    const double delay_ms = 1e3 * longest.delay.value();
    if (delay_ms <= 1e3 * gates.max_delay->value()) return sentences;
    std::string sentence = fmt::format("{}: it {}", contender.text, excess(gates, delay_ms));
    if (contender.made_for()) {
        sentence += fmt::format(" at {:.4g} deg/s", longest.speed.value());
        const auto from = within_from(contender, sample_rate, *gates.max_delay);
        if (from) sentence += fmt::format("; from {:.3g} deg/s on it stays within", from->value());
    }
    sentences.push_back(std::move(sentence));
    return sentences;
}

std::vector<std::string> attenuation_violations(const Gates& gates, const std::string& method,
                                                std::span<const OrderAttenuation> orders) {
    std::vector<std::string> sentences;
    if (!gates.min_attenuation_db) return sentences;
    const std::string limit = shortest(*gates.min_attenuation_db);
    for (const OrderAttenuation& entry : orders) {
        if (!entry.db) {
            sentences.push_back(
                fmt::format("{}: {} could not be measured, so --min-attenuation {}dB is not shown to hold",
                            method, entry.name(), limit));
        } else if (!(*entry.db >= *gates.min_attenuation_db)) {
            sentences.push_back(
                fmt::format("{}: it attenuates {} by {:.1f} dB, {:.1f} dB less than --min-attenuation {}dB",
                            method, entry.name(), *entry.db, *gates.min_attenuation_db - *entry.db, limit));
        }
    }
    return sentences;
}

}  // namespace ripplenotch
