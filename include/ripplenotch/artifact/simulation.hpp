// SPDX-License-Identifier: MIT
#pragma once
// What simulate says about a log that it made: enough to make it again, and what to expect in it.

#include <cstdint>
#include <string>
#include <vector>

#include "ripplenotch/artifact/document.hpp"
#include "ripplenotch/core/units.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

struct Simulation {
    Model model;
    std::vector<std::string> motions;  ///< specifications, in sequence
    Hertz sample_rate;
    std::uint64_t seed = 0;
    NewtonMeters noise_rms;
    DegPerSec velocity_noise_rms;
    std::size_t rows = 0;
    std::vector<std::string> columns;
    double torque_min_nm = 0.0, torque_max_nm = 0.0;      ///< as written, noise and rounding included
    double speed_min_deg_s = 0.0, speed_max_deg_s = 0.0;  ///< of |v|, as written
    std::string output, output_sha256;                    ///< file written and the hash of its bytes
};

/// {"schema": "ripplenotch/simulation/1", ...}; the model is written as in model.json.
[[nodiscard]] std::string write_simulation(const Simulation& simulation, const Provenance& provenance);

}  // namespace ripplenotch
