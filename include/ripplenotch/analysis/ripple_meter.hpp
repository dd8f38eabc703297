// SPDX-License-Identifier: MIT
#pragma once
// Ripple amplitude per order of one or several torque signals along the same motion, in bounded memory: least
// squares of trend and orders in the motor angle over windows of whole motor turns.

#include <complex>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

struct OrderLevel {
    double order = 0.0;
    double mean_hz = 0.0;                 ///< mean of n Kg |v| / 360 over the windows
    std::vector<double> amplitude_nm;     ///< per signal, zero to peak, rms over windows
    std::optional<double> expected_gain;  ///< what expect()'s filter leaves of the line, rms over windows
};

struct RippleLevels {
    std::vector<OrderLevel> orders;
    std::vector<double> residual_rms_nm;           ///< per signal: torque minus the window's trend
    std::vector<double> residual_peak_to_peak_nm;  ///< per signal: the same, median over windows
    std::vector<double> ripple_peak_to_peak_nm;    ///< per signal: of the fitted orders alone, largest window
    std::size_t windows = 0;                       ///< how many windows of usable motion were measured
    std::size_t windows_too_few_samples = 0;       ///< dropped: highest order with under 3 samples a period
    std::size_t windows_too_slow = 0;              ///< dropped: slower than half a motor turn per second
    double measured_share = 0.0;                   ///< samples in windows / samples seen
};

/// Complex gains of a filter for the lines of all orders at one joint speed, in the order of the meter's
/// orders.
using LineGains = std::function<void(double speed_deg_s, std::span<std::complex<double>> gains)>;

/// Feed rows in order; ask at the end. Signals are measured on the same windows, so that ratios are
/// attenuations.
///
/// A window is eight motor turns in one direction (at least four where a run ends or turns back, or where
/// 2 s have passed). In each,
/// every signal is fitted by c0 + c1 s + c2 s^2 + c3 s^3 + sum of a_n cos(n theta) + b_n sin(n theta), s
/// being rows and theta the motor angle. Motor angle: gear ratio times the joint's position where there is
/// one, since its error does not grow along a window, whereas a velocity that is 1 % off detunes order 2 by a
/// sixth of a cycle in eight turns; else the velocity added up over the rows' times. Position is unwrapped at
/// half turns.
class RippleMeter {
  public:
    /// Throws UsageError unless ratio, sample_rate and all orders are above 0 and signals is at least 1.
    RippleMeter(GearRatio ratio, std::span<const Order> orders, Hertz sample_rate, std::size_t signals);
    ~RippleMeter();
    RippleMeter(RippleMeter&&) noexcept;
    RippleMeter& operator=(RippleMeter&&) noexcept;

    /// position_deg may be nullptr: then the angle is integrated velocity. `torque_nm` has one value per
    /// signal.
    void add(Seconds time, double velocity_deg_s, const double* position_deg,
             std::span<const double> torque_nm);
    /// Works out what a filter should leave at the speeds of the very windows that are measured. Call it
    /// before add().
    void expect(LineGains gains);
    /// A gap: what comes next does not continue the window under way.
    void split();
    [[nodiscard]] RippleLevels levels() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace ripplenotch
