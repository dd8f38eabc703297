// SPDX-License-Identifier: MIT
// Results as JSON: comparison, diagnosis, joint.json, map.json.
#include "document/json/json.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/comparison_json.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "support/catch.hpp"
#include "support/diagnoses.hpp"

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

namespace {

Identification example() {
    Identification found;
    found.joint = "j4";
    found.sample_rate = Hertz(999.5);
    found.evidence = "order spectrum";
    found.finding = RippleFinding::ratio;
    found.verdict = "Ripple at orders 1 and 2 of the motor";
    found.conclusive = true;
    found.notes = {"one", "two"};
    Line line;
    line.kind = LineKind::order;
    line.order = 2.0;
    line.order_output = 200.02;
    line.order_output_stderr = 0.01;
    line.amplitude_nm = 0.8;
    line.phase_deg = -12.5;
    line.phase_known = true;
    line.snr = 30.0;
    line.speed_from_deg_s = 60.0;
    line.speed_to_deg_s = 180.0;
    line.by_speed = {{-60.0, 33.3, 0.81, 29.0}, {180.0, 100.0, 0.79, 31.0}};
    Line tone;
    tone.kind = LineKind::tone;
    tone.hz = 50.0;
    tone.note = "mains";
    found.lines = {line, tone};
    found.gear_ratio.value = 100.01;
    found.gear_ratio.standard_error = 0.015;
    found.gear_ratio.ci95_low = 99.98;
    found.gear_ratio.ci95_high = 100.04;
    found.gear_ratio.candidates = {{100.01, 0.9, "orders 1 and 2"}, {50.0, 0.1, "orders 2 and 4"}};
    found.velocity_error = {DegPerSec(0.4), DegPerSec(0.03)};
    found.gear_ratio.residuals = {{60.0, 33.3, 2.0, -0.001, 0.7}};
    return found;
}

}  // namespace

TEST_CASE("joint.json reads back as it was written, byte for byte") {
    Identification nothing;
    nothing.sample_rate = Hertz(100);
    Identification without_ratio = example();
    without_ratio.gear_ratio = {};
    without_ratio.lines.clear();
    Identification doubted = without_ratio;
    doubted.doubts = {{DoubtReason::clock, "the clock is wrong"}};
    for (const Identification& found : {example(), without_ratio, nothing, doubted}) {
        const std::string text = identification_text(found, {});
        CHECK(identification_text(identification_from_json(text, "joint.json"), {}) == text);
    }
    const Identification back = identification_from_json(identification_text(example(), {}), "joint.json");
    CHECK(back.lines.size() == 2);
    CHECK(back.lines[0].order == 2.0);
    CHECK(back.lines[0].phase_known);
    CHECK_FALSE(back.lines[1].phase_known);
    CHECK_FALSE(back.lines[1].order.has_value());
    CHECK(back.gear_ratio.value == 100.01);
    REQUIRE(back.velocity_error);
    CHECK(back.velocity_error->offset == DegPerSec(0.4));
    CHECK(back.velocity_error->offset_error == DegPerSec(0.03));
    CHECK_FALSE(identification_from_json(identification_text(nothing, {}), "joint.json").velocity_error);
}

TEST_CASE("a joint.json that says something else is refused with the field's name") {
    const auto changed = [](const std::string& from, const std::string& to) {
        std::string text = identification_text(example(), {});
        const std::size_t at = text.find(from);
        REQUIRE(at != std::string::npos);
        return text.replace(at, from.size(), to);
    };
    const auto message = [](const std::string& text) {
        try {
            (void)identification_from_json(text, "joint.json");
        } catch (const DataError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    using Catch::Contains;
    CHECK_THAT(message(changed("\"kind\": \"order\"", "\"kind\": \"ordr\"")),
               Contains("lines[0].kind is \"ordr\""));
    CHECK_THAT(message(changed("\"snr\": 30.0", "\"snr\": \"30\"")), Contains("lines[0].snr"));
    CHECK_THAT(message(changed("\"snr\": 30.0", "\"snr\": 30.0, \"colour\": 1")),
               Contains("lines[0].colour is not a known field"));
    CHECK_THAT(message(changed("\"value\": 100.01", "\"value\": -5")), Contains("gear_ratio.value is -5"));
    CHECK_THAT(message(changed("\"sample_rate_hz\": 999.5", "\"sample_rate_hz\": 0")),
               Contains("sample_rate_hz is 0"));
    CHECK_THAT(message(changed("ripplenotch/joint/1", "ripplenotch/table/1")),
               Contains("expected \"ripplenotch/joint/1\""));
    CHECK_THAT(message("{"), Contains("not JSON"));
    CHECK_THAT(message(""), Contains("read an empty file") && Contains("as 'identify --json' writes it"));
    CHECK_THAT(message("time_s,torque_nm\n0,1\n"), Contains("read 'time_s,torque_nm"));
}

TEST_CASE("several joints share one document of another schema") {
    const std::vector<Identification> both{example(), example()};
    const std::string text = identifications_text(both, {});
    CHECK_THAT(text, Catch::Contains("ripplenotch/joints/1"));
    CHECK_THROWS_WITH(identification_from_json(text, "all.json"),
                      Catch::Contains("expected \"ripplenotch/joint/1\""));
}

namespace {

MapFit example_map() {
    MapFit fit;
    fit.map.joint = "j4";
    fit.map.gear_ratio = GearRatio(120.0);
    fit.map.orders = {Order(1.0), Order(2.0)};
    fit.map.form = {{3.5, 60.0}, 2};
    fit.map.zero_deg = -12.5;
    fit.map.speeds_deg_s = {3.5, 60.0};
    fit.map.positions_deg = {-90.0, 45.0};
    for (std::size_t i = 0; i < 2; ++i) {
        fit.map.values.emplace_back();
        fit.errors.emplace_back();
        for (std::size_t c = 0; c < fit.map.form.columns(); ++c) {
            fit.map.values[i].emplace_back(0.25 * static_cast<double>(c), -0.5);
            fit.errors[i].emplace_back(0.01, 0.02);
        }
    }
    fit.map.spread_nm = {0.05, 0.125};
    fit.scores = {{1.0, true, 0.3, 0.05, 0.1, 0.9},
                  {2.0, true, 0.4, 0.05, 0.1, 0.95},
                  {4.0, false, 0.1, 0.1, 0.1, 0.0}};
    fit.agreement = {{1, 2.0, 1.25, 0.05, -3.5, 1.0, false}};
    fit.finding = MapFinding::mapped;
    fit.windows = 166;
    fit.blocks = 16;
    fit.doubt = "Cannot tell:";
    fit.notes = {"by direction: taken"};
    return fit;
}

}  // namespace

TEST_CASE("map.json reads back as it was written, byte for byte, empty maps too") {
    MapFit nothing;
    nothing.map.gear_ratio = GearRatio(100.0);
    nothing.finding = MapFinding::nothing;
    nothing.conclusive = true;
    nothing.scores = {{1.0, false, 0.1, 0.1, 0.1, 0.0, 0.5, 0.125}};
    MapFit two_combs = example_map();
    two_combs.map.form.second_comb = -1;
    for (auto* columns : {&two_combs.map.values, &two_combs.errors})
        for (auto& order : *columns) order.resize(two_combs.map.form.columns(), {0.5, 0.25});
    for (const MapFit& fit : {example_map(), two_combs, nothing}) {
        const std::string text = map_text(fit, {});
        const MapFit again = map_from_json(text, "map.json");
        CHECK(map_text(again, {}) == text);
        CHECK(again.map.form.columns() == fit.map.form.columns());
        CHECK(again.map.form.second_comb == fit.map.form.second_comb);
    }
}

TEST_CASE("a file from before there were bounds is read") {
    std::string text = map_text(example_map(), {});
    for (const std::string field : {"\"false_alarm\"", "\"detectable_nm\""}) {
        for (std::size_t at = text.find(field); at != std::string::npos; at = text.find(field)) {
            const std::size_t from = text.rfind(',', at);
            text.erase(from, text.find_first_of(",}\n", at) - from);
        }
    }
    const MapFit again = map_from_json(text, "map.json");
    CHECK(again.scores.size() == 3);
    CHECK(again.scores[2].detectable_nm == 0.0);
}

TEST_CASE("a map that cannot be one is refused with its field") {
    const std::string good = map_text(example_map(), {});
    const auto with = [&good](const std::string& from, const std::string& to) {
        std::string text = good;
        const std::size_t at = text.find(from);
        REQUIRE(at != std::string::npos);
        return text.replace(at, from.size(), to);
    };
    for (const auto& [from, to, field] :
         {std::tuple{"\"gear_ratio\": 120.0", "\"gear_ratio\": 0", "gear_ratio is 0"},
          std::tuple{"\"directions\": 2", "\"directions\": 3", "form.directions is 3, expected 1 to 2"},
          std::tuple{"\"directions\": 2", "\"directions\": 1", "coefficients: 8 values, expected"},
          std::tuple{"\"directions\": 2", "\"directions\": 2, \"by_load\": true", "by_load"},
          std::tuple{"\"finding\": \"mapped\"", "\"finding\": \"maped\"", "finding"},
          std::tuple{"\"notes\"", "\"note\"", "notes"}}) {
        CHECK_THROWS_WITH(map_from_json(with(from, to), "map.json"), Catch::Contains(field));
    }
}
