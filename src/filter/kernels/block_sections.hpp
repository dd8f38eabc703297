// SPDX-License-Identifier: MIT
#pragma once
// A cascade in block form on a stream that comes in pieces of any length.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

// Two sections in series, eight samples at a time: outputs and the next memory as sums over eight inputs and
// the memory before. No output waits for another, so the work fills vector registers where the recursion
// waits for itself.

/// y = feed x + recall s, s' = drive x + turn s, by columns. The memory s is that of step(), s1 and s2 of the
/// first section and then of the second, so that either form can go on where the other stopped.
struct BlockForm {
    static constexpr std::size_t samples = 8;
    static constexpr std::size_t memory = 4;
    using Outputs = std::array<double, samples>;
    using Memory = std::array<double, memory>;

    /// At most two sections. Coefficients come from step() itself.
    explicit BlockForm(std::span<const Biquad> sections);

    alignas(32) std::array<Outputs, samples> feed{};   ///< by input
    alignas(32) std::array<Outputs, memory> recall{};  ///< by memory
    alignas(32) std::array<Memory, samples> drive{};   ///< by input
    alignas(32) std::array<Memory, memory> turn{};     ///< by memory
};

// The inner loop of the block form.

/// One BlockForm on its way.
struct BlockPass {
    BlockForm form;
    alignas(32) BlockForm::Memory memory{};
};

/// out = origin + F(in - origin) for whole groups of BlockForm::samples, through all passes, of which there
/// is one at least; sizes are equal, and the spans may not overlap. False, with the memories as before and
/// nothing of use in `out`, where an input or a memory is so large, or no number, that an input could affect
/// an output before it (zero times infinity is no zero), unless `whatever` demands a run in any case.
[[nodiscard]] bool run_groups(std::span<BlockPass> passes, std::span<const double> in, double origin,
                              std::span<double> out, bool whatever = false);

/// Groups of samples are counted from the start of the run, not of the piece, and an output is the same sum
/// whether or not its group is complete yet: so the bits do not depend on the pieces.
class BlockCascade {
  public:
    /// One section at least.
    explicit BlockCascade(std::span<const Biquad> sections);

    /// Settled at a constant input; sections have unity gain at 0 Hz.
    void start(double origin);
    /// The next samples; sizes are equal, and the spans may not overlap.
    void run(std::span<const double> in, std::span<double> out);

  private:
    static constexpr std::size_t group = BlockForm::samples;
    bool run_whole(std::span<const double> in, std::span<double> out, bool whatever = false);
    void run_group_by_output(std::span<double> out, std::size_t from, std::size_t to);

    std::vector<BlockPass> passes_;
    std::vector<BlockForm::Memory> before_;  ///< memories to go back to
    std::array<double, group> inputs_{};     ///< inputs of the incomplete group
    std::size_t known_ = 0;                  ///< how many of them
    double origin_ = 0.0;
};

// How far the block form is from the recursion, found out before the first sample.

/// Outputs may differ by this share of the largest |torque|, and no cascade whose trial comes near is
/// filtered in blocks.
inline constexpr double most_block_difference = 1e-12;

/// The largest |block form - run_serial| on a trial: signals between -1 and 1 that are loud to a rounding
/// error, each for many time constants. Constants are the worst, for then every sample is rounded in the same
/// direction; then signs that turn when the impulse response does, and noise. Infinite for poles within a
/// thousandth of the circle, which are not tried.
[[nodiscard]] double trial_difference(std::span<const Biquad> sections);

/// There is a section, and trial_difference() with its reserve is within most_block_difference.
[[nodiscard]] bool block_form_serves(std::span<const Biquad> sections);

}  // namespace ripplenotch
