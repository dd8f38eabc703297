// SPDX-License-Identifier: MIT
#pragma once
// Whether what a finding explains is there wherever the finding acts. The coefficient of a real effect is the
// same early and late in the log, forth and back, slow and fast; that of one which only looks like what is
// missing is not.

#include <string_view>

#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

struct Unevenness {
    /// rms by which the finding's size, estimated apart in each place, differs from the size it was given,
    /// beyond chance and as a part of that size.
    double part = 0.0;
    std::string_view where;  ///< what the places are, in words
};

/// The worst of several ways of cutting the log into places: by time, by speed and direction, and within
/// short stretches, where only the change of the torque counts and not its mean. `term` is of `stated`.
[[nodiscard]] Unevenness unevenness(const ModelBench& bench, const Model& stated, std::size_t term);

}  // namespace ripplenotch
