// SPDX-License-Identifier: MIT
#pragma once
// A mass on a damped spring, driven by a turning phasor whose frequency changes: the response is the steady
// response at the present frequency and the transients of earlier frequencies. Also the same mass driven by
// any signal.

#include <complex>
#include <cstddef>
#include <span>

#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

// The course of a signal between its samples, for delays that are not whole samples and for lags. A held
// value (zero-order hold) would put half a sample of delay into both; here the signal between samples is the
// polynomial through the nearest of them, centred, which delays nothing.

/// values(k) becomes values(k - delay), delay in samples, of either sign. The polynomial goes through 16
/// samples: a component of a fifth of the sample rate comes out with a relative error below 5e-5, one of
/// three tenths below 1e-2. Before the first sample and after the last, the signal is taken as constant.
void shift_samples(std::span<double> values, double delay);

/// The response of a first-order low-pass whose time constant is given in samples, above 0: the differential
/// equation solved exactly for the polynomial through 6 samples. It starts from the steady state of the first
/// value. A component of a tenth of the sample rate comes out with a relative error below 5e-4.
void first_order_lag(std::span<double> values, double time_constant);

// How a mass on a damped spring moves when nothing drives it.

/// Transition of a free mass's displacement within a step, and of its speed in displacements a radian of the
/// undamped spring.
struct FreeMove {
    double at_of_at, at_of_moving, moving_of_moving;  ///< and -at_of_moving from at to moving
};

/// Within so many radians of the undamped spring.
[[nodiscard]] FreeMove free_move(double damping, double radians);

struct Spring {
    double frequency_hz;  ///< natural frequency of the undamped mass
    double damping;       ///< ratio; 1 is critical
};

/// Response as a factor of the drive, a value a sample; the drive turns `cycles_per_deg` times a degree of
/// the joint. At the first sample the mass has settled. At a constant speed it is the steady response to the
/// last bit: 1 / (1 - u^2 + 2 i damping u), u the frequency of the drive in those of the spring.
void response_of(const Spring& spring, const Motion& motion, double cycles_per_deg,
                 std::span<std::complex<double>> response);

/// The response of the mass to a signal: `values` become its displacements, each as large as the value that
/// would hold it there. Between samples the signal is the polynomial through the nearest six, and it begins
/// settled.
void pass_spring(const Spring& spring, Hertz sample_rate, std::span<double> values);

}  // namespace ripplenotch
