// SPDX-License-Identifier: MIT
#include "document/fields/recording_fields.hpp"

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

Json name_or_null(const std::string& name) { return name.empty() ? Json(nullptr) : Json(name); }

void add_clock(Json& json, const ClockFacts& clock) {
    const bool timed = clock.nominal_rate.value() > 0.0;
    json["nominal_rate_hz"] = timed ? Json(to_digits(clock.nominal_rate.value())) : Json(nullptr);
    json["mean_rate_hz"] = timed ? finite_or_null(to_digits(clock.mean_rate.value())) : Json(nullptr);
    json["rate_stated"] = clock.stated;
    json["gap_count"] = clock.gap_count;
    json["gaps"] = gaps_json(clock);
    json["rate_changes"] = Json::array();
    for (const RateChange& change : clock.rate_changes) {
        list_in(json, "rate_changes")
            .push_back({{"row", change.row},
                        {"time_s", change.time_s},
                        {"from_hz", to_digits(change.from.value())},
                        {"to_hz", to_digits(change.to.value())}});
    }
    json["rows_left_out"] = clock.rows_left_out;
    json["repeated_times"] = clock.repeated_times;
}

Json assumptions_json(const std::vector<Assumption>& assumptions) {
    Json json = Json::array();
    for (const Assumption& one : assumptions) {
        json.push_back({{"about", one.about},
                        {"assumed", one.assumed},
                        {"reason", one.reason},
                        {"settle_with", name_or_null(one.settle_with)}});
    }
    return json;
}

Json outside_json(const RowsOutside& outside) {
    const auto number_or_null = [](std::optional<double> value) {
        return value ? Json(*value) : Json(nullptr);
    };
    return {{"before", outside.before},
            {"after", outside.after},
            {"from_s", number_or_null(outside.from_s)},
            {"to_s", number_or_null(outside.to_s)},
            {"zero_s", outside.zero_s}};
}

Json recording_json(const Recording& recording) {
    Json json = Json::object();
    json["source"] = recording.source;
    json["joint"] = name_or_null(recording.joint);
    json["rows"] = recording.rows();
    add_clock(json, recording.clock);
    json["held_samples"] = recording.held.count;
    json["longest_hold"] = recording.held.longest;
    json["angle"] = {{"source", source_name(recording.angle.source())}, {"reason", recording.angle.reason()}};
    if (recording.angle.contradicted) json["angle"]["until_row"] = recording.angle.contradicted->row;
    json["assumptions"] = assumptions_json(recording.assumptions);
    json["inferences"] = assumptions_json(recording.inferences);
    if (recording.looked_at)
        json["looked_at"] = {{"rows", recording.looked_at->rows}, {"pieces", recording.looked_at->pieces}};
    if (recording.outside) json["rows_outside"] = outside_json(*recording.outside);
    return json;
}

}  // namespace

Json gaps_json(const ClockFacts& clock) {
    Json json = Json::array();
    for (const Gap& gap : clock.gaps)
        json.push_back({{"row", gap.row}, {"from_s", gap.from_s}, {"to_s", gap.to_s}});
    return json;
}

void add_recordings(Json& json, std::span<const Recording> recordings) {
    if (recordings.size() == 1) json["recording"] = recording_json(recordings.front());
    if (recordings.size() <= 1) return;
    json["recordings"] = Json::array();
    for (const Recording& one : recordings) list_in(json, "recordings").push_back(recording_json(one));
}

}  // namespace ripplenotch
