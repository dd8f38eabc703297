// SPDX-License-Identifier: MIT
#include <algorithm>

#include "ripplenotch/document/diagnosis_json.hpp"
#include "ripplenotch/page/page.hpp"
#include "support/catch.hpp"
#include "support/diagnoses.hpp"

using namespace ripplenotch;

namespace {

PageSection section_of(const Diagnosis& diagnosis) {
    return section_of_result(write_diagnosis(diagnosis, testing::known_gear(), {}), "d.json");
}

const PageTable& table_named(const PageSection& section, const std::string& title) {
    const auto found = std::find_if(section.tables.begin(), section.tables.end(),
                                    [&](const PageTable& one) { return one.title == title; });
    REQUIRE(found != section.tables.end());
    return *found;
}

}  // namespace

TEST_CASE("a diagnosis has its verdict in words, the gap as a figure and its parts as facts and tables") {
    const PageSection section = section_of(testing::full_diagnosis());
    CHECK(section.verdict ==
          "partly-explained: coulomb-friction; gap from 0.435 to 0.0475 Nm rms, noise floor 0.0474 Nm");
    REQUIRE(section.figures.size() == 1);
    const Panel& panel = section.figures[0].panels[0];
    CHECK(panel.curves[0].y == std::vector<double>{0.434974, 0.0496759, 0.0475});
    CHECK(panel.lines[0].name == "1: coulomb-friction");
    CHECK(panel.lines[1].name == "2: tone (ambiguous)");
    bool told = false;
    for (const PageFact& fact : section.facts)
        told = told || (fact.name == "gap closed, %" && fact.value == "99.9");
    CHECK(told);
    CHECK(table_named(section, "faults").rows[0][0] == "quantization");
    Diagnosis nothing_found;
    nothing_found.model.gear_ratio = GearRatio(100.0);
    CHECK(section_of(nothing_found).verdict ==
          "matches: no effect is named; gap from 0 to 0 Nm rms, noise floor 0 Nm");
}

TEST_CASE("the rounds of a diagnosis are a table that fits a page") {
    const PageSection section = section_of(testing::full_diagnosis());
    const PageTable rounds = table_named(section, "rounds");
    CHECK(rounds.header == std::vector<std::string>{"effect", "status", "parameters (95 % interval)", "where",
                                                    "explains, Nm", "gap, Nm", "validation, Nm", "rivals",
                                                    "reason"});
    REQUIRE(rounds.rows.size() == 2);
    CHECK(rounds.rows[0] == std::vector<std::string>{"coulomb-friction", "confirmed",
                                                     "torque 0.4999 (0.4987 to 0.5010) Nm; width 2 deg/s",
                                                     "speed 10 to 90 deg/s; direction both", "0.4322",
                                                     "0.435 to 0.04968", "0.4335 to 0.05033", "offset", "-"});
    CHECK(rounds.rows[1][2] == "frequency 50.00 (49.90 to 50.10) Hz; amplitude 0.02 Nm; phase 10 deg");
    CHECK(rounds.rows[1][3] == "time 0.5 to 2.25; 4 to 5 s; frequency 50 Hz");
    CHECK(rounds.rows[1][6] == "-");
}
