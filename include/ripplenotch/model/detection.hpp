// SPDX-License-Identifier: MIT
#pragma once
// Detection of a converter effect in a log: whether it is present, and which samples it invalidates. No model
// of the joint is needed for that.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

/// In units of the noise: finer steps of a log are dithered by the noise and bend nothing, so that a log of
/// four decimals has no fault.
inline constexpr double step_of_noise = 1.5;

/// A log as Effect::detect sees it. Spans have motion.size() entries.
struct LoggedTorque {
    const Motion& motion;  ///< as measured
    std::span<const double> torque_nm;
    std::span<const unsigned char> use;  ///< 0: does not count, be it for what an earlier detector found
    double moving_deg_s = 0.0;           ///< slower samples count as resting
    double step_nm = 0.0;   ///< distance of the values of a log that holds few; 0: as good as continuous
    double noise_nm = 0.0;  ///< rms, from second differences
};

struct DetectedFault {
    std::vector<double> values;  ///< values of the effect's parameters, in their order; bounds are ignored
    std::vector<std::size_t> spoiled;  ///< samples that do not hold the joint's torque, rising
    std::string words;                 ///< what was seen, for people
};

}  // namespace ripplenotch
