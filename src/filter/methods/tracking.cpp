// SPDX-License-Identifier: MIT
// One notch per order, retuned at every sample from the joint speed.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "design/tracking_run.hpp"
#include "filter/method.hpp"
#include "filter/ripple_keys.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {
    gear_ratio_key,
    orders_key,
    joint_key,
    Key{.name = "q",
        .above = 0.0,
        .help = "centre over -3 dB width of each order; 1.7 when not given. Alone, it holds at any speed"},
    Key{.name = "max-delay",
        .dimension = Dimension::time,
        .above = 0.0,
        .help = "of each order's notch: slower lines, whose notch would delay longer, get a narrower one; "
                "4.5ms when "
                "neither this nor q is given"},
    Key{.name = "depth",
        .dimension = Dimension::decibel,
        .above = 0.0,
        .help = "attenuation at the centre, e.g. 40dB; a full null when not given"},
    Key{.name = "weights",
        .kind = KeyKind::list,
        .at_least = 0.0,
        .at_most = 1.0,
        .help = "share of each order that is removed, one per order, e.g. 1:0.5"},
    Key{.name = "composite",
        .default_text = "single",
        .choices = "single double triple",
        .help = "how many narrower notches side by side make up one of this width"},
    Key{.name = "min",
        .dimension = Dimension::frequency,
        .default_text = "4Hz",
        .above = 0.0,
        .help = "no centre goes below this"},
    Key{.name = "fade",
        .dimension = Dimension::frequency,
        .default_text = "1.5Hz",
        .at_least = 0.0,
        .help = "low=fade: the share rises from 0 at min to all of it at min + fade"},
    Key{.name = "low",
        .default_text = "fade",
        .choices = "fade park",
        .help = "slower than min: fade (out above it already) or park (the centre stays at min, the depth "
                "ends at a quarter of it)"},
    Key{.name = "speed-lowpass",
        .dimension = Dimension::frequency,
        .above = 0.0,
        .help = "first-order low-pass on the speed; none when not given"},
    Key{.name = "slew",
        .above = 0.0,
        .at_most = 1.0,
        .help = "largest change of a centre from one sample to the next, as a share, e.g. 0.05; unlimited "
                "when not given"},
};

// Chosen by measurement: docs/methods/tracking.md.
constexpr double usual_q = 1.7, usual_max_delay_s = 0.0045;

// n notches of bandwidth B/n side by side have the width of one of bandwidth B. ArduPilot's definition of the
// bandwidth, B = 2 (f - f_low) with f_low the lower -3 dB edge: Q = f f_low / (f^2 - f_low^2).
double q_of_each(double q, double count) {
    const double low = (std::sqrt(1.0 + 4.0 * q * q) - 1.0) / (2.0 * q);  // f_low / f
    const double each = 1.0 - (1.0 - low) / count;
    return each / (1.0 - each * each);
}

std::vector<double> spread_of(double q, std::size_t count) {
    if (count == 1) return {1.0};
    const double low = (std::sqrt(1.0 + 4.0 * q * q) - 1.0) / (2.0 * q);
    const double aside = 2.0 * (1.0 - low) / 32.0;
    if (count == 2) return {1.0 - aside, 1.0 + aside};
    return {1.0 - aside, 1.0, 1.0 + aside};
}

TrackingDesign tracking_design(const Settings& settings, Hertz sample_rate) {
    const RippleOrders ripple = ripple_orders("tracking", settings);
    TrackingDesign p;
    p.gear_ratio = ripple.gear_ratio;
    p.orders = ripple.orders;
    p.weights = per_order("tracking", settings, "weights", ripple, 1.0);
    p.sample_rate_hz = sample_rate.value();
    const double q = settings.has("q") ? settings.number("q") : usual_q;
    // A notch delays by 1 / (2 pi f Q).
    if (settings.has("max-delay") || !settings.has("q")) {
        const double max_delay_s =
            settings.has("max-delay") ? settings.number("max-delay") : usual_max_delay_s;
        p.narrow_hz = 1.0 / (2.0 * std::numbers::pi * q * max_delay_s);
    }
    const std::string composite = settings.text("composite");
    const std::size_t count = composite == "triple" ? 3 : composite == "double" ? 2 : 1;
    p.q_each = q_of_each(q, static_cast<double>(count));
    p.spread = spread_of(q, count);
    if (settings.has("depth")) p.depth_gain = portable::pow(10.0, -settings.number("depth") / 20.0);
    p.min_hz = settings.number("min");
    p.fade_hz = settings.number("fade");
    p.parks = settings.text("low") == "park";
    if (!(p.min_hz < full_below_rate * p.sample_rate_hz)) {
        raise<UsageError>("method tracking, min: {} Hz is not below {} Hz, which is {} of the sample rate",
                          shortest(p.min_hz), shortest(full_below_rate * p.sample_rate_hz),
                          shortest(full_below_rate));
    }
    if (settings.has("speed-lowpass")) {
        const double cutoff_hz = settings.number("speed-lowpass");
        p.speed_pole = portable::exp(-2.0 * std::numbers::pi * cutoff_hz / p.sample_rate_hz);
    }
    if (settings.has("slew")) p.slew = settings.number("slew");
    return p;
}

RunningDesign running(const Settings& settings, Hertz sample_rate) {
    return tracking_design(settings, sample_rate);
}

struct PortableMath {
    using rn_real = double;
    static double rn_sqrt(double value) { return std::sqrt(value); }
    static double rn_warped(double center_hz, double relative, double sample_rate_hz) {
        return portable::tan(std::numbers::pi * center_hz * relative / sample_rate_hz);
    }
};

class TrackingFilter final : public CausalFilter {
  public:
    explicit TrackingFilter(const TrackingDesign& design) : run_(design) {}

    void process(const Samples& in, std::span<double> out) override {
        for (std::size_t k = 0; k < out.size(); ++k)
            out[k] = run_.next(in.torque_nm[k], in.velocity_deg_s[k]);
    }
    void restart() override { run_.restart(); }

  private:
    TrackingRun<PortableMath> run_;
};

std::unique_ptr<CausalFilter> start(const Settings& settings, Hertz sample_rate, const CandidateTable*) {
    return std::make_unique<TrackingFilter>(tracking_design(settings, sample_rate));
}

// Wider and narrower notches.
Trials trials(const TrialConditions&) {
    return {{{""}, {",max-delay=2ms"}, {",max-delay=10ms"}, {",q=2.5"}, {",q=1"}}};
}

// TrackingRun: its notches, and a new centre for each order.
double multiplications(const Settings& settings, const CandidateTable*) {
    const std::string composite = settings.text("composite");
    const double notches = composite == "triple" ? 3.0 : composite == "double" ? 2.0 : 1.0;
    constexpr double of_notch = 6.0, of_retuned_notch = 9.0 + circle_multiplications, of_order = 13.0;
    return 1.0 + static_cast<double>(ripple_orders("tracking", settings).orders.size()) *
                     (of_order + notches * (of_notch + of_retuned_notch));
}

FrozenFilter frozen(const Settings& settings, Hertz sample_rate, const CandidateTable*, DegPerSec speed) {
    const TrackingDesign p = tracking_design(settings, sample_rate);
    TrackingRun<PortableMath> run(p);
    FrozenFilter filter;
    for (std::size_t i = 0; i < p.orders.size(); ++i) {
        const int line = static_cast<int>(i);
        const double hz = run.rn_hz(line, speed.value()), center_hz = run.rn_center(hz);
        const double left = run.rn_left(line, hz);
        if (left >= 1.0) continue;
        for (const double relative : p.spread) {
            NotchSpec notch{.center = Hertz(center_hz * relative), .q = run.rn_q(center_hz)};
            if (left > 0.0) notch.depth_db = -20.0 * portable::log10(left);
            filter.cascade.push_back(design_notch(notch, sample_rate));
        }
        filter.note += fmt::format("{}{:.4g} Hz", filter.note.empty() ? "notches at " : ", ", center_hz);
        if (left > p.depth_gain) filter.note += fmt::format(" (gain {:.3g} at the centre)", left);
    }
    if (filter.note.empty()) filter.note = "too slow for any notch: passes";
    return filter;
}

}  // namespace

const Method filter_methods::tracking = {
    .name = "tracking",
    .summary = "one notch per order, retuned at every sample from the joint speed",
    .source =
        "trapezoidal state-variable form (Zavalishin); weight and fade as Betaflight's rpm_filter, parking "
        "and composite notches as ArduPilot's harmonic notch",
    .noun = "tracking notches",
    .keys = keys,
    .start = start,
    .frozen = frozen,
    .running = running,
    .trials = trials,
    .multiplications = multiplications,
};

}  // namespace ripplenotch
