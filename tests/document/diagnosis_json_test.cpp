// SPDX-License-Identifier: MIT
#include "ripplenotch/document/diagnosis_json.hpp"

#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"
#include "support/diagnoses.hpp"

using namespace ripplenotch;
using Catch::Contains;

TEST_CASE("a diagnosis survives the way to JSON and back, byte for byte") {
    Diagnosis nothing_found;
    nothing_found.model.gear_ratio = nothing_found.baseline.gear_ratio = GearRatio(100.0);
    for (const Diagnosis& diagnosis : {testing::full_diagnosis(), nothing_found}) {
        const std::string text = write_diagnosis(diagnosis, testing::known_gear(), {});
        CHECK(write_diagnosis(read_diagnosis(text, "d.json"), testing::known_gear(), {}) == text);
    }
}

TEST_CASE("what is read of a diagnosis is what was written") {
    const Diagnosis diagnosis = testing::full_diagnosis();
    const Diagnosis read = read_diagnosis(write_diagnosis(diagnosis, testing::known_gear(), {}), "d.json");
    CHECK(read.model == diagnosis.model);
    CHECK(read.baseline.terms[0].effect->name == "inertia");
    CHECK_FALSE(read.baseline.terms[0].values[0]);
    REQUIRE(read.rounds.size() == 2);
    CHECK(read.rounds[0].alternatives[0].term == diagnosis.rounds[0].alternatives[0].term);
    CHECK(read.rounds[1].status == FindingStatus::ambiguous);
    REQUIRE(read.rounds[1].values.size() == 2);
    CHECK(read.rounds[1].values[1].term == 2);
    CHECK(read.rounds[1].values[1].parameter == 1);
    CHECK(read.rounds[1].values[1].at_bound);
    CHECK_FALSE(read.rounds[1].values[1].ci95);
    REQUIRE(read.rounds[1].values[0].ci95);
    CHECK(read.rounds[1].values[0].ci95->low == diagnosis.rounds[1].values[0].ci95->low);
    CHECK(read.rounds[1].values[0].ci95->high == diagnosis.rounds[1].values[0].ci95->high);
    REQUIRE(read.remaining);
    CHECK(read.remaining->kind == RegionKind::time);
    CHECK(read.remaining->where == diagnosis.remaining->where);
    CHECK(read.refused[0].term == diagnosis.refused[0].term);
    CHECK_FALSE(read.gap.validation_after_nm);
}

TEST_CASE("a diagnosis that is none is refused with the field and the reason") {
    const auto says = [](const char* pointer, const Json& value, const std::string& part) {
        Json json = Json::parse(write_diagnosis(testing::full_diagnosis(), testing::known_gear(), {}));
        json[Json::json_pointer(pointer)] = value;
        CHECK_THROWS_WITH(read_diagnosis(json.dump(), "d.json"), Contains("d.json") && Contains(part));
    };
    says("/verdict", "guessed", "verdict");
    says("/rounds/0/status", "sure", "rounds[0].status");
    says("/rounds/0/effect", "magic", "magic");
    says("/remaining/where", {1.0}, "remaining.where");
    says("/rounds/0/alternatives/0/extra", 1, "extra");
    says("/rounds/1/parameters/phase_deg", nullptr, "phase_deg is missing");
    says("/gap", Json::array(), "gap");
    says("/remaining/kind", "noise", "remaining.kind");
    says("/samples", -1, "samples");
    says("/model/gear_ratio", 0.0, "model.gear_ratio");
}
