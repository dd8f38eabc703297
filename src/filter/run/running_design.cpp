// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/running_design.hpp"

#include "filter/methods/designs.hpp"

namespace ripplenotch {

std::optional<RunningDesign> running_design(const Method& method, const Settings& settings,
                                            Hertz sample_rate) {
    if (method.name == "tracking") return tracking_design(settings, sample_rate);
    if (method.name == "oscillator") return oscillator_design(settings, sample_rate);
    return std::nullopt;
}

}  // namespace ripplenotch
