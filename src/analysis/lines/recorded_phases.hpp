// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: does a line begin at the same angle of the joint in every recording?

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

/// Phases can be tied between recordings that have a position; the others have no say.
class RecordedPhases {
  public:
    explicit RecordedPhases(std::span<const TraceView> logs);

    /// Phases of an order at like speeds and in the same direction, for the phase of a line depends on both.
    /// They disagree when chance makes as much of their errors less than once in a thousand cases and they
    /// are 20 deg apart or more; a gear under load may turn the ripple by 0.05 deg of the joint. Empty where
    /// they agree, or where fewer than two recordings show the line so.
    [[nodiscard]] std::optional<Disagreement> about(const Line& line) const;

  private:
    struct Recording {
        std::size_t number = 0;  ///< as handed over, from 0
        std::vector<Sweep> sweeps;
    };
    struct Phasor;
    struct Phase;
    [[nodiscard]] std::vector<Phase> phases_of(double order_output) const;
    [[nodiscard]] static Phasor phasor_of(const Sweep& sweep, double order_output);
    [[nodiscard]] static std::optional<Phase> phase_at(std::size_t number, std::span<const Phasor> seen,
                                                       double speed_deg_s);

    std::vector<Recording> recordings_;
};

}  // namespace ripplenotch
