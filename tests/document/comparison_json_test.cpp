// SPDX-License-Identifier: MIT
#include "ripplenotch/document/comparison_json.hpp"

#include "document/json/json.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

Comparison one_method() {
    Comparison comparison;
    comparison.sample_rate = Hertz(1000.0);
    comparison.speed = DegPerSec(90.0);
    comparison.methods.resize(1);
    comparison.methods[0].method = "fixed,centers=25Hz";
    return comparison;
}

Json written(const Comparison& comparison) {
    return Json::parse(comparison_text(comparison, Provenance{{}, "x"}));
}

}  // namespace

TEST_CASE("what was not measured is null, never zero and never missing") {
    const Json json = written(one_method());
    CHECK(json["schema"] == "ripplenotch/comparison/1");
    for (const char* name : {"best", "step_nm", "ramp_nm_s", "gear_ratio"}) CHECK(json.at(name).is_null());
    const Json& method = json["methods"][0];
    for (const char* name :
         {"settle_ms", "overshoot_percent", "ramp_delay_ms", "dc_delay_ms", "ripple_rms_nm",
          "residual_rms_nm", "residual_peak_to_peak_nm", "switches", "largest_jump_nm", "error_rms_nm"}) {
        CHECK(method.at(name).is_null());
    }
    CHECK(method["attenuation_db"] == Json::array());
    CHECK_FALSE(json.contains("windows"));
}

TEST_CASE("what was measured stands under the promised names") {
    Comparison comparison = one_method();
    MethodFigures& figures = comparison.methods[0];
    figures.settle_ms = {147.0, 130.0, 114.0, 92.0};
    figures.attenuation = {{1.0, 25.0, 21.7}, {2.0, 50.0, std::nullopt}};
    figures.switches = 0;
    comparison.lines = GearAccount{GearRatio(100.0), {Order(1.0), Order(2.0)}, {}, {}, ""};
    comparison.on_log = true;
    comparison.windows = 12;
    const Json json = written(comparison);
    const Json& method = json["methods"][0];
    CHECK(method["settle_ms"] == Json({{"0.5", 147.0}, {"1", 130.0}, {"2", 114.0}, {"5", 92.0}}));
    CHECK(method["attenuation_db"][0] == Json({{"order", 1.0}, {"hz", 25.0}, {"db", 21.7}}));
    CHECK(method["attenuation_db"][1]["db"].is_null());
    CHECK(method["switches"] == 0);
    CHECK(json["orders"] == Json({1.0, 2.0}));
    CHECK(json["windows"] == 12);
}
