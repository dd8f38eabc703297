// SPDX-License-Identifier: MIT
#include "ripplenotch/document/model_json.hpp"

#include <fmt/format.h>

#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {

Model read(const std::string& effects, const std::string& gear_ratio = "100") {
    return read_model(R"({"schema": "ripplenotch/model/1", "gear_ratio": )" + gear_ratio +
                          R"(, "effects": )" + effects + "}",
                      "m.json");
}

std::string model_refusal(const std::string& effects, const std::string& gear_ratio = "100") {
    try {
        (void)read(effects, gear_ratio);
    } catch (const DataError& error) {
        return error.what();
    }
    return "accepted";
}

// One of each effect of the catalogue, every second value left out, none of the others at a round number.
Model one_of_each() {
    Model model{GearRatio(101.5), {}};
    bool stated = true;
    for (const Effect* effect : catalogue()) {
        Term term{effect, {}};
        for (const Parameter& p : effect->parameters) {
            term.values.push_back(stated ? std::optional<double>(p.start + (p.upper - p.start) / 3e5)
                                         : std::nullopt);
            stated = !stated;
        }
        model.terms.push_back(std::move(term));
    }
    return model;
}

}  // namespace

TEST_CASE("a model written and read is the same model, to the last bit, unstated values included") {
    const Model model = one_of_each();
    CHECK(read_model(write_model(model, {}), "m.json") == model);
    CHECK(write_model(read_model(write_model(model, {}), "m.json"), {}) == write_model(model, {}));
}

TEST_CASE("a parameter left out or null is to be fitted, not 0") {
    const Model model =
        read(R"([{"effect": "inertia"}, {"effect": "ripple", "order": 1, "phase_deg": null}])");
    CHECK_FALSE(model.terms[0].values[0].has_value());
    CHECK(model.terms[1].values[0] == 1.0);
    CHECK_FALSE(model.terms[1].values[1].has_value());
    CHECK(missing_values(model).size() == 3);
}

TEST_CASE("a model without effects is a model") { CHECK(read("[]").terms.empty()); }

TEST_CASE("a wrong model is refused with file, place, value and what was expected") {
    CHECK_THAT(model_refusal(R"([{"effect": "riple"}])"),
               Contains("m.json: effects[0].effect") && Contains("did you mean ripple?"));
    CHECK_THAT(model_refusal(R"([{"effect": "ripple", "ordre": 1}])"),
               Contains("m.json: effects[0].ordre") && Contains("not a known field"));
    CHECK_THAT(model_refusal(R"([{"effect": "offset"}, {"effect": "ripple", "amplitude_nm": -0.1}])"),
               Contains("m.json: effects[1].amplitude_nm is -0.1") && Contains("between 0 and 100000 Nm"));
    CHECK_THAT(model_refusal(R"([{"effect": "ripple", "order": "1"}])"),
               Contains("effects[0].order is \"1\", expected a number"));
    CHECK_THAT(model_refusal(R"([{"order": 1}])"), Contains("m.json: effects[0].effect is missing"));
    CHECK_THAT(model_refusal(R"(["ripple"])"), Contains("effects[0] is not an object"));
    CHECK_THAT(model_refusal(R"({"effect": "ripple"})"), Contains("m.json: effects is not a list"));
    CHECK_THAT(model_refusal("[]", "0"), Contains("m.json: gear_ratio is 0") && Contains("above 0"));
    CHECK_THAT(model_refusal("[]", "1e6"), Contains("at most 100000"));
    CHECK_THAT(model_refusal("[]", "null"), Contains("gear_ratio is missing"));
    CHECK_THAT(model_refusal("[], \"gear\": 3"), Contains("m.json: gear is not a known field"));
}

TEST_CASE("a simulation is read back as it was written, and refused by who cannot read its column") {
    const Model model{GearRatio(101.0), {}};
    const SimulatedTerm stated{.column = "tau_model", .scale = 0.9, .delay_s = 0.002};
    const std::string text = write_model(ModelWithGiven{model, stated}, {});
    const ModelWithGiven read_back = read_model_with_given(text, "m.json");
    REQUIRE(read_back.simulated);
    CHECK(read_back.simulated->column == "tau_model");
    CHECK(read_back.simulated->scale == 0.9);
    CHECK(read_back.simulated->delay_s == 0.002);
    CHECK_THROWS_WITH(read_model(text, "m.json"), Contains("m.json") && Contains("tau_model"));
    const std::string open = R"({"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [],
                                 "simulated": {"column": "tau"}})";
    const auto fitted = read_model_with_given(open, "m.json").simulated;
    REQUIRE(fitted);
    CHECK_FALSE(fitted->scale);
    CHECK(fitted->delay_s == 0.0);
    CHECK_THROWS_AS(read_model_with_given(
                        R"({"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [],
                            "simulated": {"column": "tau", "skale": 1}})",
                        "m.json"),
                    DataError);
}

TEST_CASE("beside a simulation a friction may be below 0, and nothing else may, and without one none may") {
    const auto text = [](std::string_view effect, std::string_view size, bool simulated) {
        return fmt::format(R"({{"schema": "ripplenotch/model/1", "gear_ratio": 100, {}
                              "effects": [{{"effect": "{}", "{}": -0.3}}]}})",
                           simulated ? R"("simulated": {"column": "tau"},)" : "", effect, size);
    };
    for (const Effect* effect : catalogue()) {
        const Parameter& size = effect->parameters[0];
        if (size.lower < -0.3 || size.upper <= 0.0) continue;
        CAPTURE(effect->name);
        CHECK_THROWS_AS(read_model_with_given(text(effect->name, size.name, false), "m.json"), DataError);
        if (min_in({GearRatio(100.0), {}, true}, *effect, 0) >= 0.0) {
            CHECK_THROWS_AS(read_model_with_given(text(effect->name, size.name, true), "m.json"), DataError);
            continue;
        }
        const Model model = read_model_with_given(text(effect->name, size.name, true), "m.json").model;
        CHECK(model.terms.at(0).values.at(0) == -0.3);
        CHECK(min_in(model, *effect, 0) == -size.upper);
        for (std::size_t p = 1; p < effect->parameters.size(); ++p)
            CHECK(min_in(model, *effect, p) == effect->parameters[p].lower);
    }
}

TEST_CASE("an arm is read back as it was written, and refused where nobody knows what to do with it") {
    StatedArm arm{chain_of_axes("zyYx"), "2", {"a", "b", "c", "d"}};
    arm.chain.joints[3].kind = JointKind::prismatic;
    arm.chain.joints[1].rotation = rotation_of_rpy({10.0, 20.0, -130.0});
    arm.chain.gravity_m_s2 = {1.0, 2.0, -9.0};
    arm.joint = arm.chain.joints[1].name;
    arm.smoothing = Seconds(0.12);
    arm.values.emplace();
    for (int v = 0; v < 40; ++v) arm.values->links.push_back(0.1 * v - 1.3);
    arm.values->rotor_inertia_kgm2 = 0.25;
    const ModelWithGiven model{
        {GearRatio(101.0), {parse_term("coulomb-friction,torque_nm=1,width_deg_s=1")}}, std::nullopt, arm};
    const std::string text = write_model(model, {});
    const ModelWithGiven back = read_model_with_given(text, "m.json");
    REQUIRE(back.arm);
    CHECK(back.arm->joint == arm.joint);
    CHECK(back.arm->log_joints == arm.log_joints);
    CHECK(back.arm->values == arm.values);
    CHECK(back.arm->smoothing->value() == 0.12);
    CHECK(back.arm->chain.lengths_are_guessed);
    CHECK(back.arm->chain.gravity_m_s2 == arm.chain.gravity_m_s2);
    for (std::size_t j = 0; j < 4; ++j) {
        const ChainJoint &was = arm.chain.joints[j], &is = back.arm->chain.joints[j];
        CHECK(is.name == was.name);
        CHECK(is.kind == was.kind);
        CHECK(is.origin_m == was.origin_m);
        CHECK(is.axis == was.axis);
        for (std::size_t i = 0; i < 9; ++i)
            CHECK_THAT(is.rotation[i], Catch::Matchers::WithinAbs(was.rotation[i], 1e-14));
    }
    CHECK_THROWS_WITH(read_model(text, "m.json"), Contains("m.json") && Contains("arm"));
}

TEST_CASE("what an arm cannot be is refused with its place") {
    const auto refused = [](const std::string& from, const std::string& to) {
        StatedArm arm{chain_of_axes("zy"), {}, {"a", "b"}};
        arm.joint = arm.chain.joints[0].name;
        arm.values = ArmValues{std::vector<double>(20, 1.0), 0.0};
        std::string text = write_model(ModelWithGiven{{GearRatio(100.0), {}}, std::nullopt, arm}, {});
        text.replace(text.find(from), from.size(), to);
        try {
            (void)read_model_with_given(text, "m.json");
        } catch (const DataError& error) {
            return std::string(error.what());
        }
        return std::string("read");
    };
    CHECK_THAT(refused("\"mass_kg\"", "\"mass_lb\""), Contains("m.json: arm.links[0].mass_kg is missing"));
    CHECK_THAT(refused("\"effects\": []", "\"effects\": [{\"effect\": \"gravity\"}]"),
               Contains("gravity is part of arm; remove one of the two"));
    CHECK_THAT(refused("\"identified\": \"torque\"", "\"smoothing_s\": -1"), Contains("arm.smoothing_s"));
    CHECK_THAT(refused("\"identified\": \"torque\"", "\"mass\": 1"), Contains("not a known field"));
    CHECK_THAT(refused("\"joint\": \"", "\"joint\": \"no "), Contains("expected one of joints"));
}
