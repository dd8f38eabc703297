// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {

namespace {

constexpr int highest_order = 20;  // chosen, not derived

void check_low_pass(const LowPassSpec& spec, Hertz sample_rate) {
    if (!std::isfinite(sample_rate.value()) || !(sample_rate.value() > 0.0)) {
        raise<UsageError>("the sample rate is {} Hz; it must be known and above 0 Hz",
                          shortest(sample_rate.value()));
    }
    if (!(spec.cutoff.value() > 0.0)) {
        raise<UsageError>("low-pass cut-off {} Hz is not above 0 Hz", shortest(spec.cutoff.value()));
    }
    if (!(spec.cutoff.value() < 0.5 * sample_rate.value())) {
        raise<UsageError>("low-pass cut-off {} Hz is not below half the sample rate, {} Hz",
                          shortest(spec.cutoff.value()), shortest(0.5 * sample_rate.value()));
    }
    if (spec.order < 1 || spec.order > highest_order) {
        raise<UsageError>("low-pass order {} is outside 1 to {}", spec.order, highest_order);
    }
}

}  // namespace

Cascade design_low_pass(const LowPassSpec& spec, Hertz sample_rate) {
    check_low_pass(spec, sample_rate);
    const double k = portable::tan(std::numbers::pi * (spec.cutoff / sample_rate));
    Cascade cascade;
    if (spec.order % 2 == 1) {
        Biquad f;
        f.a1 = (k - 1.0) / (k + 1.0);
        f.b0 = f.b1 = 0.5 * (1.0 + f.a1);
        cascade.push_back(f);
    }
    for (int pair = 1; pair <= spec.order / 2; ++pair) {
        // Butterworth poles stand at equal angles on a circle; each pair's damping is twice the cosine of its
        // angle.
        const double damping = 2.0 * portable::sin(std::numbers::pi * (2 * pair - 1) / (2.0 * spec.order));
        const double scale = 1.0 / (1.0 + k * (damping + k));
        Biquad f;
        f.a1 = 2.0 * (k * k - 1.0) * scale;
        f.a2 = (1.0 + k * (k - damping)) * scale;
        // Equal to k^2 * scale, but taken from the rounded poles so that the gain at 0 Hz stays 1.
        f.b0 = f.b2 = 0.25 * (1.0 + f.a1 + f.a2);
        f.b1 = 2.0 * f.b0;
        cascade.push_back(f);
    }
    for (const Biquad& f : cascade) {
        if (!(pole_radius(f) < 1.0) || !(f.b0 > 0.0)) {
            raise<UsageError>("a low-pass at {} Hz at a sample rate of {} Hz is too low for double precision",
                              shortest(spec.cutoff.value()), shortest(sample_rate.value()));
        }
    }
    return cascade;
}

namespace {

constexpr double longest_run = 5e7;  // samples; about half a second of work per section

constexpr std::size_t samples_a_look = 32;      // chosen, not derived: each test costs
constexpr double min_overshoot_percent = 1e-6;  // less is rounding
constexpr double for_rounding = 1.25;  // margin on the bound, which is good to nine digits where it is used
// Share of the final value; in less the rounding of the run itself would show.
constexpr double min_band = 1e-6;
constexpr double max_cancelling = 1e6;  // chosen, not derived: ten of a double's digits remain

/// Upper bound of the remaining change of a step response. It is target + sum of residue p^k over the poles
/// p: with their magnitudes for residues and poles that is a bound which no later sample passes.
class Remainder {
  public:
    explicit Remainder(std::span<const Biquad> cascade) {
        for (const Biquad& f : cascade) {
            const std::complex<double> root = std::sqrt(std::complex<double>(f.a1 * f.a1 / 4.0 - f.a2));
            add(cascade, f, -f.a1 / 2.0 + root);
            add(cascade, f, -f.a1 / 2.0 - root);
        }
    }

    /// From the next tested sample on; infinite where poles lie so close that their residues cancel.
    [[nodiscard]] double bound(double target) const {
        double sum = 0.0, largest = 0.0;
        for (const Mode& mode : modes_) {
            sum += mode.now;
            largest = std::max(largest, mode.first);
        }
        const bool good = std::isfinite(sum) && largest <= max_cancelling * std::abs(target);
        return good ? for_rounding * sum : std::numeric_limits<double>::infinity();
    }

    void pass_samples() {
        for (Mode& mode : modes_) mode.now *= mode.decay;
    }

  private:
    struct Mode {
        double first, now,
            decay;  ///< magnitudes at sample 0 and here, and their decay until the next test
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
    // The residual after n samples is at most about (n / tau)^(order - 1) / (order - 1)! * exp(-n / tau).
    // Three more time constants per order make up for the polynomial, twenty for unfavourable residues.
    const double orders = 2.0 * static_cast<double>(cascade.size());
    const double time_constants = 20.0 - portable::log(remainder) + 3.0 * orders;
    const double count = radius < 1e-3 ? 0.0 : time_constants / -portable::log(radius);
    if (!(count < longest_run)) {
        raise<UsageError>(
            "the filter needs {:.3g} samples to settle, too many to measure (limit {:.3g}); its Q is too "
            "high or its cut-off too low for this sample rate",
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
        if (k > 0 && k % samples_a_look == 0 && band >= min_band * std::abs(target)) {
            remainder.pass_samples();
            const double rest = remainder.bound(target);
            const double matters =
                std::max(peak - 1.0, 0.01 * min_overshoot_percent / 2.0) * std::abs(target);
            if (rest <= band && rest <= matters) break;
        }
        double y = 1.0;
        for (std::size_t i = 0; i < cascade.size(); ++i) y = step(cascade[i], states[i], y);
        if (!(std::abs(y - target) <= band)) settled = k + 1;
        peak = std::max(peak, y / target);
    }
    const double overshoot = 100.0 * (peak - 1.0);
    return {Seconds(static_cast<double>(settled) / sample_rate.value()),
            overshoot > min_overshoot_percent ? overshoot : 0.0};
}

namespace {

void check_notch(const NotchSpec& spec, Hertz sample_rate) {
    if (!std::isfinite(sample_rate.value()) || !(sample_rate.value() > 0.0)) {
        raise<UsageError>("the sample rate is {} Hz; it must be known and above 0 Hz",
                          shortest(sample_rate.value()));
    }
    const double half_rate = 0.5 * sample_rate.value();
    if (!(spec.center.value() > 0.0)) {
        raise<UsageError>("notch centre {} Hz is not above 0 Hz", shortest(spec.center.value()));
    }
    if (!(spec.center.value() < half_rate)) {
        raise<UsageError>("notch centre {} Hz is not below half the sample rate, {} Hz",
                          shortest(spec.center.value()), shortest(half_rate));
    }
    if (!(spec.q > 0.0) || !std::isfinite(spec.q)) {
        raise<UsageError>("notch Q {} is not above 0; the paper's twin-T has Q 0.25", shortest(spec.q));
    }
    if (!(spec.depth_db > 0.0)) {
        raise<UsageError>("notch depth {} dB is not above 0 dB; leave it out for a full null",
                          shortest(spec.depth_db));
    }
    if (spec.width == WidthRule::digital && !(spec.center.value() / spec.q < half_rate)) {
        raise<UsageError>(
            "a digital notch at {} Hz with Q {} is {} Hz wide, not below half the sample rate, {} Hz; raise "
            "Q or use the analog width rule",
            shortest(spec.center.value()), shortest(spec.q), shortest(spec.center.value() / spec.q),
            shortest(half_rate));
    }
}

}  // namespace

std::string_view width_rule_name(WidthRule rule) { return rule == WidthRule::analog ? "analog" : "digital"; }

Biquad design_notch(const NotchSpec& spec, Hertz sample_rate) {
    check_notch(spec, sample_rate);
    const double omega = 2.0 * std::numbers::pi * (spec.center / sample_rate);
    const double c = portable::cos(omega);
    // The two rules differ in one number: how far the poles stand inside the unit circle. sin(omega) / (2 Q)
    // is the bilinear image of the prototype's damping; tan(omega / (2 Q)) makes the sampled -3 dB points
    // exactly center / Q hertz apart.
    const double alpha = spec.width == WidthRule::analog ? portable::sin(omega) / (2.0 * spec.q)
                                                         : portable::tan(omega / (2.0 * spec.q));
    const double floor_gain = portable::pow(10.0, -spec.depth_db / 20.0);  // exactly 0 for infinite_depth_db
    const double scale = 1.0 / (1.0 + alpha);
    Biquad f;
    f.b0 = (1.0 + floor_gain * alpha) * scale;
    f.b2 = (1.0 - floor_gain * alpha) * scale;
    f.b1 = f.a1 = -2.0 * scale * c;
    // Equal to (1 - alpha) / (1 + alpha), but tied to the rounded numerator so that the gain at 0 Hz stays 1.
    f.a2 = f.b0 + f.b2 - 1.0;
    if (!(pole_radius(f) < 1.0)) {
        raise<UsageError>(
            "a notch at {} Hz with Q {} at a sample rate of {} Hz is too narrow for double precision",
            shortest(spec.center.value()), shortest(spec.q), shortest(sample_rate.value()));
    }
    return f;
}

SvfSection svf_at(double g, double k) {
    SvfSection svf;
    svf.a1 = 1.0 / (1.0 + g * (g + k));
    svf.a2 = g * svf.a1;
    svf.a3 = g * svf.a2;
    return svf;
}

SvfSection svf_of(const NotchSpec& notch, Hertz sample_rate) {
    const double half = std::numbers::pi * (notch.center / sample_rate), g = portable::tan(half);
    // The digital rule has another damping in the same prototype: alpha = tan(W/(2Q)) instead of sin(W)/(2Q).
    const double k = notch.width == WidthRule::analog
                         ? 1.0 / notch.q
                         : 2.0 * portable::tan(half / notch.q) / portable::sin(2.0 * half);
    const double gain = notch.depth_db >= 6000.0 ? 0.0 : portable::pow(10.0, -notch.depth_db / 20.0);
    SvfSection svf = svf_at(g, k);
    svf.m1 = -(1.0 - gain) * k;
    return svf;
}

}  // namespace ripplenotch
