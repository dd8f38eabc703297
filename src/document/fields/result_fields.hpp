// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis leaves to its user: findings that were accepted, what to do next, and where the gap is.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "document/fields/fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/ledger.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// The known torque of a diagnosis in its document, and what its noise holds.

/// Sets "simulated" and "residual_in_noise" where the diagnosis has them.
void put_beside(Json& json, const Diagnosis& diagnosis);
void read_beside(Fields& fields, Diagnosis& diagnosis);

// One entry of a delay ledger, as metrics.json and comparison.json write it, and one of a switching ledger.

[[nodiscard]] Json ledger_entry_to_json(const LedgerEntry& entry);

[[nodiscard]] Json switch_to_json(const Switch& change, Seconds time);

/// The change, and what it did to the output.
[[nodiscard]] Json switch_entry_to_json(const SwitchEntry& entry);

// The gear whose ripple a result is about, as every JSON has it.

/// {"ratio", "orders", "source"}; null when nobody says the gear.
[[nodiscard]] inline Json gear_to_json(const std::optional<GearAccount>& gear) {
    if (!gear) return nullptr;
    Json json = Json::object();
    json["ratio"] = gear->ratio.value();
    json["orders"] = Json::array();
    for (const Order order : gear->orders) list_in(json, "orders").push_back(order.value());
    json["source"] = gear->source;
    return json;
}

// Internal: a ripple estimate as every document writes it.

inline Json ripple_to_json(const RippleEstimate& one) {
    const auto searched = [&](double value) { return one.searched() ? Json(value) : Json(nullptr); };
    return {{"order", one.order},
            {"amplitude_nm", searched(one.amplitude_nm)},
            {"standard_error_nm", searched(one.standard_error_nm)},
            {"detectable_nm", searched(one.detectable_nm)},
            {"false_alarm", searched(one.false_alarm)},
            {"phase_deg", one.phase_deg ? Json(*one.phase_deg) : Json(nullptr)},
            {"present", one.searched() ? Json(one.present()) : Json(nullptr)},
            {"slowest_deg_s", searched(one.slowest_deg_s)},
            {"fastest_deg_s", searched(one.fastest_deg_s)},
            {"cycles", one.cycles},
            {"insufficient", one.searched() ? Json(nullptr) : Json(one.insufficient)}};
}

// Parts of a diagnosis as fields: what a term was fitted to, and where something is.

/// {"level_nm": {"value", "ci95", "fitted", "at_bound"}, ...}, one entry a parameter of the term's effect.
[[nodiscard]] Json parameters_json(const Term& term, const std::vector<FittedValue>& values);

/// {"time_s", "speed_deg_s", "position_deg", "hz", "order", "direction"}
[[nodiscard]] Json place_json(const Place& place);

// Internal: names of a line of features that its writer and its reader share.

inline constexpr std::string_view features_schema = "ripplenotch/features/1";

struct MixField {
    const char* name;
    double MotionMix::*value;
};
inline constexpr std::array<MixField, 7> mix_fields = {{{"moving_share", &MotionMix::moving_share},
                                                        {"forward_share", &MotionMix::forward_share},
                                                        {"speed_p10_deg_s", &MotionMix::speed_p10_deg_s},
                                                        {"speed_p50_deg_s", &MotionMix::speed_p50_deg_s},
                                                        {"speed_p90_deg_s", &MotionMix::speed_p90_deg_s},
                                                        {"travel_deg", &MotionMix::travel_deg},
                                                        {"torque_rms_nm", &MotionMix::torque_rms_nm}}};

// The fields of a model, for documents that hold one.

/// Sets "gear_ratio" and "effects" of an object.
void put_model(Json& json, const Model& model);

/// Reads "gear_ratio" and "effects". Throws DataError as read_model() does.
[[nodiscard]] Model model_of(Fields& fields, bool beside_simulation);

/// The effect that "effect" names. Throws DataError for a name that the catalogue does not have.
[[nodiscard]] const Effect& effect_of(Fields& fields);

void put_decided(Json& json, const Diagnosis& diagnosis);
void read_decided(Fields& fields, Diagnosis& diagnosis);

}  // namespace ripplenotch
