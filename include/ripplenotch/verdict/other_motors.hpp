// SPDX-License-Identifier: MIT
#pragma once
// The motors of a log's other joints, whose ripple may be in the torque of the one that is looked at.

#include <cstddef>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// A joint by its name, with one log for each that is read.
struct JointLogs {
    std::string joint;
    std::vector<Log> logs;
};

/// The joints of the logs at `paths` that have a position in each of them; none where `layout`, that of the
/// first log, has fewer than two joints.
[[nodiscard]] std::vector<JointLogs> read_arm(std::span<const std::string> paths, const Layout& layout,
                                              const ReadOptions& options, std::size_t most_rows);

/// What is stated of the gears of other joints.
struct StatedMotors {
    /// Of the joint that is looked at: an arm's joints often have the same. It counts where nothing else is
    /// known of a joint, and where what identify finds in its own torque agrees.
    std::optional<GearRatio> ratio = std::nullopt;
    std::vector<Order> orders = {};  ///< that were asked for; empty: those identified, or default_orders()
};

/// The gear of a joint's motor as identify found it in the joint's own torque, or as it is stated.
[[nodiscard]] std::optional<GearAccount> gear_of_motor(const Identification& found,
                                                       const StatedMotors& stated);

/// Empty where it is not known.
using GearOfJoint = std::function<std::optional<GearAccount>(const JointLogs& joint)>;

struct OtherMotors {
    std::vector<OtherMotor> motors;      ///< views of the logs of the joints
    std::vector<std::string> not_known;  ///< joints whose gear ratio is not known
    std::size_t looked_at = 0;           ///< all of these

    /// Of a torque and another motor that the logs have.
    [[nodiscard]] std::size_t pairs() const { return looked_at * (looked_at + 1); }
};

/// The motors of these joints but the one that `own` is of, whose rows theirs have to be. They are views of
/// `arm`.
[[nodiscard]] OtherMotors motors_of(std::span<const JointLogs> arm, std::span<const Log> own,
                                    const GearOfJoint& gear_of);

// The ripple that the motors of other joints put into a joint's torque, row by row.

/// Predicted by maps from the motion of their own joints, which the log holds. It is computed in a pass of
/// its own and kept in a temporary file, so that memory does not grow with the log.
class OtherRipple final : public RowValues {
  public:
    /// Reads `log` by the options that the joint itself is read by. Throws DataError where the log has no
    /// such joint, and what open_log throws.
    OtherRipple(std::span<const RippleMap> maps, const Spool& log, const ReadOptions& options);

    /// In Nm, of the next rows of the log.
    std::span<const double> next(std::size_t count) override;

  private:
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
    std::vector<double> values_;
};

}  // namespace ripplenotch
