// SPDX-License-Identifier: MIT
#include "document/fields/beside_fields.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view simulated = "simulated";

}  // namespace

void put_beside(Json& json, const Diagnosis& diagnosis) {
    for (const GivenValue& value : diagnosis.given) {
        // An arm's values are of combinations of links, which nobody reads one by one.
        if (value.name == simulated) json["simulated"] = {{"scale", six_digits(value.value)}};
    }
    if (diagnosis.residual_in_noise) json["residual_in_noise"] = true;
    if (!diagnosis.setup.empty()) json["setup"] = Json::array();
    for (const SetupFault& fault : diagnosis.setup)
        list_in(json, "setup")
            .push_back({{"fault", setup_fault_name(fault.kind)},
                        {"statement", fault.statement},
                        {"option", fault.option},
                        {"explained_before", six_digits(fault.explained_before)},
                        {"explained_after", six_digits(fault.explained_after)}});
    if (!diagnosis.alignment) return;
    const SimulationLag& lag = *diagnosis.alignment;
    json["alignment"] = {
        {"delay_s", six_digits(lag.delay_s)},
        {"ci95_s", {six_digits(lag.delay_95_s.low), six_digits(lag.delay_95_s.high)}},
        {"correlation", six_digits(lag.correlation)},
        {"clock_error_ppm", lag.clock_error ? six_digits(1e6 * *lag.clock_error) : Json(nullptr)}};
}

void read_beside(Fields& fields, Diagnosis& diagnosis) {
    if (fields.has("residual_in_noise")) diagnosis.residual_in_noise = fields.flag("residual_in_noise");
    if (!fields.has("simulated")) return;
    Fields given = fields.object("simulated");
    diagnosis.given.push_back({std::string(simulated), given.number("scale"), std::nullopt});
    given.finish();
}

}  // namespace ripplenotch
