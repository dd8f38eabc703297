// SPDX-License-Identifier: MIT
#pragma once
// What simulate says about a log that it made: enough to make it again, and what to expect in it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/export/target.hpp"
#include "ripplenotch/model/effect.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// What `export` wrote and what came back when it was read again.

struct ExportReport {
    std::string target;  ///< as it would be typed again, with its keys
    std::string file;    ///< as given to -o
    std::size_t bytes = 0;
    Hertz sample_rate;
    std::size_t bands = 0, sections_per_band = 0;
    std::vector<std::string> warnings;
    std::string usage;       ///< one line to paste; may be empty
    std::string arithmetic;  ///< "float32, state-variable form"
    std::vector<SectionCheck> checks;
    std::vector<std::string> violations;
};

[[nodiscard]] std::string export_report_to_json(const ExportReport& report, const Provenance& provenance);

// The catalogue of effects for programs: what ripplenotch diagnose --effects --json prints.

/// {"schema": "ripplenotch/effects/1", "effects": [...]}; docs/commands/diagnose.md names the fields.
[[nodiscard]] std::string write_catalogue(std::span<const Effect* const> effects,
                                          const Provenance& provenance);

/// The log along whose motion a simulation ran, and how far it is from the torque measured there.
struct Followed {
    Seconds smoothing;
    double measured_rms_nm = 0.0;  ///< of the log's torque
    double residual_rms_nm =
        0.0;  ///< of the log's torque less the model's, without noise, chance and rounding
};

struct Simulation {
    Model model;
    GearAccount gear;                  ///< of the model
    std::vector<std::string> motions;  ///< specifications, in sequence
    Hertz sample_rate;
    std::uint64_t seed = 0;
    std::optional<Followed> followed;  ///< then motions is empty
    NewtonMeters noise_rms;
    double noise_correlation = 0.0;
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
