// SPDX-License-Identifier: MIT
#pragma once
// The gear of a command: which of its sources counts. Options first, then keys of the method, the joint
// file, the method's table.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch {

/// What one source states of a gear; what it does not state is empty.
struct GearStatement {
    std::string source;  ///< for messages
    std::optional<GearRatio> ratio;
    std::vector<StatedOrder> orders;   ///< each once
    std::vector<double> amplitude_nm;  ///< one per order, or empty
    std::vector<double> phase_deg;     ///< one per order, or empty where one of them is not known
    // Of a joint.json:
    Hertz sample_rate = {};    ///< nominal: what filter designs for on the same log
    double ratio_error = 0.0;  ///< share: the further end of the file's 95 % interval; 0 for a given ratio
    DegPerSec slowest = {}, fastest = {};  ///< |v| at which its lines were seen; both 0 without lines
    DegPerSec velocity_noise = {};         ///< standard deviation; 0 where the file does not state it
};

/// A joint.json, and what it says about the gear: of the lines that follow the motor.
struct JointFile {
    std::string path, source;  ///< the source is for messages
    Identification found;

    /// A line that was seen at one speed only counts when identify gave it an order: then the gear ratio
    /// rests on it. With a ratio from elsewhere the orders are those of the measured lines under that ratio,
    /// whole or half where they are within 0.5 % of it; where no ratio is known they count by turns of the
    /// joint. Of two lines of one order the stronger one counts.
    [[nodiscard]] GearStatement facts(std::optional<GearRatio> given = std::nullopt) const;
};

/// Reads joint.json, or standard input when the path is "-". Throws DataError, FileError, and UsageError for
/// an empty path.
[[nodiscard]] JointFile load_joint(const std::string& path);

/// --gear-ratio, --orders and --joint-file as they were typed.
struct GearOptions {
    std::optional<double> ratio;
    std::vector<StatedOrder> orders;
    std::optional<std::string> joint_file;

    [[nodiscard]] bool any() const { return ratio || !orders.empty() || joint_file; }
};

/// Throws UsageError on a ratio or an order that is none, and on an order that is given twice.
void check_gear(const GearOptions& gear);

/// Checked options with their joint file read, once.
class GearChoice {
  public:
    /// Throws what check_gear and load_joint throw.
    explicit GearChoice(GearOptions options);

    /// The gear of a command, or of a method with what its keys, its own joint file (null: that of the
    /// options) and its table state. Orders that no source states are default_orders() of a known ratio.
    /// Empty when no source states a ratio or lines. Throws DataError when a joint file that is asked has no
    /// line that turns with the joint, UsageError for orders by the motor where no source states a ratio.
    [[nodiscard]] std::optional<GearAccount> of(const GearStatement& method = {},
                                                const JointFile* joint = nullptr,
                                                const GearStatement& table = {}) const;
    /// Of --orders; empty where it is not given.
    [[nodiscard]] const std::vector<StatedOrder>& asked_orders() const { return options_.orders; }
    [[nodiscard]] const std::optional<JointFile>& joint() const { return joint_; }
    /// What the joint file says under --gear-ratio, where that is given.
    [[nodiscard]] std::optional<GearStatement> facts() const;

  private:
    GearOptions options_;
    std::optional<JointFile> joint_;
};

/// Throws the one UsageError for whoever needs the lines and is not told them: "--truth", "method tracking".
[[noreturn]] void raise_no_gear(std::string_view who);

/// "gear ratio 100, orders 1, 2 (joint.json)", "orders 200/turn of the joint (--orders)", for -v.
[[nodiscard]] std::string gear_in_words(const GearAccount& gear);

// A filter method as the user wrote it, checked, with its table loaded and its gear chosen.

/// Maps by the names of their files.
using MapSource = std::function<RippleMap(const std::string& path)>;

/// `spec_text` as --method takes it; `table` is a table.json for a method that needs one and names none. Keys
/// of the gear that the text leaves out are filled, and joint=FILE is replaced by the keys that it fills, so
/// that the contender's text says all. Throws UsageError on a bad specification, on a gear that is missing,
/// and what load_table, load_joint and refuse_other_gear throw. Maps are read from their files unless `maps`
/// has them.
[[nodiscard]] Contender choose_method(const std::string& spec_text,
                                      const std::optional<std::string>& table = std::nullopt,
                                      const GearChoice& gear = GearChoice({}), const MapSource& maps = {});

/// Throws UsageError, naming both, when the method's map is of a joint of another name than the log's.
void refuse_other_joint(const Contender& method, const std::string& joint);

/// Throws UsageError, naming both, when the method's filter is made for another gear ratio than that whose
/// ripple is measured: by more than 0.5 %, or than a table's own ratio error.
void refuse_other_gear(const Contender& method, const GearAccount& measured);

// The methods of a log's joints: one for all of them, or one each.

/// Stands for a joint's name in the names of files and in the keys of a method.
inline constexpr std::string_view joint_mark = "{joint}";
[[nodiscard]] bool names_joint(std::string_view text);
/// `text` with the joint's name in place of each mark; a name that is no file's, like arm/1, gets _ for /.
/// Throws UsageError when there is a mark and the joint has no name.
[[nodiscard]] std::string with_joint(std::string text, const std::string& joint);

/// As the command line has it; "{joint}" may stand in the names of methods and files.
struct MethodRequest {
    std::string method;
    GearOptions gear;
    bool needs_gear = false;                                 ///< something was asked about the ripple's place
    std::optional<std::string> other_motors = std::nullopt;  ///< a map whose `others` are subtracted first
};

class JointMethods {
  public:
    /// Chooses at once where no text names the joint, so that what is wrong is said before a log is opened.
    /// Throws what choose_method throws, UsageError when a gear is needed and not known.
    explicit JointMethods(MethodRequest request);

    /// Throws the same, and what with_joint throws.
    [[nodiscard]] std::shared_ptr<const Contender> of(const std::string& joint) const;
    /// The gear of all joints; empty where each has its own, or none is stated.
    [[nodiscard]] std::optional<GearAccount> common_gear() const;
    /// Whether the log is read twice, as far as that is known before its joints are.
    [[nodiscard]] bool needs_log_twice() const;
    /// Whether what the method does depends on how fast the joint turns.
    [[nodiscard]] bool follows_motion() const;

  private:
    [[nodiscard]] const Method& method() const;
    [[nodiscard]] std::shared_ptr<const Contender> choose(const std::string& joint) const;

    MethodRequest request_;
    std::shared_ptr<const Contender> common_;  ///< null when each joint has its own
};

}  // namespace ripplenotch
