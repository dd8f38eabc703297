// SPDX-License-Identifier: MIT
#pragma once
// What a name must be to be believed beside a leftover.

#include <optional>
#include <string>
#include <vector>

#include "diagnose/beside/naming.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// One name under the conditions. Sizes and gains are of the whitened log.
struct BesideFinding {
    Shape shape;
    FindingStatus status = FindingStatus::confirmed;
    std::string reason;  ///< of another status
    std::vector<Decision> decisions;
    OutsideGain gain;  ///< beside the other names
    double price = 0.0;
    double evenness = 0.0;   ///< spread of the folds' sizes beyond their own noise, of the size
    double same_sign = 0.0;  ///< of the folds' weight
    double size_nm = 0.0;    ///< rms of its torque about its mean
    std::optional<Shape> rival;
    double rival_margin = 0.0, rival_t = 0.0;
};

[[nodiscard]] std::vector<BesideFinding> judged_beside(Sums& sums, const Named& now, std::size_t effects);

/// Names and their findings, in the same order; what was withdrawn comes after them.
struct NamedBeside {
    Named now;
    std::vector<BesideFinding> findings;
};
/// Searches, judges, and withdraws the weakest that is tentative, until none is.
[[nodiscard]] NamedBeside named_beside(Sums& sums, std::size_t effects);

}  // namespace ripplenotch
