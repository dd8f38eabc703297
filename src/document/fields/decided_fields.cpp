// SPDX-License-Identifier: MIT
#include "document/fields/decided_fields.hpp"

#include "document/fields/diagnosis_fields.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

Json band_json(const BandGap& band) {
    Json to = band.to_hz > 0.0 ? six_digits(band.to_hz) : Json(nullptr);
    return {{"hz", {six_digits(band.from_hz), to}},
            {"torque_nm", six_digits(band.torque_nm)},
            {"beside_given_nm", six_digits(band.beside_given_nm)},
            {"after_nm", six_digits(band.after_nm)}};
}

}  // namespace

void put_decided(Json& json, const Diagnosis& diagnosis) {
    if (!diagnosis.bands.empty()) {
        json["bands"] = Json::array();
        for (const BandGap& band : diagnosis.bands) list_in(json, "bands").push_back(band_json(band));
    }
    if (!diagnosis.accepted.empty()) {
        json["accepted"] = Json::array();
        for (const AcceptedFinding& one : diagnosis.accepted) {
            Json entry{{"effect", one.term.effect->name}, {"status", status_name(one.status)}};
            if (!one.reason.empty()) entry["reason"] = one.reason;
            entry["parameters"] = parameters_json(one.term, one.values);
            list_in(json, "accepted").push_back(std::move(entry));
        }
    }
    if (!diagnosis.next.empty()) json["next"] = diagnosis.next;
}

void read_decided(Fields& fields, Diagnosis& diagnosis) {
    if (fields.has("next")) diagnosis.next = fields.texts("next");
    if (!fields.has("bands")) return;
    fields.each("bands", [&](Fields& entry) {
        const Json& hz = entry.list("hz");
        if (hz.size() != 2 || !hz[0].is_number()) raise<DataError>("{} is no band", entry.where("hz"));
        diagnosis.bands.push_back({hz[0].get<double>(), hz[1].is_number() ? hz[1].get<double>() : 0.0,
                                   entry.number("torque_nm"), entry.number("beside_given_nm"),
                                   entry.number("after_nm")});
    });
}

}  // namespace ripplenotch
