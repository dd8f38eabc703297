// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/comparison_json.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch {

namespace {

Json pair_to_json(const std::vector<double>& values) {
    return {{"raw", finite_or_null(values[0])}, {"filtered", finite_or_null(values[1])}};
}

Json order_to_json(const FilterMetrics& metrics, std::size_t order) {
    const OrderLevel& level = metrics.levels->orders[order];
    const auto predicted = predicted_nm(metrics, order);
    const auto attenuation = attenuation_db(level);
    Json json = Json::object();
    json["order"] = level.order;
    json["hz"] = finite_or_null(level.mean_hz);
    json["raw_nm"] = finite_or_null(level.amplitude_nm[0]);
    json["filtered_nm"] = finite_or_null(level.amplitude_nm[1]);
    json["attenuation_db"] = attenuation ? Json(*attenuation) : Json(nullptr);
    json["predicted_nm"] = predicted ? finite_or_null(*predicted) : Json(nullptr);
    if (predicted) json["predicted_from"] = metrics.gear->amplitude_nm.empty() ? "log" : "joint";
    return json;
}

// Null figures, not zeros, when there was nothing to measure them on.
void add_levels(Json& json, const FilterMetrics& metrics) {
    const bool measured = metrics.levels && metrics.levels->windows > 0;
    json["gear_ratio"] = metrics.gear ? Json(metrics.gear->ratio.value()) : Json(nullptr);
    json["gear"] = gear_to_json(metrics.gear);
    json["orders"] = Json::array();
    if (!measured) {
        for (const char* name : {"residual_rms_nm", "residual_peak_to_peak_nm", "ripple_peak_to_peak_nm"}) {
            json[name] = nullptr;
        }
    } else {
        const RippleLevels& levels = *metrics.levels;
        for (std::size_t i = 0; i < levels.orders.size(); ++i)
            list_in(json, "orders").push_back(order_to_json(metrics, i));
        json["residual_rms_nm"] = pair_to_json(levels.residual_rms_nm);
        json["residual_peak_to_peak_nm"] = pair_to_json(levels.residual_peak_to_peak_nm);
        json["ripple_peak_to_peak_nm"] = pair_to_json(levels.ripple_peak_to_peak_nm);
    }
    if (!metrics.levels) {
        json["windows"] = nullptr;
        return;
    }
    json["windows"] = {{"measured", metrics.levels->windows},
                       {"measured_share", metrics.levels->measured_share},
                       {"too_few_samples", metrics.levels->windows_too_few_samples}};
}

void add_stream(Json& json, const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    const ClockFacts& clock = stream.recording.clock;
    json["rows"] = clock.rows;
    json["sample_rate_hz"] = metrics.sample_rate.value();
    json["measured_sample_rate_hz"] = finite_or_null(clock.mean_rate.value());
    if (metrics.table_rate) json["table_sample_rate_hz"] = metrics.table_rate->value();
    json["gap_count"] = clock.gap_count;
    json["gaps"] = gaps_json(clock);
    json["repeated_times"] = clock.repeated_times;
    json["speed_deg_s"] = {finite_or_null(stream.slowest_deg_s), finite_or_null(stream.fastest_deg_s)};
    json["held_samples"] = stream.recording.held.count;
    json["held_bad_values"] = stream.held_bad_values;
}

}  // namespace

std::string metrics_to_json(const FilterMetrics& metrics, const Provenance& provenance) {
    Json json = document_head("metrics", provenance);
    json["source"] = metrics.source;
    json["joint"] = metrics.joint.empty() ? Json(nullptr) : Json(metrics.joint);
    json["method"] = metrics.method;
    add_stream(json, metrics);
    add_levels(json, metrics);
    json["crossover_hz"] = metrics.crossover ? Json(metrics.crossover->value()) : Json(nullptr);
    json["delays"] = Json::array();
    for (const LedgerEntry& entry : metrics.delays)
        list_in(json, "delays").push_back(ledger_entry_to_json(entry));
    json["switch_count"] = metrics.stream.switch_count;
    json["switches"] = Json::array();
    for (const TimedSwitch& entry : metrics.stream.switches)
        list_in(json, "switches").push_back(switch_to_json(entry.change, Seconds(entry.time_s)));
    return to_fitted_text(std::move(json));
}

namespace {

Json point_to_json(const TradePoint& point) {
    Json json = Json::object();
    json["bands"] = point.bands;
    json["attenuation_db"] = point.attenuation_db;
    json["delay_ms"] = 1e3 * point.delay.value();
    json["q"] = {point.least_q, point.largest_q};
    json["settle_ms"] = 1e3 * point.settle.value();
    json["overshoot_percent"] = point.overshoot_percent;
    return json;
}

}  // namespace

std::string frontier_to_json(const Frontier& frontier, const GearAccount& gear,
                             const Provenance& provenance) {
    const TableSpec& spec = frontier.spec;
    const DesignGoal& goal = frontier.goal;
    Json json = document_head("frontier", provenance);
    json["sample_rate_hz"] = spec.sample_rate.value();
    json["gear_ratio"] = spec.gear_ratio.value();
    json["gear"] = gear_to_json(gear);
    json["gear_ratio_error_percent"] = 100.0 * spec.ratio_error;
    json["orders"] = Json::array();
    for (const Order order : spec.orders) list_in(json, "orders").push_back(order.value());
    json["amplitude_nm"] = spec.amplitude_nm.empty() ? Json(nullptr) : Json(spec.amplitude_nm);
    json["speed_deg_s"] = {goal.from.value(), goal.to.value()};
    json["settle_band_percent"] = spec.settle_band_percent;
    json["min_attenuation_db"] = goal.min_attenuation_db ? Json(*goal.min_attenuation_db) : Json(nullptr);
    json["max_delay_ms"] = goal.max_delay ? Json(1e3 * goal.max_delay->value()) : Json(nullptr);
    json["max_bands"] = goal.most_bands ? Json(*goal.most_bands) : Json(nullptr);
    json["points"] = Json::array();
    for (const TradePoint& point : frontier.points) list_in(json, "points").push_back(point_to_json(point));
    json["recommended"] = point_to_json(frontier.points[frontier.recommended]);
    object_in(json, "recommended")["point"] = frontier.recommended;
    object_in(json, "recommended")["reason"] = frontier.reason;
    object_in(json, "recommended")["no_notch_below_deg_s"] =
        frontier.slowest ? Json(frontier.slowest->value()) : Json(nullptr);
    return to_fitted_text(std::move(json));
}

std::string frontier_to_csv(const Frontier& frontier) {
    std::string csv =
        "bands,attenuation_db,delay_ms,q_least,q_largest,settle_ms,overshoot_percent,recommended\n";
    for (std::size_t i = 0; i < frontier.points.size(); ++i) {
        const TradePoint& point = frontier.points[i];
        csv += fmt::format("{},{:.2f},{:.3f},{},{},{:.3f},{:.3f},{}\n", point.bands, point.attenuation_db,
                           1e3 * point.delay.value(), shortest(point.least_q), shortest(point.largest_q),
                           1e3 * point.settle.value(), point.overshoot_percent,
                           i == frontier.recommended ? 1 : 0);
    }
    return csv;
}

namespace {

Json orders_to_json(const std::vector<RippleEstimate>& orders) {
    Json json = Json::array();
    for (const RippleEstimate& one : orders) json.push_back(ripple_to_json(one));
    return json;
}

Json judged_method_to_json(const JudgedMethod& method) {
    Json json;
    json["method"] = method.figures.method;
    json["meets"] = method.meets();
    json["error_nm"] = method.error_nm;
    json["ripple_rms_nm"] = or_null(method.figures.ripple_rms_nm);
    json["longest_delay_ms"] = 1e3 * method.delay.value();
    json["longest_delay_at_deg_s"] = method.delay_at.value();
    json["dc_delay_ms"] = or_null(method.figures.dc_delay_ms);
    json["attenuation_db"] = Json::array();
    for (const OrderAttenuation& entry : method.figures.attenuation)
        json["attenuation_db"].push_back({{"order", entry.order}, {"db", or_null(entry.db)}});
    json["shortfalls"] = method.shortfalls;
    return json;
}

}  // namespace

std::string recommendation_text(const RecommendationReport& report, const Provenance& provenance) {
    const Recommendation& found = report.found;
    Json json = document_head("recommendation", provenance);
    json["verdict"] = recommendation_verdict(found);
    json["finding"] = recommendation_finding_name(found.finding);
    json["conclusive"] = report.conclusive;
    json["max_delay_ms"] =
        found.limits.max_delay ? Json(1e3 * found.limits.max_delay->value()) : Json(nullptr);
    json["min_attenuation_db"] = or_null(found.limits.min_attenuation_db);
    json["target"] = report.target.empty() ? Json(nullptr) : Json(report.target);
    json["gear"] = gear_to_json(report.gear);
    json["split_s"] = report.split_s;
    json["windows"] = found.windows;
    json["torque_rate_nm_s"] = found.torque_rate_nm_s;
    json["orders"] = orders_to_json(found.orders);
    const JudgedMethod* const next = found.runner_up();
    json["take"] = found.finding == RecommendationFinding::recommended ? Json(found.taken()->figures.method)
                                                                       : Json(nullptr);
    json["take_commands"] = report.take;
    json["runner_up"] = next != nullptr ? Json(next->figures.method) : Json(nullptr);
    json["runner_up_commands"] = report.runner_up;
    json["check"] = report.check;
    json["methods"] = Json::array();
    for (const JudgedMethod& method : found.methods) json["methods"].push_back(judged_method_to_json(method));
    json["assumed"] = report.assumed;
    json["left_out"] = report.left_out;
    return to_fitted_text(std::move(json));
}

namespace {

Json settling_of_method(const MethodFigures& figures) {
    if (!figures.settle_ms) return nullptr;
    Json json = Json::object();
    for (std::size_t i = 0; i < settle_bands_percent.size(); ++i) {
        json[shortest(settle_bands_percent[i])] = (*figures.settle_ms)[i];
    }
    return json;
}

Json method_to_json(const MethodFigures& figures) {
    Json json = Json::object();
    json["method"] = figures.method;
    json["settle_ms"] = settling_of_method(figures);
    json["overshoot_percent"] = or_null(figures.overshoot_percent);
    json["ramp_delay_ms"] = or_null(figures.ramp_delay_ms);
    json["dc_delay_ms"] = or_null(figures.dc_delay_ms);
    json["phase_lag_deg"] = or_null(figures.phase_lag_deg);
    json["crossover_db"] = or_null(figures.crossover_db);
    json["attenuation_db"] = Json::array();
    for (const OrderAttenuation& entry : figures.attenuation) {
        list_in(json, "attenuation_db")
            .push_back({{"order", entry.order}, {"hz", entry.hz}, {"db", or_null(entry.db)}});
    }
    json["ripple_rms_nm"] = or_null(figures.ripple_rms_nm);
    json["residual_rms_nm"] = or_null(figures.residual_rms_nm);
    json["residual_peak_to_peak_nm"] = or_null(figures.residual_peak_to_peak_nm);
    json["switches"] = or_null(figures.switches);
    json["largest_jump_nm"] = or_null(figures.largest_jump_nm);
    json["error_rms_nm"] = or_null(figures.error_rms_nm);
    json["note"] = figures.note;
    json["within_max_delay_from_deg_s"] =
        figures.within_from ? Json(figures.within_from->value()) : Json(nullptr);
    json["ledger"] = Json::array();
    for (const LedgerEntry& entry : figures.ledger)
        list_in(json, "ledger").push_back(ledger_entry_to_json(entry));
    json["switch_ledger"] = Json::array();
    for (const SwitchEntry& entry : figures.switch_ledger)
        list_in(json, "switch_ledger").push_back(switch_entry_to_json(entry));
    return json;
}

Json match_to_json(const LowPassMatch& match) {
    Json json = Json::object();
    json["subject"] = match.subject;
    json["low_pass"] = or_null(match.low_pass);
    json["order"] = match.order;
    json["cutoff_hz"] = match.cutoff ? Json(match.cutoff->value()) : Json(nullptr);
    json["ripple_rms_nm"] = or_null(match.ripple_rms_nm);
    json["attenuation_db"] = or_null(match.attenuation_db);
    json["matched"] = match.clause;
    return json;
}

}  // namespace

std::string comparison_text(const Comparison& comparison, const Provenance& provenance) {
    Json json = document_head("comparison", provenance);
    json["verdict"] = verdict(comparison);
    json["sample_rate_hz"] = comparison.sample_rate.value();
    json["speed_deg_s"] = comparison.speed.value();
    json["step_nm"] = or_null(comparison.step_nm);
    json["ramp_nm_s"] = or_null(comparison.ramp_nm_s);
    json["crossover_hz"] = comparison.crossover ? Json(comparison.crossover->value()) : Json(nullptr);
    json["no_notch_below_deg_s"] =
        comparison.no_notch_below ? Json(comparison.no_notch_below->value()) : Json(nullptr);
    json["gear_ratio"] = comparison.lines ? Json(comparison.lines->ratio.value()) : Json(nullptr);
    json["gear"] = gear_to_json(comparison.lines);
    json["orders"] = Json::array();
    if (comparison.lines) {
        for (const Order order : comparison.lines->orders) list_in(json, "orders").push_back(order.value());
    }
    if (comparison.on_log) {
        json["rows"] = comparison.rows;
        json["windows"] = comparison.windows;
        json["measured_share"] = comparison.measured_share;
    }
    json["match"] = comparison.match ? match_to_json(*comparison.match) : Json(nullptr);
    json["methods"] = Json::array();
    for (const MethodFigures& figures : comparison.methods)
        list_in(json, "methods").push_back(method_to_json(figures));
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
