// SPDX-License-Identifier: MIT
#pragma once
// A part of a model that the user states and that is never searched: the torque of an arm's rigid bodies, or
// of the user's own simulation. Unlike an effect it has columns of the whole log, and values that nobody asks
// for one by one.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

/// Deviation of a value that is stated: so small that nothing moves it.
inline constexpr double stated_deviation = 1e-9;

/// Columns whose values are fitted together with everything else.
struct GivenTerm {
    std::string name;  ///< "arm", "simulated"; "nuisance": stated beside one of them, and nobody's name
    /// One column a value: the torque in newton-metres that one unit of the value brings, an entry per row of
    /// the log.
    std::vector<std::vector<double>> torque_nm;
    /// What is known of each value before the log: drawn towards `mean` as by a measurement with this
    /// standard deviation, in the value's own unit. A deviation of infinity leaves it free.
    std::vector<double> mean, deviation;
};

/// True when one of these, terms or values of them, has the name.
[[nodiscard]] bool is_given(const auto& given, std::string_view name) {
    return std::ranges::any_of(given, [name](const auto& one) { return one.name == name; });
}

}  // namespace ripplenotch
