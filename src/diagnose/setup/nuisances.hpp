// SPDX-License-Identifier: MIT
#pragma once
// What a measured torque may have that a simulation lacks, over the window of an alignment: columns whose
// values nobody asks for.

#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/alignment.hpp"

namespace ripplenotch {

struct NuisanceChoice {
    bool friction = false, inertia = false, ripple = false, gravity = false, load = false;
};

class NuisanceColumns {
  public:
    struct Window {
        std::span<const double> at_s;
        double smoothing_s;
    };
    /// Along the motion of the log.
    NuisanceColumns(const TraceView& log, std::optional<GearRatio> gear_ratio,
                    const AlignmentOptions& options, const Window& window);

    /// An offset, and what is chosen of: friction (Coulomb of two widths, viscous), the acceleration, cosine
    /// and sine of the position, ripple of orders 1 and 2 whose amplitude is affine in the speed, friction
    /// that grows with the measured torque and hysteresis (Dahl's, of 2 deg).
    [[nodiscard]] std::vector<std::vector<double>> of(const NuisanceChoice& choice) const;
    [[nodiscard]] bool has_position() const { return !gravity_.empty(); }
    [[nodiscard]] bool has_velocity() const { return !friction_.empty(); }

  private:
    std::size_t rows_;
    std::vector<std::vector<double>> friction_, inertia_, gravity_, ripple_, load_;
};

}  // namespace ripplenotch
