// SPDX-License-Identifier: MIT
#pragma once
// The gear of a command: which of its sources is believed. Options first, then keys of the method, the joint
// file, the method's table.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// What one source states of a gear; what it does not state is empty.
struct GearStatement {
    std::string source;  ///< for messages
    std::optional<GearRatio> ratio;
    std::vector<Order> orders;         ///< lowest first, each once
    std::vector<double> amplitude_nm;  ///< one per order, or empty
    std::vector<double> phase_deg;     ///< one per order, or empty where one of them is not known
};

// A joint.json, and what it says about the gear: of the lines that follow the motor.

struct JointFacts : GearStatement {
    Hertz sample_rate;           ///< nominal: what filter designs for on the same log
    double ratio_error = 0.0;    ///< share: the further end of the file's 95 % interval; 0 for a given ratio
    DegPerSec slowest, fastest;  ///< |v| at which those lines were seen; both 0 without lines
};

struct JointFile {
    std::string path, source;  ///< the source is for messages
    Identification found;

    /// A line that was seen at one speed only counts when identify gave it an order: then the gear ratio
    /// rests on it. With a ratio from elsewhere the orders are those of the measured lines under that ratio,
    /// whole or half where they are within 0.5 % of it. Of two lines of one order the stronger one counts.
    [[nodiscard]] JointFacts facts(std::optional<GearRatio> given = std::nullopt) const;
};

/// Reads joint.json, or standard input when the path is "-". Throws DataError, FileError, and UsageError for
/// an empty path.
[[nodiscard]] JointFile load_joint(const std::string& path);

/// --gear-ratio, --orders and --joint-file as they were typed.
struct GearOptions {
    std::optional<double> ratio;
    std::vector<double> orders;
    std::optional<std::string> joint_file;

    [[nodiscard]] bool any() const { return ratio || !orders.empty() || joint_file; }
};

/// Orders as they are typed, lowest first.
[[nodiscard]] std::vector<Order> sorted_orders(const std::vector<double>& values);

/// Throws UsageError on a ratio or an order that is none, and on an order that is given twice.
void check_gear(const GearOptions& gear);

/// Checked options with their joint file read, once.
class GearChoice {
  public:
    /// Throws what check_gear and load_joint throw.
    explicit GearChoice(GearOptions options);

    /// The gear of a command, or of a method with what its keys, its own joint file (null: that of the
    /// options) and its table state. Orders that no source states are default_orders(). Empty when no source
    /// states a ratio. Throws DataError when a joint file that is asked has no ratio or no line that follows
    /// the motor.
    [[nodiscard]] std::optional<GearAccount> of(const GearStatement& method = {},
                                                const JointFile* joint = nullptr,
                                                const GearStatement& table = {}) const;
    /// Of --orders; empty where it is not given.
    [[nodiscard]] const std::vector<double>& asked_orders() const { return options_.orders; }
    [[nodiscard]] const std::optional<JointFile>& joint() const { return joint_; }
    /// What the joint file says under --gear-ratio, where that is given.
    [[nodiscard]] std::optional<JointFacts> facts() const;

  private:
    GearOptions options_;
    std::optional<JointFile> joint_;
};

/// Throws the one UsageError for whoever needs the gear and is not told it: "--orders", "method tracking".
[[noreturn]] void raise_no_gear(std::string_view who);

/// "gear ratio 100, orders 1, 2 (joint.json)", for -v.
[[nodiscard]] std::string gear_in_words(const GearAccount& gear);

}  // namespace ripplenotch
