// SPDX-License-Identifier: MIT
#pragma once
// Internal: how much the lines of a series scatter, as the other joints of the kind show it. Thirty lines
// alone know their scatter to an eighth, and four of them have to stand out of it.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "fleet/trend/joint_history.hpp"
#include "fleet/trend/scan.hpp"

namespace ripplenotch {

/// By the names of scans; without those that nobody else tells.
using ScatterOfSeries = std::map<std::string, Scatter>;

/// Of each history, by the joints of its name on other robots, never by its own lines; worth the more lines
/// the more alike those joints are (G. K. Smyth, Linear models and empirical Bayes methods for assessing
/// differential expression in microarray experiments, 2004).
[[nodiscard]] std::vector<ScatterOfSeries> scatter_of_kin(std::span<const JointHistory> histories);

}  // namespace ripplenotch
