// SPDX-License-Identifier: MIT
#pragma once
// Faults of the recorded torque itself, found before any model: samples that do not hold the joint's torque.

#include <span>
#include <string>
#include <vector>

#include "diagnose/engine/recorded_motion.hpp"
#include "diagnose/engine/saturated_fit.hpp"

namespace ripplenotch::engine {

struct ConverterFault {
    std::string effect;             ///< of the catalogue: "saturation", "dropout", "quantization", "spikes"
    std::vector<std::size_t> rows;  ///< of the log, rising; all of them for quantization: empty
    double size = 0.0;              ///< Nm: the limit, the step; 0 for others
};

/// Quantization, saturation and dropout of a torque; rows that do not hold the joint's torque become 0 in
/// `good`, which has an entry per row.
[[nodiscard]] std::vector<ConverterFault> find_converter_faults(std::span<const double> torque_nm,
                                                                std::vector<unsigned char>& good);

/// Samples far from what all smooth laws predict and from their neighbours.
struct FarSamples {
    std::vector<std::size_t> slots;
    bool are_spikes = false;  ///< enough of them stand alone while the joint moves in one direction
};
[[nodiscard]] FarSamples find_spikes(const RecordedMotion& recorded, const SaturatedFit& fit);

}  // namespace ripplenotch::engine
