// SPDX-License-Identifier: MIT
#pragma once
// How large the ripple of a known gear is at each of its orders, in one or several torque signals along the
// same motion, as their rows go by.

#include <complex>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// The result of RippleMeter for one order.
struct OrderLevel {
    double order = 0.0;
    double mean_hz = 0.0;              ///< mean of n Kg |v| / 360 over the windows
    std::vector<double> amplitude_nm;  ///< per signal, zero to peak, rms over windows; nan without any
    std::optional<double>
        expected_gain;  ///< remaining share of the line behind the filter of LineGains, rms over windows
    std::size_t windows = 0;  ///< windows that hold the order
};

struct RippleLevels {
    std::vector<OrderLevel> orders;
    std::vector<double> residual_rms_nm;           ///< per signal: torque minus the window's trend
    std::vector<double> residual_peak_to_peak_nm;  ///< per signal: the same, median over windows
    std::vector<double> ripple_peak_to_peak_nm;    ///< per signal: of the fitted orders alone, largest window
    std::size_t windows = 0;                       ///< windows in which at least one order was measured
    std::size_t windows_too_few_samples = 0;       ///< left out: fewer than two samples per unknown
    double measured_share = 0.0;                   ///< rows in windows / rows seen
};

/// Complex gains of a filter for the lines of all orders at one joint speed, in the order of the meter's
/// orders.
using LineGains = std::function<void(double speed_deg_s, std::span<std::complex<double>> gains)>;

/// The segments and the fit of estimate_ripple(), for rows that go by. Signals are measured in the same
/// segments, so that ratios are attenuations; noise is not subtracted. Holds 65,536 rows at most: a run of
/// motion that is longer goes on in the next ones, half a window before their end.
class RippleMeter {
  public:
    /// `gains`: computes the expected gain of a filter at the speeds of the windows that are measured. Throws
    /// UsageError unless ratio, sample_rate and all orders are above 0 and signals is at least 1.
    RippleMeter(GearRatio ratio, std::span<const Order> orders, Hertz sample_rate, std::size_t signals,
                LineGains gains = {});
    ~RippleMeter();
    RippleMeter(RippleMeter&&) noexcept;
    RippleMeter& operator=(RippleMeter&&) noexcept;

    /// position_deg may be nullptr: then the angle is integrated velocity. `torque_nm` has one value per
    /// signal.
    void add(Seconds time, double velocity_deg_s, const double* position_deg,
             std::span<const double> torque_nm);
    /// A gap: what comes next does not continue the window under way.
    void split();
    [[nodiscard]] RippleLevels levels() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace ripplenotch
