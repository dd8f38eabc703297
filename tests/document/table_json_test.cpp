// SPDX-License-Identifier: MIT
#include "ripplenotch/document/table_json.hpp"

#include <functional>

#include "document/json/json.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

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
