// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "log/account/account.hpp"
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

// What happens to the filters' memories when the supervisor puts another candidate in force.

/// Output at the sample of a change, and what it would have been without the change.
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
    /// One sample, at which `candidate` comes into force.
    virtual Change change(int candidate, double torque_nm) = 0;
};

/// The candidates' sections, padded with neutral ones to equal length, and which of them are the same filter:
/// changing to an equal filter must not disturb anything.
struct Candidates {
    explicit Candidates(std::span<const Band> bands);

    std::vector<Cascade> cascades;
    std::size_t sections = 0;  ///< of each cascade
    std::vector<int> same_as;  ///< lowest candidate with equal coefficients

    [[nodiscard]] bool same(int a, int b) const noexcept;
};

/// A way is a record: one file in src/filter/transitions, one line in transitions.def.
struct TransitionKind {
    std::string_view name;
    /// `blend_samples`: over which outputs are blended, for ways that blend.
    std::unique_ptr<Transition> (*make)(Candidates candidates, std::size_t blend_samples) = nullptr;
};

namespace transitions {
#define TRANSITION(name) extern const TransitionKind name;
#include "filter/transitions/transitions.def"
#undef TRANSITION
}  // namespace transitions

}  // namespace ripplenotch
