// SPDX-License-Identifier: MIT
#include "ripplenotch/document/comparison_json.hpp"

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"

namespace ripplenotch {

namespace {

// Of the torque as measured and as filtered.
auto raw_and_filtered(const std::vector<double>& values) {
    return [&values](JsonWriter& json) {
        json("raw", values[0]);
        json("filtered", values[1]);
    };
}

void write_order(JsonWriter& json, const FilterMetrics& metrics, std::size_t order) {
    const OrderLevel& level = metrics.lines()->orders[order];
    const auto predicted = predicted_nm(metrics, order);
    json("order", level.order);
    json("hz", level.mean_hz);
    json("raw_nm", level.amplitude_nm[0]);
    json("filtered_nm", level.amplitude_nm[1]);
    json("attenuation_db", attenuation_db(level));
    json("predicted_nm", predicted);
    if (predicted) json("predicted_from", metrics.gear->amplitude_nm.empty() ? "log" : "joint");
}

// Null figures, not zeros, when there was nothing to measure them on.
void write_levels(JsonWriter& json, const FilterMetrics& metrics) {
    const RippleLevels* const levels = metrics.lines();
    const bool measured = levels != nullptr;
    const MethodFigures nothing;
    const MethodFigures& figures = metrics.measured ? metrics.measured->methods.front() : nothing;
    json.known("gear_ratio", metrics.gear && metrics.gear->has_ratio(),
               metrics.gear ? metrics.gear->ratio : GearRatio());
    json("gear", metrics.gear);
    Json orders = Json::array();
    for (std::size_t i = 0; measured && i < levels->orders.size(); ++i)
        orders.push_back(JsonWriter::object_of([&](JsonWriter& entry) { write_order(entry, metrics, i); }));
    json("orders", orders);
    const auto pair = [&](std::string_view name, std::vector<double> RippleLevels::*values) {
        if (measured)
            json.group(name, raw_and_filtered(levels->*values));
        else
            json.put(name, nullptr);
    };
    pair("residual_rms_nm", &RippleLevels::residual_rms_nm);
    pair("residual_peak_to_peak_nm", &RippleLevels::residual_peak_to_peak_nm);
    pair("ripple_peak_to_peak_nm", &RippleLevels::ripple_peak_to_peak_nm);
    json("error_nm", figures.error_nm);
    json("distortion_nm", figures.moved_nm);
    json("added_nm", figures.added_nm);
    json("start_ratio", figures.start_ratio);
    json.group_if("windows", metrics.measured ? &metrics.measured->lines : nullptr,
                  [](JsonWriter& windows, const RippleLevels& of) {
                      windows("measured", of.windows);
                      windows("measured_share", of.measured_share);
                      windows("too_few_samples", of.windows_too_few_samples);
                  });
}

}  // namespace

void describe(JsonWriter& json, const TimedSwitch& entry) {
    describe_switch(json, entry.change, Seconds(entry.time_s));
}

void describe(JsonWriter& json, const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    const ClockFacts& clock = stream.recording.clock;
    json("source", metrics.source);
    json("joint", metrics.joint, null_if_empty);
    json("method", metrics.method);
    json("rows", clock.rows);
    json("sample_rate_hz", metrics.sample_rate);
    json("measured_sample_rate_hz", clock.mean_rate);
    json("table_sample_rate_hz", metrics.table_rate, if_any);
    json("gap_count", clock.gap_count);
    json("gaps", clock.gaps);
    json("repeated_times", clock.repeated_times);
    json("speed_deg_s", std::tie(stream.slowest_deg_s, stream.fastest_deg_s));
    json("held_samples", stream.recording.held.count);
    json("held_bad_values", stream.held_bad_values);
    write_levels(json, metrics);
    json("crossover_hz", metrics.crossover);
    json("delays", metrics.delays);
    json("switch_count", stream.switch_count);
    json("switches", stream.switches);
}

void describe(JsonWriter& json, const OrderAttenuation& entry) {
    json("order", entry.order);
    json("hz", entry.hz);
    json("db", entry.db);
}

void describe(JsonWriter& json, const JudgedMethod& method) {
    json("method", method.figures.method);
    json("meets", method.meets());
    json("error_nm", method.figures.error_nm);
    json("ripple_rms_nm", method.figures.ripple_rms_nm);
    json("distortion_nm", method.figures.moved_nm);
    json("added_nm", method.figures.added_nm);
    json("start_ratio", method.figures.start_ratio);
    json("longest_delay_ms", method.delay, in_ms);
    json("multiplications", method.multiplications);
    json("longest_delay_at_deg_s", method.delay_at);
    json("dc_delay_ms", method.figures.dc_delay_ms);
    json.group_if("within_band", method.response, [](JsonWriter& within, const BandResponse& response) {
        within("least_delay_ms", response.least_delay, in_ms);
        within("longest_delay_ms", response.longest_delay, in_ms);
        within("least_gain", response.least_gain);
        within("largest_gain", response.largest_gain);
    });
    json("overshoot_percent", method.figures.overshoot_percent);
    json("undershoot_percent", method.figures.undershoot_percent);
    json("ramp_overshoot_nm", method.figures.ramp_overshoot_nm);
    json.each("attenuation_db", method.figures.attenuation,
              [](JsonWriter& one, const OrderAttenuation& entry) {
                  one("order", entry.order);
                  one("db", entry.db);
              });
    json("shortfalls", method.shortfalls);
}

void describe(JsonWriter& json, const RecommendationReport& report) {
    const Recommendation& found = report.found;
    const JudgedMethod* const next = found.runner_up();
    const bool recommended = found.finding == RecommendationFinding::recommended;
    json("verdict", recommendation_verdict(found));
    json("finding", recommendation_finding_name(found.finding));
    json("conclusive", report.conclusive);
    json("max_delay_ms", found.limits.max_delay, in_ms);
    json("min_attenuation_db", found.limits.min_attenuation_db);
    json("target", report.target, null_if_empty);
    json("gear", report.gear);
    json("split_s", report.split_s);
    json("windows", found.windows);
    json("torque_rate_nm_s", found.torque_rate_nm_s);
    json.group_if("torque_band_hz", found.band, [](JsonWriter& band, const TorqueBand& one) {
        band("from", one.from);
        band("to", one.to);
        band("stated", one.stated);
        band("at_rest", one.at_rest);
    });
    json("orders", found.orders);
    json("take", recommended ? found.taken()->figures.method : std::string(), null_if_empty);
    json("take_commands", report.take);
    json("runner_up", next != nullptr ? next->figures.method : std::string(), null_if_empty);
    json("runner_up_commands", report.runner_up);
    json("check", report.check);
    json("methods", found.methods);
    json("assumed", report.assumed);
    json("left_out", report.left_out);
}

void describe(JsonWriter& json, const MethodFigures& figures) {
    json("method", figures.method);
    json.group_if("settle_ms", figures.settle_ms, [](JsonWriter& settle, const auto& ms) {
        for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
            settle(shortest(settle_bands_percent[i]), ms[i]);
    });
    json("overshoot_percent", figures.overshoot_percent);
    json("undershoot_percent", figures.undershoot_percent);
    json("ramp_overshoot_nm", figures.ramp_overshoot_nm);
    json("ramp_delay_ms", figures.ramp_delay_ms);
    json("dc_delay_ms", figures.dc_delay_ms);
    json("phase_lag_deg", figures.phase_lag_deg);
    json("crossover_db", figures.crossover_db);
    json("attenuation_db", figures.attenuation);
    json("ripple_rms_nm", figures.ripple_rms_nm);
    json("residual_rms_nm", figures.residual_rms_nm);
    json("residual_peak_to_peak_nm", figures.residual_peak_to_peak_nm);
    json("error_nm", figures.error_nm);
    json("distortion_nm", figures.moved_nm);
    json("added_nm", figures.added_nm);
    json("start_ratio", figures.start_ratio);
    json("switches", figures.switches);
    json("largest_jump_nm", figures.largest_jump_nm);
    json("error_rms_nm", figures.error_rms_nm);
    json("note", figures.note);
    json("within_max_delay_from_deg_s", figures.within_from);
    json("ledger", figures.ledger);
    json("switch_ledger", figures.switch_ledger);
}

void describe(JsonWriter& json, const Comparison& comparison) {
    const GearAccount no_gear;
    const GearAccount& gear = comparison.lines ? *comparison.lines : no_gear;
    json("verdict", verdict(comparison));
    json.group_if("best", comparison.best, [&](JsonWriter& best, const JudgedMethod& method) {
        describe(best, method);
        best("reason", comparison.best_sentence);
    });
    json("sample_rate_hz", comparison.sample_rate);
    json("speed_deg_s", comparison.speed);
    json("step_nm", comparison.step_nm);
    json("ramp_nm_s", comparison.ramp_nm_s);
    json("crossover_hz", comparison.crossover);
    json("no_notch_below_deg_s", comparison.no_notch_below);
    json.known("gear_ratio", gear.has_ratio(), gear.ratio);
    json("gear", comparison.lines);
    json("orders", gear.orders);
    if (comparison.on_log) {
        json("rows", comparison.rows);
        json("windows", comparison.windows);
        json("measured_share", comparison.measured_share);
    }
    json("methods", comparison.methods);
}

std::string metrics_to_json(const FilterMetrics& metrics, const Provenance& provenance) {
    return to_fitted_text(document_of("metrics", provenance, metrics));
}

std::string recommendation_text(const RecommendationReport& report, const Provenance& provenance) {
    return to_fitted_text(document_of("recommendation", provenance, report));
}

std::string comparison_text(const Comparison& comparison, const Provenance& provenance) {
    return to_fitted_text(document_of("comparison", provenance, comparison));
}

}  // namespace ripplenotch
