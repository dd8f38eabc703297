// SPDX-License-Identifier: MIT
#include "ripplenotch/design/transient.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double longest_run = 5e7;  // samples; about half a second of work per section

constexpr std::size_t samples_a_look = 32;        // by hand: each look costs
constexpr double least_overshoot_percent = 1e-6;  // less is rounding
constexpr double for_rounding = 1.25;  // of the bound, which is good to nine digits where it is used
constexpr double least_band = 1e-6;  // of the final value; in less the rounding of the run itself would show
constexpr double most_cancelling = 1e6;  // by hand: ten of a double's digits are left

/// What is still to come of a step response at most. It is target + sum of residue p^k over the poles p: with
/// their magnitudes for residues and poles that is a bound which no later sample passes.
class Remainder {
  public:
    explicit Remainder(std::span<const Biquad> cascade) {
        for (const Biquad& f : cascade) {
            const std::complex<double> root = std::sqrt(std::complex<double>(f.a1 * f.a1 / 4.0 - f.a2));
            add(cascade, f, -f.a1 / 2.0 + root);
            add(cascade, f, -f.a1 / 2.0 - root);
        }
    }

    /// From the next sample to be looked at on; infinite where poles lie so close that their residues cancel.
    [[nodiscard]] double bound(double target) const {
        double sum = 0.0, largest = 0.0;
        for (const Mode& mode : modes_) {
            sum += mode.now;
            largest = std::max(largest, mode.first);
        }
        const bool good = std::isfinite(sum) && largest <= most_cancelling * std::abs(target);
        return good ? for_rounding * sum : std::numeric_limits<double>::infinity();
    }

    void pass_samples() {
        for (Mode& mode : modes_) mode.now *= mode.decay;
    }

  private:
    struct Mode {
        double first, now,
            decay;  ///< magnitudes at sample 0 and here, and by how much it falls until the next look
    };

    void add(std::span<const Biquad> cascade, const Biquad& own, std::complex<double> pole) {
        std::complex<double> residue = 1.0 / (pole - 1.0);
        for (const Biquad& f : cascade) {
            residue *= (f.b0 * pole + f.b1) * pole + f.b2;
            residue /= &f == &own ? 2.0 * pole + f.a1 : (pole + f.a1) * pole + f.a2;
        }
        const double size = std::abs(residue);
        modes_.push_back({size, size, portable::pow(std::abs(pole), static_cast<double>(samples_a_look))});
    }

    std::vector<Mode> modes_;
};

}  // namespace

std::size_t samples_to_settle(std::span<const Biquad> cascade, double remainder) {
    const double radius = pole_radius(cascade);
    if (!(radius < 1.0)) raise<UsageError>("the filter is unstable: a pole at radius {}", shortest(radius));
    // What is left after n samples is at most about (n / tau)^(order - 1) / (order - 1)! * exp(-n / tau).
    // Three more time constants per order make up for the polynomial, twenty for unfavourable residues.
    const double orders = 2.0 * static_cast<double>(cascade.size());
    const double time_constants = 20.0 - portable::log(remainder) + 3.0 * orders;
    const double count = radius < 1e-3 ? 0.0 : time_constants / -portable::log(radius);
    if (!(count < longest_run)) {
        raise<UsageError>(
            "the filter needs {:.3g} samples to settle, too many to measure (limit {:.3g}); its Q is "
            "too high or its cut-off too low for this sample rate",
            count, longest_run);
    }
    return static_cast<std::size_t>(count) + 8 * cascade.size() + 8;
}

StepFigures measure_step(std::span<const Biquad> cascade, Hertz sample_rate, double band_percent) {
    if (!(band_percent > 0.0 && band_percent < 100.0)) {
        raise<UsageError>("settling band {} % is outside 0 to 100 %", shortest(band_percent));
    }
    if (!(sample_rate.value() > 0.0)) {
        raise<UsageError>("the sample rate is {} Hz; it must be above 0 Hz", shortest(sample_rate.value()));
    }
    double target = 1.0;
    for (const Biquad& f : cascade) target *= dc_gain(f);
    const double band = std::abs(target) * band_percent / 100.0;
    const std::size_t count = samples_to_settle(cascade, band_percent / 100.0);
    std::vector<BiquadState> states(cascade.size());
    std::size_t settled = 0;
    double peak = 0.0;
    Remainder remainder(cascade);
    for (std::size_t k = 0; k < count; ++k) {
        if (k > 0 && k % samples_a_look == 0 && band >= least_band * std::abs(target)) {
            remainder.pass_samples();
            const double rest = remainder.bound(target);
            const double matters =
                std::max(peak - 1.0, 0.01 * least_overshoot_percent / 2.0) * std::abs(target);
            if (rest <= band && rest <= matters) break;
        }
        double y = 1.0;
        for (std::size_t i = 0; i < cascade.size(); ++i) y = step(cascade[i], states[i], y);
        if (!(std::abs(y - target) <= band)) settled = k + 1;
        peak = std::max(peak, y / target);
    }
    const double overshoot = 100.0 * (peak - 1.0);
    return {Seconds(static_cast<double>(settled) / sample_rate.value()),
            overshoot > least_overshoot_percent ? overshoot : 0.0};
}

}  // namespace ripplenotch
