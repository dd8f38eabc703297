// SPDX-License-Identifier: MIT
#pragma once
// What happens to the filters' memories when the supervisor activates another candidate.

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

/// Output at the sample of a change, and the output without the change.
struct Change {
    double now_nm = 0.0;
    double unchanged_nm = 0.0;
};

/// Candidates are counted from 0; no_candidate passes the torque. Every call takes the next samples in order.
class Transition {
  public:
    virtual ~Transition() = default;
    /// Before the first sample of a run: settled at a constant input of `torque_nm`.
    virtual void start(int candidate, double torque_nm) = 0;
    /// Samples without a change. `out` has as many entries as `torque_nm`.
    virtual void run(std::span<const double> torque_nm, std::span<double> out) = 0;
    /// One sample, at which `candidate` becomes active.
    virtual Change change(int candidate, double torque_nm) = 0;
};

/// In the order of the help. Each has its row in docs/methods/switching.md.
inline constexpr std::array<std::string_view, 3> transition_names = {"parallel", "keep-state-variable",
                                                                     "crossfade"};

/// `name` is one of the above; `crossfade_samples` is how long the transition of that name blends.
[[nodiscard]] std::unique_ptr<Transition> make_transition(std::string_view name, std::span<const Band> bands,
                                                          std::size_t crossfade_samples);

}  // namespace ripplenotch
