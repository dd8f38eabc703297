// SPDX-License-Identifier: MIT
#pragma once
// Reasons against a finding: in itself, from an unexplained residual, and from other findings.

#include <cstddef>
#include <string_view>
#include <vector>

#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

// Whether the torque that a finding explains is present wherever the finding acts. The coefficient of a real
// effect is the same early and late in the log, back and forth, slow and fast; that of one which only
// resembles a missing effect is not.

struct Unevenness {
    /// rms by which the finding's size, estimated apart in each place, differs from the size it was given,
    /// beyond chance and as a part of that size.
    double part = 0.0;
    std::string_view where;  ///< the intervals, as text
};

/// The worst of several ways of cutting the log into places: by time, by speed and direction, and within
/// short stretches, where only the change of the torque counts and not its mean. `term` is of `stated`.
[[nodiscard]] Unevenness unevenness(const ModelBench& bench, const Model& stated, std::size_t term);

/// Sets status and reason from the finding's own evidence, which must be filled in; confirmed when there is
/// no reason against it. `term`: its index in the model.
void doubt_alone(Finding& finding, const ModelBench& bench, const Candidate& model, std::size_t term);

/// The same for its size alone, with the reported values: true, and unidentifiable, where the error covers
/// it.
[[nodiscard]] bool doubt_size(Finding& finding, const Candidate& told, std::size_t term);

/// Where more is left over than a finding explains, it may have fed on that. `excess_nm`: of excess_of().
void doubt_for_residual(Finding& finding, double excess_nm, const ModelBench& bench,
                        const std::vector<ResidualRegion>& unexplained);

/// A finding that is slight compared with a far larger one may only be a correction term for the form of that
/// one. One whose torque is large, and of which others explain much because they resemble it, is no such
/// term.
void doubt_for_size(Finding& finding, const std::vector<Finding>& findings);

/// Repeats the tests without the uncertain findings: together with a surrogate of its kind a finding may pass
/// that does not by itself. True when one became uncertain.
[[nodiscard]] bool doubt_beside(const ModelBench& bench, const Candidate& kept, std::size_t own_terms,
                                std::vector<Finding>& findings);

/// rms of the residual above the noise.
[[nodiscard]] double excess_of(const ModelBench& bench, const Model& stated);

/// True for findings that are named, alone or as one side of a tie.
[[nodiscard]] bool is_trusted(const Finding& finding);
/// True for findings that are reported but not accepted: they are not in the improved model.
[[nodiscard]] bool is_doubtful(const Finding& finding);

}  // namespace ripplenotch
