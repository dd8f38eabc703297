// SPDX-License-Identifier: MIT
#include "document/fields/result_fields.hpp"

#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

void describe(JsonWriter& json, const GearAccount& gear) {
    json.known("ratio", gear.has_ratio(), gear.ratio);
    json("orders", gear.orders);
    json("source", gear.source);
}

void describe(JsonWriter& json, const RippleEstimate& one) {
    json("order", one.order);
    json.known("amplitude_nm", one.searched(), one.amplitude_nm);
    json.known("standard_error_nm", one.searched(), one.standard_error_nm);
    json.known("detectable_nm", one.searched(), one.detectable_nm);
    json.known("false_alarm", one.searched(), one.false_alarm);
    json("phase_deg", one.phase_deg);
    json.known("present", one.searched(), one.present());
    json.known("slowest_deg_s", one.searched(), one.slowest_deg_s);
    json.known("fastest_deg_s", one.searched(), one.fastest_deg_s);
    json("cycles", one.cycles);
    json("insufficient", one.insufficient, null_if_empty);
}

void describe_switch(JsonWriter& json, const Switch& change, Seconds time) {
    json("time_s", time);
    json("sample", change.sample);
    json("from_band", change.from_band);
    json("to_band", change.to_band);
    json("speed_deg_s", change.speed_deg_s);
    json("jump_nm", change.jump_nm);
}

namespace {

// {"0.5": ms, "1": ms, ...}
template <class Times>
auto by_settle_band(const Times& settle) {
    return [&settle](JsonWriter& json) {
        for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
            json(shortest(settle_bands_percent[i]), settle[i], in_ms);
    };
}

}  // namespace

void describe(JsonWriter& json, const SwitchEntry& entry) {
    describe_switch(json, entry.change, entry.time);
    json("stretch_ms", entry.stretch, in_ms);
    json("error_before_nm", entry.error_before_nm);
    json("peak_error_nm", entry.peak_error_nm);
    json("peak_after_ms", entry.peak_after, in_ms);
    json.group("settle_ms", by_settle_band(entry.settle));
}

void describe(JsonWriter& json, const LedgerEntry& entry) {
    json("band", entry.band, if_any);
    if (entry.to.value() > 0.0) {
        json("speed_from_deg_s", entry.from);
        json("speed_to_deg_s", entry.to);
    }
    json("filter", entry.filter);
    json("dc_delay_ms", entry.dc_delay, in_ms);
    json("ramp_delay_ms", entry.ramp_delay, in_ms);
    json.group_if("settle_ms", entry.step, [](JsonWriter& settle, const StepMeasurement& step) {
        by_settle_band(step.settle)(settle);
    });
    json.known("overshoot_percent", entry.step.has_value(), entry.step ? entry.step->overshoot_percent : 0.0);
    json("phase_lag_deg", entry.phase_lag_deg);
    json("crossover_db", entry.crossover_db);
}

}  // namespace ripplenotch
