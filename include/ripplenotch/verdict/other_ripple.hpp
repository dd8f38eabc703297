// SPDX-License-Identifier: MIT
#pragma once
// The ripple that the motors of other joints put into a joint's torque, row by row.

#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// Predicted by maps from the motion of their own joints, which the log holds. It is computed in a pass of
/// its own and kept in a temporary file, so that memory does not grow with the log.
class OtherRipple final : public RowValues {
  public:
    /// Reads `log` by the options that the joint itself is read by. Throws DataError where the log has no
    /// such joint, and what open_log throws.
    OtherRipple(std::span<const RippleMap> maps, const Spool& log, const ReadOptions& options);
    ~OtherRipple() override;
    OtherRipple(const OtherRipple&) = delete;
    OtherRipple& operator=(const OtherRipple&) = delete;

    /// In Nm, of the next rows of the log.
    std::span<const double> next(std::size_t count) override;

  private:
    std::FILE* file_;
    std::vector<double> values_;
};

}  // namespace ripplenotch
