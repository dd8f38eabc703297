// SPDX-License-Identifier: MIT
#pragma once
// How a command declares its options, without knowing the library that parses them (CLI11, in options.cpp
// alone). Names are as the user types them: "-o,--output", "--json", or "LOG" for a positional argument.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/log/layout.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/given_terms.hpp"

namespace CLI {
class App;
}

namespace ripplenotch {

struct CommonOptions;

inline constexpr std::string_view reading_group = "How the log is read", gear_group = "Gear",
                                  output_group = "Output";

class Options {
  public:
    struct Implementation;
    explicit Options(Implementation& implementation) : implementation_(implementation) {}

    /// What is declared while it lives is listed under this heading in --help, and can be asked for by it.
    class Group {
      public:
        Group(Options& options, std::string_view name);
        ~Group();
        Group(const Group&) = delete;
        Group& operator=(const Group&) = delete;

      private:
        CLI::App& command_;
        std::string name_;
        std::size_t first_;
    };

    void flag(std::string_view names, bool& target, std::string_view help);
    void flag(std::string_view names, std::function<void()> set, std::string_view help);
    /// A text, whose standing value is shown as the default, or an optional one.
    template <class Text>
    void text(std::string_view names, Text& target, std::string_view type_name, std::string_view help) {
        std::string standing;
        if constexpr (std::is_same_v<Text, std::string>) standing = target;
        parsed(
            names, [&target](const std::string& value) { target = value; }, type_name, help, false, standing);
    }
    /// May be given several times; each occurrence takes exactly one value.
    void texts(std::string_view names, std::vector<std::string>& target, std::string_view type_name,
               std::string_view help) {
        parsed(
            names, [&target](const std::string& value) { target.push_back(value); }, type_name, help, true);
    }
    [[nodiscard]] bool has(std::string_view name) const;
    /// `read` takes the value, as often as it is given where the option repeats; it throws UsageError.
    void parsed(std::string_view names, std::function<void(const std::string&)> read,
                std::string_view type_name, std::string_view help, bool repeats = false,
                const std::string& standing = "");
    void choice(std::string_view names, std::string& target, std::span<const std::string_view> choices,
                std::string_view help);
    template <class Integer>
    void count(std::string_view names, Integer& target, int lowest, int highest, std::string_view help) {
        parsed_count(names, static_cast<int>(target), lowest, highest, help,
                     [&target](int value) { target = static_cast<Integer>(value); });
    }
    /// A double or a quantity, or an optional one, which has no default.
    template <class Target>
    void number(std::string_view names, Target& target, Dimension dimension, std::string_view help,
                bool above_zero = false) {
        if constexpr (requires { target.emplace(0.0); }) {
            parsed_number(names, dimension, help, {}, above_zero,
                          [&target](double value) { target.emplace(value); });
        } else {
            const double standing = target / Target(1.0);
            parsed_number(names, dimension, help, standing, above_zero,
                          [&target](double value) { target = Target(value); });
        }
    }
    /// A time of which a bare number could as well be meant in ms as in s: it needs its unit, but for 0.
    void duration(std::string_view names, std::optional<Seconds>& target, std::string_view help);
    /// "1,2,4" or "25Hz,50Hz". Refuses "--orders 1 2", which would be a list of one and a log named 2.
    void numbers(std::string_view names, std::vector<double>& target, Dimension dimension,
                 std::string_view help);

    /// "1,2" or "200/turn,400/turn".
    void orders(std::string_view names, std::vector<StatedOrder>& target, std::string_view help);

    /// Positional arguments; `required` ones raise a usage error when missing.
    void argument(std::string_view name, std::string& target, bool required, std::string_view help);
    void arguments(std::string_view name, std::vector<std::string>& target, bool required,
                   std::string_view help);

    /// The file that the option of this first name takes is written; of all others whose type says that they
    /// name files (FILE, LOG, SPEC, ...), and of arguments, files are read. Those that collide are refused.
    void writes(std::string_view name);
    /// -o and --output, which the command does not declare, are read as the option of this name for one more
    /// release, and `used` says so. No help names them.
    void was_output(std::string_view name, bool& used);
    /// Runs when all options are read, before the work.
    void after_parse(std::function<void()> check);

    /// What the answer is written by, for commands that declare no more of it.
    void answers_by(CommonOptions& common);

    [[nodiscard]] std::string command_name() const;
    /// The command line as it would be typed again, without -o, --improved-model, --plot, --force, -q, -v
    /// and --json; for provenance.
    [[nodiscard]] std::string command_line() const;
    /// The options of attach_log() that are given, each with a blank before it, for command lines that people
    /// paste; `from`, `to` and `joint` take the place of --from, --to and --joint.
    [[nodiscard]] std::string log_words(const std::optional<std::string>& from = {},
                                        const std::optional<std::string>& to = {},
                                        const std::optional<std::string>& joint = {}) const;
    /// The options of a group, as words as they were given.
    [[nodiscard]] std::vector<std::string> given(std::string_view group) const;

  private:
    void list(std::string_view names, Dimension dimension, std::string_view help,
              std::function<void(std::span<const std::string_view>)> read_pieces);
    void names_file(std::string_view names, std::string_view type_name);
    void parsed_number(std::string_view names, Dimension dimension, std::string_view help,
                       std::optional<double> standing, bool above_zero, std::function<void(double)> assign);
    void parsed_count(std::string_view names, int default_value, int lowest, int highest,
                      std::string_view help, std::function<void(int)> assign);
    Implementation& implementation_;
};

/// What is said while a command goes over the joints of a log, gathered: a sentence is said once, with the
/// joints that it is about where these are not all.
class JointMessages {
  public:
    /// Sentences `about` the same, with the figures of a joint each, are one with the first joint's figures.
    void add(const std::string& joint, bool is_warning, std::string_view sentence,
             std::string_view about = {});
    /// In the order of their first joints, and no more afterwards. `joints`: how many were gone over.
    void say_all(std::size_t joints);

  private:
    struct Message {
        bool is_warning, of_first_joint;
        std::string sentence, about;
        std::vector<std::string> joints;
    };
    std::vector<Message> messages_;
};
/// "csv, npy": the names of a registry's entries, in its order, for help on what can be chosen.
template <class Entry>
[[nodiscard]] std::string name_list(std::span<const Entry* const> entries) {
    return joined(entries, ", ", &Entry::name);
}
/// A word of a command line that people paste, as a shell takes it: as it is where it is plain, else quoted.
[[nodiscard]] std::string shell_quoted(const std::string& word);

/// "joint j1", "joints j1, j3".
[[nodiscard]] std::string joints_in_words(std::span<const std::string> joints);

/// What every command has.
struct CommonOptions {
    /// Of a command that goes over several joints: the one that is spoken of, and what gathers the messages.
    std::string joint = {};
    std::shared_ptr<JointMessages> messages = {};
    std::string output = "-";
    std::optional<std::string> plot = {};
    bool json = false, quiet = false, verbose = false, force = false;
    bool hashes = true;      ///< inputs are hashed, for an answer that tells what was read
    bool in_memory = false;  ///< the answer is for another command, and nothing is written
    /// Rows that would go to standard output are not made: the figure takes their place.
    [[nodiscard]] bool figure_for_rows() const { return in_memory || (plot == "-" && output == "-"); }
    [[nodiscard]] ByteSink::Overwrite overwrite() const { return {force}; }
};
/// What -o may be called. Names that promise another kind of file are refused (core/output_name.hpp).
struct OutputNames {
    std::string_view what;        ///< goes to -o: "a comparison"
    std::string_view endings;     ///< that fit it: ".txt .json"; empty where the command looks itself
    bool json_is_option = false;  ///< a name that ends in .json is the same as --json
};
/// How a file says where it is from, one line each: tool, command and inputs.
[[nodiscard]] std::vector<std::string> heading_of(const Provenance& provenance);
void attach_common(Options& options, CommonOptions& common, const OutputNames& names);
void attach_json(Options& options, CommonOptions& common,
                 std::string_view help = "one JSON object instead of text");
void attach_output(Options& options, std::string& output, std::string_view help);
/// --other-motors yes or no.
void attach_other_motors(Options& options, std::string& wanted);
void attach_conclusive(Options& options, bool& required);
/// How it writes and what it says: --force, --quiet and --verbose.
void attach_manner(Options& options, CommonOptions& common);
[[nodiscard]] bool ends_with_json(std::string_view path);

/// How to read a log, and which rows of it: --format, --joint, --columns, --from and so on.
void attach_log(Options& options, ReadOptions& log);
/// The same without --format and --sample-rate, for a command whose own options have these names.
void attach_log_columns(Options& options, ReadOptions& log);

// Options of what the library decides by: the gear, what is given of a torque, and what is subtracted from
// it.

/// What an option is for in a command, where that differs; a command has no option whose help is empty.
struct GearHelp {
    std::string_view ratio = "motor turns per joint turn";
    std::string_view orders =
        "ripple lines in cycles per motor turn, or per turn of the joint, 200/turn,400/turn (default: where "
        "a gear ratio is known, 1,2)";
    std::string_view joint_file = "joint.json of identify: gear ratio, orders and amplitudes from there";
};

void attach_gear(Options& options, GearOptions& gear, const GearHelp& help = {});

/// How a log is read with this gear: motion that is measured before the gear is stated by its ratio, and
/// divided by it.
[[nodiscard]] ReadOptions read_options(ReadOptions log, const std::optional<GearAccount>& gear);

/// --simulated and --arm.
void attach_given(Options& options, GivenOptions& given);

/// --drive.
void attach_drive(Options& options, std::optional<std::string>& drive);

/// --residual and --simulated.
void attach_residual(Options& options, ResidualOptions& residual);

/// subtract_predicted(), with what it left on standard error (-v) and the model among the inputs.
void take_residual(const ResidualOptions& residual, const ReadOptions& reading, std::size_t logs,
                   const GivenLog& log, const CommonOptions& common, Provenance& provenance);

/// Messages for people, on standard error: "ripplenotch: warning: ...". Nothing at all when quiet.
void warn(const CommonOptions& common, std::string_view sentence);
void say_warnings(const CommonOptions& common, std::span<const std::string> warnings);
void say_warnings(const CommonOptions& common, std::span<const LogWarning> warnings);
void say(const CommonOptions& common, std::string_view sentence);  ///< only with -v
/// A sentence with its end of line. On a terminal it is wrapped at blanks, to the terminal's width: the first
/// line begins after `before` columns, the others with `indent` blanks. In a pipe or a file it is one line,
/// so that the first line of a result is its verdict.
[[nodiscard]] std::string paragraph(const CommonOptions& common, std::string_view sentence,
                                    std::size_t before = 0, std::size_t indent = 0);
/// The columns of "j1: ", which stand before the result of a joint where there are several.
[[nodiscard]] std::size_t joint_columns(const CommonOptions& common);
/// The option line that would force the reading of a log, with -v; its warnings always unless quiet.
void say_layout(const CommonOptions& common, const Layout& layout);
/// A log that was read: what is said of it, and its place among the inputs.
void take_log(const CommonOptions& common, const std::string& path, const Log& log, Provenance& provenance);

// Limits that a user sets on what a method may cost and must do; a violation is exit code 1.

struct Gates {
    std::optional<Seconds> max_delay;
    std::optional<double> min_attenuation_db;
};
void attach_gates(Options& options, Gates& gates);

/// One sentence for each band that can come into force at |v| from slowest to fastest and delays by more than
/// the limit; for a method without bands one about the worst speed.
[[nodiscard]] std::vector<std::string> delay_violations(const Gates& gates, const Contender& contender,
                                                        Hertz sample_rate, DegPerSec slowest,
                                                        DegPerSec fastest);

/// One sentence for each order that is attenuated less than the limit, or was not measured.
[[nodiscard]] std::vector<std::string> attenuation_violations(const Gates& gates, const std::string& method,
                                                              std::span<const OrderAttenuation> orders);

}  // namespace ripplenotch
