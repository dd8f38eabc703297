// SPDX-License-Identifier: MIT
#pragma once
// A mass on a damped spring, driven by a turning phasor whose frequency changes: what it makes of the drive
// is the steady response at the present frequency and what still rings of frequencies before. Beside it the
// same mass driven by any signal.

#include <complex>
#include <span>

#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

struct Spring {
    double frequency_hz;  ///< of the undamped mass
    double damping;       ///< ratio; 1 is critical
};

/// Response as a factor of the drive, a value a sample; the drive turns `cycles_per_deg` times a degree of
/// the joint. At the first sample the mass has settled. At a constant speed it is the steady response to the
/// last bit: 1 / (1 - u^2 + 2 i damping u), u the frequency of the drive in those of the spring.
void response_of(const Spring& spring, const Motion& motion, double cycles_per_deg,
                 std::span<std::complex<double>> response);

/// What a signal makes of the mass: `values` become its displacements, each as large as the value that would
/// hold it there. Between samples the signal is the polynomial through the nearest six, and it begins
/// settled.
void pass_spring(const Spring& spring, Hertz sample_rate, std::span<double> values);

}  // namespace ripplenotch
