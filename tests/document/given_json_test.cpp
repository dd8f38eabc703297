// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <functional>

#include "document/json/json.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
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

namespace {

TableSpec paper_spec() {
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = {Order(1.0), Order(2.0)};
    spec.sample_rate = 1000_Hz;
    spec.bands = bands_by_spacing({18_deg_s, 180_deg_s}, 18_deg_s);
    return spec;
}

const Provenance provenance{{}, "ripplenotch design"};

std::string paper_json() { return table_to_json(CandidateTable::design(paper_spec()), provenance); }

// What loading says about a table that was tampered with.
std::string table_refusal(const std::function<void(Json&)>& tamper) {
    Json json = Json::parse(paper_json());
    tamper(json);
    try {
        (void)table_from_json(json.dump(), "table.json");
    } catch (const DataError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("a table saved and loaded is the same table, and saves to the same bytes") {
    for (const auto width : {WidthRule::analog, WidthRule::digital}) {
        for (const double depth : {infinite_depth_db, 40.0}) {
            TableSpec spec = paper_spec();
            spec.width = width;
            spec.depth_db = depth;
            spec.q = 0.7;
            spec.settle_band_percent = 2.0;
            spec.below = OutsideRule::fade;
            spec.above = OutsideRule::pass;
            const std::string text = table_to_json(CandidateTable::design(spec), provenance);
            const CandidateTable loaded = table_from_json(text, "table.json");
            CHECK(table_to_json(loaded, provenance) == text);
            CHECK(loaded.spec().below == OutsideRule::fade);
            CHECK(loaded.spec().above == OutsideRule::pass);
            CHECK(loaded.spec().width == width);
            CHECK(loaded.spec().depth_db == depth);
            CHECK(loaded.spec().bands == spec.bands);
            CHECK(loaded.spec().settle_band_percent == 2.0);
        }
    }
}

TEST_CASE("a table has the fields that other commands rely on") {
    const Json json = Json::parse(paper_json());
    CHECK(json["schema"] == "ripplenotch/table/1");
    CHECK(json["sample_rate_hz"] == 1000.0);
    CHECK(json["gear_ratio"] == 100.0);
    CHECK(json["orders"] == Json({1.0, 2.0}));
    CHECK(json["below_first_band"] == "pass");
    CHECK(json["above_last_band"] == "hold");
    REQUIRE(json["bands"].size() == 9);
    const Json& band = json["bands"][3];
    CHECK(band["number"] == 4);
    CHECK(band["speed_from_deg_s"] == 72.0);
    CHECK(band["speed_to_deg_s"] == 90.0);
    CHECK(band["notches"][1]["order"] == 2.0);
    CHECK(band["notches"][1]["center_hz"] == 45.0);
    CHECK(band["notches"][1]["q"] == 0.25);
    CHECK(band["notches"][1]["depth_db"].is_null());
    CHECK(band["notches"][1]["sos"].size() == 6);
    CHECK(band["notches"][1]["sos"][3] == 1.0);
    for (const char* name : {"dc_delay_ms", "settle_ms", "settle_band_percent", "overshoot_percent"}) {
        CHECK(band[name].is_number());
    }
    CHECK(band["worst_attenuation_db"].size() == 2);
}

TEST_CASE("a table that was edited by hand is refused where it no longer adds up") {
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][2]["notches"][0]["q"] = 1.0; }),
               Contains("table.json: bands[2].notches[0].sos[0]") && Contains("design"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][2]["notches"][0]["sos"][5] = 1.01; }),
               Contains("bands[2].notches[0].sos[5] is 1.01"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][2]["notches"][0]["sos"][3] = 2.0; }),
               Contains("sos[3] is 2"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][2]["notches"][0]["sos"].erase(0); }),
               Contains("5 numbers, expected 6"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][2]["dc_delay_ms"] = 1.0; }),
               Contains("bands[2].dc_delay_ms is 1"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][2]["settle_ms"] = 1.0; }), Contains("settle_ms is 1"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][2]["overshoot_percent"] = 7.0; }),
               Contains("overshoot_percent is 7"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][2]["worst_attenuation_db"][1] = 90.0; }),
               Contains("worst_attenuation_db[1] is 90"));
    CHECK_THAT(table_refusal([](Json& t) { t["sample_rate_hz"] = 2000.0; }), Contains("sos"));
    CHECK_THAT(table_refusal([](Json& t) { t["sample_rate_hz"] = 15.0; }),
               Contains("half the sample rate, 7.5 Hz"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"].erase(0); }), Contains("numbered 2"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"] = Json::array(); }), Contains("no speed bands"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][0]["notches"].erase(0); }),
               Contains("table.json: bands[0]"));
    CHECK_THAT(table_refusal([](Json& t) { t["orders"] = {1.0, 3.0}; }), Contains("expected order 3"));
}

TEST_CASE("a table with a missing, unknown or mistyped field is refused by the field's name") {
    CHECK_THAT(table_refusal([](Json& t) { t.erase("sample_rate_hz"); }),
               Contains("sample_rate_hz is missing"));
    CHECK_THAT(table_refusal([](Json& t) { t["colour"] = "red"; }), Contains("colour is not a known field"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][1]["colour"] = "red"; }), Contains("bands[1].colour"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][1]["notches"][0]["colour"] = 1; }),
               Contains("notches[0].colour"));
    CHECK_THAT(table_refusal([](Json& t) { t["below_first_band"] = "stop"; }),
               Contains("below_first_band is \"stop\", expected one of pass, hold, fade"));
    CHECK_THAT(table_refusal([](Json& t) { t["width"] = "wide"; }), Contains("analog, digital"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"] = 3; }), Contains("bands is not a list"));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][0] = 3; }), Contains("bands[0] is not an object"));
    CHECK_THAT(table_refusal([](Json& t) { t["orders"][0] = "one"; }), Contains("orders holds \"one\""));
    CHECK_THAT(table_refusal([](Json& t) { t["bands"][0]["notches"][0]["q"] = "wide"; }),
               Contains("expected a number"));
    CHECK_THAT(table_refusal([](Json& t) { t["schema"] = "ripplenotch/joint/1"; }),
               Contains("ripplenotch/table/1"));
}

namespace {

// Calls `visit` with a pointer to every value inside `json`.
void every_value(const Json& json, const std::string& pointer,
                 const std::function<void(const std::string&)>& visit) {
    if (!pointer.empty()) visit(pointer);
    if (json.is_object()) {
        for (const auto& [name, value] : json.items()) every_value(value, pointer + "/" + name, visit);
    } else if (json.is_array()) {
        for (std::size_t i = 0; i < json.size(); ++i) {
            every_value(json[i], pointer + "/" + std::to_string(i), visit);
        }
    }
}

}  // namespace

TEST_CASE(
    "whatever one value of a table is changed into, it is loaded whole or refused by name, never anything "
    "else") {
    TableSpec spec = paper_spec();
    spec.bands.resize(2);
    const Json good = Json::parse(table_to_json(CandidateTable::design(spec), provenance));
    const std::vector<Json> replacements = {nullptr,
                                            true,
                                            -1.0,
                                            0.0,
                                            1e-300,
                                            1e300,
                                            1.5,
                                            "x",
                                            Json::array(),
                                            Json::object(),
                                            Json::array({1.0, "y"})};
    std::size_t tried = 0, refused = 0;
    every_value(good, "", [&](const std::string& pointer) {
        for (const Json& replacement : replacements) {
            Json changed = good;
            changed[Json::json_pointer(pointer)] = replacement;
            ++tried;
            INFO(pointer << " = " << replacement.dump());
            try {
                (void)table_from_json(changed.dump(), "table.json");
            } catch (const DataError& error) {
                ++refused;
                CHECK_THAT(error.what(), Catch::StartsWith("table.json"));
            }
        }
    });
    CHECK(tried > 500);
    // Accepted are the fields that carry no meaning for a reader (version, command, inputs) and a null for no
    // depth.
    CHECK(refused > tried * 8 / 10);
}

TEST_CASE("a table that ends too early is refused with line and column") {
    const std::string text = paper_json();
    for (std::size_t length = 0; length < text.size() - 2; length += 97) {
        CHECK_THROWS_AS(table_from_json(text.substr(0, length), "table.json"), DataError);
    }
    CHECK_THROWS_WITH(table_from_json(text.substr(0, 60), "table.json"), Contains("table.json:3:"));
}

TEST_CASE("the CSV of Table 1 has the paper's numbers, without dust") {
    const std::string csv = table_to_csv(CandidateTable::design(paper_spec()));
    CHECK_THAT(
        csv, Catch::StartsWith("number,speed_from_deg_s,speed_to_deg_s,center_1_hz,center_2_hz,q,dc_delay_ms,"
                               "settle_ms,overshoot_percent,worst_attenuation_1_db,worst_attenuation_2_db\n"
                               "1,18,36,7.5,15,0.25,"));
    CHECK_THAT(csv, Contains("\n9,162,180,47.5,95,0.25,"));
}
