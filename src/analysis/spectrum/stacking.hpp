// SPDX-License-Identifier: MIT
#pragma once
// Internal to analysis: a stack that is made in parts, from as many threads as there are.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/analysis/stack.hpp"

namespace ripplenotch {

/// stack_sweeps in parts of the sweeps. The parts are the same on any number of threads, so the bytes are.
class Stacking {
  public:
    /// The sweeps and the rule must outlive it.
    Stacking(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule);

    [[nodiscard]] std::size_t parts() const { return parts_.size(); }
    /// Of each part once, in any order.
    void run(std::size_t part);
    /// When all parts ran; the last call.
    [[nodiscard]] Stack stack();

  private:
    struct Part {
        std::size_t first = 0, end = 0;  ///< sweeps
        /// By bin: sums over the sweeps, as Stack has their means.
        std::vector<double> ratio, amplitude, floor, weight, square;
        std::size_t low = 0, high = 0;  ///< bins that a sweep reaches
    };
    void add(std::size_t sweep, Part& part);

    std::span<const Sweep> sweeps_;
    const StackRule& rule_;
    Stack stack_;
    std::size_t bins_ = 0;
    double slow_deg_s_ = 1e300, quick_deg_s_ = 0.0;  ///< quartiles of the slowest and the quickest sweep
    std::vector<Part> parts_;
};

}  // namespace ripplenotch
