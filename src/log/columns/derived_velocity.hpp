// SPDX-License-Identifier: MIT
#pragma once
// Velocity for logs that hold none: the slope of the position, or one that is stated.

#include <exception>
#include <memory>
#include <optional>
#include <vector>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// Passes on the rows of another reader, with the slope of the position as the velocity of joints that have
/// none: central differences from row to row, one-sided at both ends of the log. A step of more than half a
/// turn is taken as a wrap.
class DerivedVelocity : public LogReader {
  public:
    explicit DerivedVelocity(std::unique_ptr<LogReader> reader);

    [[nodiscard]] const Layout& layout() const override { return reader_->layout(); }
    [[nodiscard]] std::string_view head() const override { return reader_->head(); }
    [[nodiscard]] const LogReader& base() const override { return reader_->base(); }
    bool next(RowBlock& block) override;

  private:
    struct Point {
        double time_s = 0.0, position_deg = 0.0;
    };
    void look_ahead();
    void derive(RowBlock& block, std::size_t joint);

    std::unique_ptr<LogReader> reader_;
    std::vector<std::size_t> joints_;           ///< without a velocity of their own
    std::vector<double> turns_deg_;             ///< of them: where the position would wrap
    std::vector<std::optional<Point>> before_;  ///< of them: the last row of the block before
    RowBlock ahead_;                            ///< the block after the one that is passed on
    bool begun_ = false, more_ = false;
    std::exception_ptr failure_;  ///< of the block ahead; for when its turn comes
};

/// Passes on the rows of another reader, with one velocity for all joints.
class ConstantVelocity : public LogReader {
  public:
    ConstantVelocity(std::unique_ptr<LogReader> reader, DegPerSec speed)
        : reader_(std::move(reader)), speed_(speed) {}

    [[nodiscard]] const Layout& layout() const override { return reader_->layout(); }
    [[nodiscard]] std::string_view head() const override { return reader_->head(); }
    [[nodiscard]] const LogReader& base() const override { return reader_->base(); }
    bool next(RowBlock& block) override;

  private:
    std::unique_ptr<LogReader> reader_;
    DegPerSec speed_;
};

}  // namespace ripplenotch
