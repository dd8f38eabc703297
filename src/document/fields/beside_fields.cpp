// SPDX-License-Identifier: MIT
#include "document/fields/beside_fields.hpp"

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view simulated = "simulated";

Json interval_json(const std::optional<Interval>& ci95) {
    return ci95 ? Json{six_digits(ci95->low), six_digits(ci95->high)} : Json(nullptr);
}

}  // namespace

void put_out_of_fold(Json& evidence, const Finding& finding) {
    if (!finding.out_of_fold) return;
    const OutOfFold& outside = *finding.out_of_fold;
    evidence["out_of_fold_gain"] = six_digits(outside.gain);
    evidence["t"] = six_digits(outside.t);
    evidence["blocks"] = outside.blocks;
    evidence["blocks_positive"] = outside.blocks_positive;
    evidence["evenness"] = six_digits(outside.evenness);
    evidence["rival"] = outside.rival.empty() ? Json(nullptr) : Json(outside.rival);
    evidence["rival_margin"] = outside.rival.empty() ? Json(nullptr) : six_digits(outside.rival_margin);
}

void read_out_of_fold(Fields& evidence, Finding& finding) {
    if (!evidence.has("out_of_fold_gain")) return;
    OutOfFold& outside = finding.out_of_fold.emplace();
    outside.gain = evidence.number("out_of_fold_gain");
    outside.t = evidence.number("t");
    outside.blocks = evidence.whole("blocks");
    outside.blocks_positive = evidence.whole("blocks_positive");
    outside.evenness = evidence.number("evenness");
    if (evidence.has("rival")) outside.rival = find_effect(evidence.text("rival")).name;
    outside.rival_margin = evidence.number_if_any("rival_margin").value_or(0.0);
}

void put_beside(Json& json, const Diagnosis& diagnosis) {
    Json given = Json::object();
    double scale = 1.0;
    for (const GivenValue& value : diagnosis.given) {
        // Values of no link, but of what the log tells of all; and what was stated.
        if (value.name == "arm" || value.name == "nuisance") continue;
        if (value.name != simulated) {
            if (!given.empty()) given[value.name] = six_digits(value.value);
        } else if (!given.contains("scale")) {
            scale = value.value;
            given["scale"] = {{"value", six_digits(value.value)}, {"ci95", interval_json(value.ci95)}};
        } else {
            // The slope in time: its value is the scale times how much later the column is.
            given["delay_s"] = six_digits(scale != 0.0 ? value.value / scale : 0.0);
        }
    }
    if (!given.empty()) json["simulated"] = given;
    if (diagnosis.leftover.empty()) return;
    json["leftover"] = Json::array();
    for (const BandLeft& band : diagnosis.leftover) {
        Json to = band.to_hz > 0.0 ? six_digits(band.to_hz) : Json(nullptr);
        list_in(json, "leftover")
            .push_back({{"hz", {six_digits(band.from_hz), to}}, {"rms_nm", six_digits(band.rms_nm)}});
    }
}

void read_beside(Fields& fields, Diagnosis& diagnosis) {
    if (fields.has("simulated")) {
        Fields given = fields.object("simulated");
        Fields scale = given.object("scale");
        GivenValue value{std::string(simulated), scale.number("value"), std::nullopt};
        if (scale.has("ci95")) {
            const std::vector<double> ends = scale.numbers("ci95");
            if (ends.size() == 2) value.ci95 = Interval{ends[0], ends[1]};
        }
        scale.finish();
        diagnosis.given.push_back(value);
        if (const auto delay_s = given.number_if_any("delay_s"))
            diagnosis.given.push_back({std::string(simulated), *delay_s * value.value, std::nullopt});
        for (const char* name : {"inertia_kgm2", "gravity_cosine_nm", "gravity_sine_nm", "offset_nm"}) {
            if (const auto number = given.number_if_any(name))
                diagnosis.given.push_back({name, *number, std::nullopt});
        }
        given.finish();
    }
    if (!fields.has("leftover")) return;
    fields.each("leftover", [&](Fields& entry) {
        const Json& hz = entry.list("hz");
        if (hz.size() != 2 || !hz[0].is_number()) raise<DataError>("{} is no band", entry.where("hz"));
        diagnosis.leftover.push_back(
            {hz[0].get<double>(), hz[1].is_number() ? hz[1].get<double>() : 0.0, entry.number("rms_nm")});
    });
}

}  // namespace ripplenotch
