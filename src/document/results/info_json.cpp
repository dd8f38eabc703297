// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include <algorithm>

#include "document/fields/fields.hpp"
#include "ripplenotch/survey/survey.hpp"

namespace ripplenotch {
namespace {

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

}  // namespace

void describe(JsonWriter& json, const Range& range) {
    json("min", range.min);
    json("max", range.max);
}

void describe(JsonWriter& json, const Column& column) {
    json("name", column.name);
    json("role", role_name(column.role));
    json.known("unit", column.role != Role::other, column.unit);
    json("unit_assumed", column.unit_assumed);
    json("joint", column.joint, null_if_empty);
}

void describe(JsonWriter& json, const SteadyStretch& stretch) {
    json("from_s", stretch.from_s);
    json("duration_s", stretch.duration_s);
    json("speed_deg_s", stretch.speed_deg_s);
    json("rest", stretch.rest);
}

void describe(JsonWriter& json, const JointInfo& joint) {
    json("joint", joint.joint, null_if_empty);
    json("speed_deg_s", joint.speed_deg_s);
    json("torque_nm", joint.torque_nm);
    json("position_deg", joint.position_deg);
    json("turns", joint.turns);
    json("held_samples", joint.recording.held.count);
    json("longest_hold", joint.recording.held.longest);
    json("clock_factor", joint.clock_factor);
    json("steady_stretches", joint.stretches);
    json("drive", joint.drive, if_any);
    json("options", joint.options);
}

// What is in a container, taken or not.
void describe(JsonWriter& json, const ContentEntry& entry) {
    json("path", entry.path);
    json("shape", entry.shape);
    json("type", entry.type);
    json("unit", entry.unit);
    json("rate_hz", entry.rate_hz);
    json("read", entry.read);
}

void describe(JsonWriter& json, const Use& use) {
    json("name", use.name);
    json("possible", use.possible);
    json("reason", use.reason);
}

void describe(JsonWriter& json, const LogInfo& log) {
    const ClockFacts& clock = log.clock;
    const bool timed = clock.nominal_rate.value() > 0.0;
    json("log", log.source);
    json("rows", log.rows);
    json("duration_s", log.duration_s);
    json.known("sample_rate_hz", timed, clock.nominal_rate);
    json.known("mean_rate_hz", timed, clock.mean_rate);
    json.known("median_step_ms", timed, clock.usual_step, in_ms);
    json.known("shortest_step_ms", timed, clock.shortest_step, in_ms);
    json.known("longest_step_ms", timed, clock.longest_step, in_ms);
    json.known("jitter_ms", timed, clock.jitter, in_ms);
    json("repeated_times", clock.repeated_times);
    json("gap_count", clock.gap_count);
    json("gaps", clock.gaps);
    std::size_t held = 0;
    std::vector<Recording> recordings;
    for (const JointInfo& joint : log.joints) {
        held = std::max(held, joint.recording.held.count);
        recordings.push_back(joint.recording);
    }
    json("held_samples", held);
    json("bad_values_held", log.bad_values_held);
    json("clock_factor", best_clock_factor(log.joints));
    json("format", log.layout.format);
    json("columns", log.layout.columns);
    json("contents", log.layout.contents, if_any);
    json("speed_deg_s", widest(log.joints));
    json("joints", log.joints);
    json("uses", log.uses);
    json("warnings", log.warnings);
    add_recordings(json, recordings);
    json("options", log.layout.options);
}

std::string info_to_json(std::span<const LogInfo> logs, const Provenance& provenance) {
    return to_fitted_text(document_of("info", provenance, [&](JsonWriter& json) {
        if (logs.size() == 1)
            describe(json, logs.front());
        else
            json("logs", logs);
    }));
}

}  // namespace ripplenotch
