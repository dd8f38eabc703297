// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include "document/json/json.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "support/catch.hpp"
#include "support/diagnoses.hpp"

using namespace ripplenotch;

TEST_CASE("what is written of a diagnosis is what it holds") {
    const Diagnosis diagnosis = testing::full_diagnosis();
    const Json json = Json::parse(testing::document_of(diagnosis));
    CHECK(json["verdict"] == "partly-explained");
    CHECK(json["gear"]["ratio"] == 100.0);
    REQUIRE(json["rounds"].size() == 2);
    const Json& tone = json["rounds"][1];
    CHECK(tone["effect"] == "tone");
    CHECK(tone["status"] == "ambiguous");
    CHECK(tone["parameters"]["frequency_hz"] == Json{{"value", 50.0}, {"ci95", {49.9, 50.1}}});
    CHECK(tone["parameters"]["amplitude_nm"] == Json{{"value", 0.02}, {"ci95", nullptr}, {"at_bound", true}});
    CHECK(tone["parameters"]["phase_deg"] == Json{{"value", 10.0}, {"ci95", nullptr}, {"fitted", false}});
    CHECK(json["rounds"][0]["alternatives"][0]["effect"] == "offset");
    CHECK(json["remaining"]["kind"] == "time");
    CHECK(json["remaining"]["where"] == Json{3.0, 3.5});
    CHECK(json["gap"]["validation_after_nm"].is_null());
    // The terms of the model as given, with their values in the improved one.
    CHECK(json["own_terms"].size() == 1);
    CHECK(json["own_terms"][0]["parameters"]["inertia_kgm2"]["ci95"] == Json{0.39, 0.41});
    CHECK(json["model"]["effects"].size() == 3);
}
