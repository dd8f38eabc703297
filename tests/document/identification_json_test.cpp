// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

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
