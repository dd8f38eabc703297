// SPDX-License-Identifier: MIT
#include "ripplenotch/document/model_json.hpp"

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

std::string refusal(const std::string& effects, const std::string& gear_ratio = "100") {
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
    CHECK_THAT(refusal(R"([{"effect": "riple"}])"),
               Contains("m.json: effects[0].effect") && Contains("did you mean ripple?"));
    CHECK_THAT(refusal(R"([{"effect": "ripple", "ordre": 1}])"),
               Contains("m.json: effects[0].ordre") && Contains("not a known field"));
    CHECK_THAT(refusal(R"([{"effect": "offset"}, {"effect": "ripple", "amplitude_nm": -0.1}])"),
               Contains("m.json: effects[1].amplitude_nm is -0.1") && Contains("between 0 and 100000 Nm"));
    CHECK_THAT(refusal(R"([{"effect": "ripple", "order": "1"}])"),
               Contains("effects[0].order is \"1\", expected a number"));
    CHECK_THAT(refusal(R"([{"order": 1}])"), Contains("m.json: effects[0].effect is missing"));
    CHECK_THAT(refusal(R"(["ripple"])"), Contains("effects[0] is not an object"));
    CHECK_THAT(refusal(R"({"effect": "ripple"})"), Contains("m.json: effects is not a list"));
    CHECK_THAT(refusal("[]", "0"), Contains("m.json: gear_ratio is 0") && Contains("above 0"));
    CHECK_THAT(refusal("[]", "1e6"), Contains("at most 100000"));
    CHECK_THAT(refusal("[]", "null"), Contains("gear_ratio is missing"));
    CHECK_THAT(refusal("[], \"gear\": 3"), Contains("m.json: gear is not a known field"));
}

TEST_CASE("a simulation is read back as it was written, and refused by who cannot read its column") {
    const Model model{GearRatio(101.0), {}};
    SimulatedTerm stated{.column = "tau_model", .scale = 0.9, .delay_s = 0.002};
    stated.offset_nm = -0.1;
    stated.gravity_sine_nm = 2.5;
    const std::string text = write_model(model, {}, stated);
    const ModelWithGiven read_back = read_model_with_given(text, "m.json");
    REQUIRE(read_back.simulated);
    CHECK(read_back.simulated->column == "tau_model");
    CHECK(read_back.simulated->scale == 0.9);
    CHECK(read_back.simulated->delay_s == 0.002);
    CHECK_FALSE(read_back.simulated->fit_delay);
    CHECK(read_back.simulated->offset_nm == -0.1);
    CHECK(read_back.simulated->gravity_sine_nm == 2.5);
    CHECK(read_back.simulated->inertia_kgm2 == 0.0);
    CHECK_THROWS_WITH(read_model(text, "m.json"), Contains("m.json") && Contains("tau_model"));
    const std::string open = R"({"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [],
                                 "simulated": {"column": "tau", "delay_s": null}})";
    const auto fitted = read_model_with_given(open, "m.json").simulated;
    REQUIRE(fitted);
    CHECK_FALSE(fitted->scale);
    CHECK(fitted->fit_delay);
    CHECK_THROWS_AS(read_model_with_given(
                        R"({"schema": "ripplenotch/model/1", "gear_ratio": 100, "effects": [],
                            "simulated": {"column": "tau", "skale": 1}})",
                        "m.json"),
                    DataError);
}
