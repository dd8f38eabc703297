// SPDX-License-Identifier: MIT
#include "ripplenotch/document/info_json.hpp"

#include <algorithm>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/json/json.hpp"

namespace ripplenotch {
namespace {

Json range_json(const std::optional<Range>& range) {
    return range ? Json{{"min", range->min}, {"max", range->max}} : Json(nullptr);
}

Json optional_json(const std::optional<double>& value) {
    return value ? finite_or_null(*value) : Json(nullptr);
}

Json columns_json(const Layout& layout) {
    Json columns = Json::array();
    for (const Column& column : layout.columns) {
        const bool known = column.role != Role::other;
        columns.push_back({{"name", column.name},
                           {"role", role_name(column.role)},
                           {"unit", known ? Json(column.unit) : Json(nullptr)},
                           {"unit_assumed", column.unit_assumed},
                           {"joint", column.joint.empty() ? Json(nullptr) : Json(column.joint)}});
    }
    return columns;
}

Json joint_info_json(const JointInfo& joint) {
    Json stretches = Json::array();
    for (const SteadyStretch& stretch : joint.stretches) {
        stretches.push_back({{"from_s", stretch.from_s},
                             {"duration_s", stretch.duration_s},
                             {"speed_deg_s", stretch.speed_deg_s},
                             {"rest", stretch.rest}});
    }
    return {{"joint", joint.joint.empty() ? Json(nullptr) : Json(joint.joint)},
            {"speed_deg_s", range_json(joint.speed_deg_s)},
            {"torque_nm", range_json(joint.torque_nm)},
            {"position_deg", range_json(joint.position_deg)},
            {"turns", joint.turns},
            {"held_samples", joint.recording.held.count},
            {"longest_hold", joint.recording.held.longest},
            {"clock_factor", optional_json(joint.clock_factor)},
            {"steady_stretches", stretches},
            {"options", joint.options}};
}

std::optional<Range> widest(const std::vector<JointInfo>& joints) {
    std::optional<Range> all;
    for (const JointInfo& joint : joints) {
        if (!joint.speed_deg_s) continue;
        if (!all) all = joint.speed_deg_s;
        all->min = std::min(all->min, joint.speed_deg_s->min);
        all->max = std::max(all->max, joint.speed_deg_s->max);
    }
    return all;
}

// The joint that moves most knows best whether the clock they share is right.
std::optional<double> best_clock_factor(const std::vector<JointInfo>& joints) {
    const JointInfo* best = nullptr;
    for (const JointInfo& joint : joints) {
        if (joint.clock_factor && (best == nullptr || joint.turns > best->turns)) best = &joint;
    }
    return best == nullptr ? std::nullopt : best->clock_factor;
}

void add_clock_of_log(Json& json, const LogInfo& log) {
    const ClockFacts& clock = log.clock;
    const bool timed = clock.nominal_rate.value() > 0.0;
    const auto ms = [timed](Seconds time) { return timed ? Json(1e3 * time.value()) : Json(nullptr); };
    json["sample_rate_hz"] = timed ? Json(clock.nominal_rate.value()) : Json(nullptr);
    json["mean_rate_hz"] = timed ? Json(clock.mean_rate.value()) : Json(nullptr);
    json["median_step_ms"] = ms(clock.usual_step);
    json["shortest_step_ms"] = ms(clock.shortest_step);
    json["longest_step_ms"] = ms(clock.longest_step);
    json["jitter_ms"] = ms(clock.jitter);
    json["repeated_times"] = clock.repeated_times;
    json["gap_count"] = clock.gap_count;
    json["gaps"] = gaps_json(clock);
}

// What is in a container, taken or not.
Json contents_json(const Layout& layout) {
    Json contents = Json::array();
    for (const ContentEntry& entry : layout.contents) {
        contents.push_back({{"path", entry.path},
                            {"shape", entry.shape},
                            {"type", entry.type},
                            {"unit", entry.unit},
                            {"rate_hz", optional_json(entry.rate_hz)},
                            {"read", entry.read}});
    }
    return contents;
}

void add_log(Json& json, const LogInfo& log) {
    json["log"] = log.source;
    json["rows"] = log.rows;
    json["duration_s"] = optional_json(log.duration_s);
    add_clock_of_log(json, log);
    std::size_t held = 0;
    for (const JointInfo& joint : log.joints) held = std::max(held, joint.recording.held.count);
    json["held_samples"] = held;
    json["bad_values_held"] = log.bad_values_held;
    json["clock_factor"] = optional_json(best_clock_factor(log.joints));
    json["format"] = log.layout.format;
    json["columns"] = columns_json(log.layout);
    if (!log.layout.contents.empty()) json["contents"] = contents_json(log.layout);
    json["speed_deg_s"] = range_json(widest(log.joints));
    json["joints"] = Json::array();
    for (const JointInfo& joint : log.joints) list_in(json, "joints").push_back(joint_info_json(joint));
    json["uses"] = Json::array();
    for (const Use& use : log.uses) {
        list_in(json, "uses")
            .push_back({{"name", use.name}, {"possible", use.possible}, {"reason", use.reason}});
    }
    json["warnings"] = log.warnings;
    std::vector<Recording> recordings;
    for (const JointInfo& joint : log.joints) recordings.push_back(joint.recording);
    add_recordings(json, recordings);
    json["options"] = log.layout.options;
}

}  // namespace

std::string info_to_json(std::span<const LogInfo> logs, const Provenance& provenance) {
    Json json = document_head("info", provenance);
    if (logs.size() == 1) {
        add_log(json, logs[0]);
        return to_fitted_text(std::move(json));
    }
    json["logs"] = Json::array();
    for (const LogInfo& log : logs) {
        Json entry = Json::object();
        add_log(entry, log);
        list_in(json, "logs").push_back(std::move(entry));
    }
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
