// SPDX-License-Identifier: MIT
#pragma once
// --arm: where the chain of an arm comes from, as it is typed.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/arm/joint_matching.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

struct ArmSource {
    Chain chain;          ///< without joints that are kept still
    StatedJoints stated;  ///< partners in the log
    std::string words;    ///< as it would be typed again
    std::optional<std::string> file = {};
};

/// Reads the file that the words name. Throws UsageError for the words, what the readers of chains throw for
/// the file.
[[nodiscard]] ArmSource read_arm_source(std::string_view words);

// All joints of an arm from one log, in the order of its chain.

struct ArmReading {
    std::vector<Log> logs;  ///< a joint of the chain each
    JointMatch match;
    std::vector<std::string> names;  ///< of the joints in the log, in the order of the chain

    [[nodiscard]] ArmLog view() const;
    /// The place in the chain of a joint by its name in the log or in the chain, whatever its case. Throws
    /// UsageError with the nearest name.
    [[nodiscard]] std::size_t find(const Chain& chain, const std::string& joint) const;
};

/// Of a log with more than `most_rows` the pieces of read_log_in_part. Throws what
/// read_joints_at_once_in_part and match_joints throw, and UsageError where a joint of the chain has no
/// position.
[[nodiscard]] ArmReading read_arm(const std::string& path, const ReadOptions& options, std::size_t most_rows,
                                  const Chain& chain, const StatedJoints& stated);

// An arm and a log of its joints: the term that a diagnosis of one of them is given, and what is told of it.

class GivenArm {
  public:
    /// Reads the log, as read_arm, and so any other one. `smoothing`: of the motion that the arm sees; left
    /// out: the fit chooses it. Throws what read_arm and arm_travel throw.
    GivenArm(ArmSource option, const std::string& path, const ReadOptions& options,
             std::optional<Seconds> smoothing = {}, std::size_t most_rows = all_rows);

    [[nodiscard]] const Chain& chain() const { return option_.chain; }
    /// That the chain was read from.
    [[nodiscard]] const std::optional<std::string>& file() const { return option_.file; }
    [[nodiscard]] const ArmReading& reading() const { return reading_; }
    /// Another log of the same arm, matched alike; read when it is first asked for.
    [[nodiscard]] const ArmReading& other(const std::string& path, const ReadOptions& options);
    /// The place in the chain of a joint of the log.
    [[nodiscard]] std::size_t find(const std::string& joint) const { return reading_.find(chain(), joint); }

    /// One fit for all joints; where lengths are guessed, rows of two joints do not agree, and each has a fit
    /// of its own. Made when it is first asked for.
    const ArmFit& fit(std::size_t joint);
    /// Faults of arm and log, of all joints at once where they have one fit. Found when first asked for.
    const std::vector<SetupFault>& setup_faults(std::size_t joint);
    /// Columns for the rows of the log that the arm was fitted to, or for those of another one; `log` is
    /// reading() or other().
    [[nodiscard]] GivenTerm term(std::size_t joint, const ArmReading& log);
    [[nodiscard]] ArmAccount account(std::size_t joint);
    /// The same of an arm whose values are stated, which has no fit.
    [[nodiscard]] ArmAccount stated_account(std::size_t joint, Seconds smoothing) const;

  private:
    ArmSource option_;
    std::optional<Seconds> smoothing_;
    std::size_t most_rows_;
    ArmReading reading_;
    std::map<std::string, ArmReading> others_;  ///< by path
    std::vector<JointTravel> travel_;
    /// Of a log, for all its joints; by smoothing.
    std::map<std::pair<const ArmReading*, double>, std::vector<Motion>> motions_;
    struct Fitted {
        ArmFit fit;  ///< of the torques moved ahead by the common lag, where it is applied
        std::vector<SetupFault> faults;
        std::optional<ArmLag> lag;
    };
    [[nodiscard]] const Fitted& fitted(std::size_t joint);
    [[nodiscard]] bool is_applied(const ArmLag& lag) const;
    [[nodiscard]] ArmFitOptions options_for(std::size_t joint) const;
    std::map<std::size_t, Fitted> fits_;  ///< by joint; all joints at once: under 0
};

}  // namespace ripplenotch
