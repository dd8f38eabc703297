// SPDX-License-Identifier: MIT
#include "ripplenotch/fleet/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/matrices/normal_errors.hpp"
#include "fleet/features/joint_fit.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_feature_samples = std::size_t{1} << 14U;  // by hand: bounds the time of a log
constexpr std::size_t most_orders = 6;                               // by hand: bounds the time of a log
constexpr double widest_phase_deg = 45.0;                            // half of its interval

Descriptor untold(std::string stem, std::string unit, std::string reason) {
    return {std::move(stem), std::move(unit), {}, {}, std::move(reason)};
}

Descriptor ratio_of(const Identification& found) {
    const GearRatioFit& fit = found.gear_ratio;
    if (!fit.value) return untold("gear_ratio", "", found.verdict);
    return {"gear_ratio", "", fit.value, Interval{fit.ci95_low, fit.ci95_high}, {}};
}

Descriptor resonance_of(const Identification& found) {
    if (found.hums.empty())
        return untold("resonance", "hz", "no band of frequencies holds more torque than the lines");
    const Hum& hum = found.hums.front();
    return {"resonance", "hz", hum.peak_hz, Interval{hum.from_hz, hum.to_hz}, {}};
}

Descriptor noise_of(const JointFit& joint) {
    const double noise_nm = joint.noise_nm();
    if (!(noise_nm > 0.0))
        return untold("noise_floor", "nm", "the torque holds its values from sample to sample");
    return {"noise_floor", "nm", noise_nm, {}, {}};
}

// Amplitude and phase at one order.
void add_ripple(const RippleEstimate& one, bool has_position, std::vector<Descriptor>& all) {
    const std::string stem = "ripple_" + shortest(one.order);
    Descriptor amplitude = untold(stem + "_amplitude", "nm", one.insufficient);
    Descriptor phase = untold(stem + "_phase", "deg", one.insufficient);
    const double half_deg = normal_95_errors * one.phase_standard_error_deg;
    if (one.present()) {
        const double half_nm = normal_95_errors * one.standard_error_nm;
        amplitude.value = one.amplitude_nm;
        amplitude.ci95 = Interval{std::max(one.amplitude_nm - half_nm, 0.0), one.amplitude_nm + half_nm};
    } else if (one.searched()) {
        amplitude.reason = fmt::format("no ripple above {:.2g} Nm", one.detectable_nm);
    }
    if (one.searched() && !has_position)
        phase.reason = "the log has no position, and so no angle to count from";
    else if (one.searched() && !(one.present() && one.phase_deg && half_deg < widest_phase_deg))
        phase.reason = one.present() ? "the phase is not the same along the log"
                                     : "the amplitude is too small for a phase";
    if (phase.reason.empty()) {
        phase.value = one.phase_deg;
        phase.ci95 = Interval{*one.phase_deg - half_deg, *one.phase_deg + half_deg};
    }
    all.push_back(std::move(amplitude));
    all.push_back(std::move(phase));
}

// Of the ripple: what is stated, else what was found.
std::optional<GearAccount> gear_of_ripple(const Identification& found,
                                          const std::optional<GearAccount>& stated) {
    std::optional<GearAccount> gear = stated ? stated : found_gear(found);
    if (gear && gear->orders.size() > most_orders) gear->orders.resize(most_orders);
    return gear;
}

}  // namespace

Features features_of(const TraceView& log, const Identification& found,
                     const std::optional<GearAccount>& stated) {
    const Motion whole = motion_along(log);
    const std::vector<unsigned char> known = rows_of_known_motion(log, whole);
    const FittedSamples samples = thinned(whole, log.torque_nm, known, most_feature_samples);
    MotionFacts facts = motion_facts(samples.motion, samples.torque_nm, log.has_position());
    facts.accelerations = accelerations_of(log, whole, known);
    std::optional<GearAccount> gear = gear_of_ripple(found, stated);
    std::vector<RippleEstimate> ripple;
    if (gear) {
        ripple = estimate_ripple({&log, 1}, gear->ratio, gear->orders);
        gear->orders.clear();
        for (const RippleEstimate& one : ripple)
            if (one.searched()) gear->orders.emplace_back(one.order);
    }
    const JointFit joint(samples, facts, std::move(gear));
    Features features{facts.mix, {}};
    features.mix.load_rms_nm = joint.load_rms_nm();
    features.descriptors.push_back(ratio_of(found));
    for (const RippleEstimate& one : ripple) add_ripple(one, log.has_position(), features.descriptors);
    for (Descriptor& one : joint.torques()) features.descriptors.push_back(std::move(one));
    features.descriptors.push_back(noise_of(joint));
    features.descriptors.push_back(resonance_of(found));
    return features;
}

}  // namespace ripplenotch
