// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

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
