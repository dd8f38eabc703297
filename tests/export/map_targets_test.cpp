// SPDX-License-Identifier: MIT
// Maps in the form of each target, read back and run.

#include "export/map/map_target.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/export/target.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

RippleMap flat(std::vector<double> orders) {
    RippleMap map;
    map.gear_ratio = GearRatio(100.0);
    map.zero_deg = 3.25;
    map.speeds_deg_s = {5.0, 100.0};
    map.positions_deg = {-90.0, 60.0};
    map.form.speeds_deg_s = {50.0};
    for (const double order : orders) {
        map.orders.emplace_back(order);
        map.values.push_back({{0.6 / order, -0.4 / order}});
        map.spread_nm.push_back(0.0);
    }
    return map;
}

RippleMap rich() {
    RippleMap map = flat({1.0, 2.0});
    map.form = {{5.0, 100.0}, 2};
    for (auto& values : map.values) {
        values.clear();
        for (std::size_t c = 0; c < map.form.columns(); ++c)
            values.emplace_back(0.5 / static_cast<double>(c + 1), 0.1 * static_cast<double>(c % 3) - 0.1);
    }
    return map;
}

struct Through {
    Written written;
    MapCheck check;
};

Through through(const std::string& text, const RippleMap& map) {
    const Spec spec = parse_spec(text);
    const MapTarget& target = find_map_target(spec.name);
    const Settings settings("target", spec, target.keys);
    const std::vector<std::string> heading = {"Made by a test"};
    Through found{target.write(map, settings, heading), {}};
    found.check = verify_map_export(map, target.read(found.written.bytes, "file", map, settings));
    return found;
}

std::string with_needs(std::string_view name) {
    return std::string(name) + (name == "moteus" ? ",kt=0.1" : "");
}

}  // namespace

TEST_CASE("map targets have a name, a summary and a source, each name once") {
    std::set<std::string_view> names;
    for (const MapTarget* target : map_targets()) {
        CHECK(names.insert(target->name).second);
        CHECK_FALSE(target->summary.empty());
        CHECK_FALSE(target->source.empty());
        CHECK(&find_map_target(target->name) == target);
    }
    CHECK_THROWS_WITH(find_map_target("fouriir"), Catch::Contains("did you mean fourier?"));
}

TEST_CASE("every target gives back what it was given to hold, in its own arithmetic") {
    for (const MapTarget* target : map_targets()) {
        INFO(target->name);
        const Through plain = through(with_needs(target->name), flat({1.0, 2.0}));
        CHECK(plain.check.not_held_nm == 0.0);
        CHECK(plain.check.ripple_nm > 0.5);
        CHECK(plain.check.largest_error_nm < 0.02);
        CHECK_FALSE(plain.written.bytes.empty());
    }
}

TEST_CASE("what holds the whole map loses nothing of it, and what holds harmonics says what it leaves out") {
    for (const std::string text : {"fourier", "c-header,precision=double"}) {
        const Through whole = through(text, rich());
        CHECK(whole.check.not_held_nm == 0.0);
        CHECK(whole.check.largest_error_nm < 1e-12);
        CHECK(whole.written.warnings.empty());
    }
    CHECK(through("c-header", rich()).check.largest_error_nm < 1e-5);
    for (const std::string text : {"beckhoff-ax8000", "lut", "moteus,kt=0.1"}) {
        INFO(text);
        const Through part = through(text, rich());
        CHECK(part.check.not_held_nm > 0.05);
        CHECK(part.written.warnings.size() >= 2);
    }
}

TEST_CASE("the second comb comes through where the whole map is held, and the others say that it is not") {
    for (const int side : {1, -1}) {
        RippleMap map = rich();
        map.form = {{5.0, 40.0, 100.0}, 2, side};
        for (std::size_t i = 0; i < map.values.size(); ++i) {
            map.values[i].clear();
            for (std::size_t c = 0; c < map.form.columns(); ++c)
                map.values[i].emplace_back(0.1 * static_cast<double>(c % 7),
                                           0.3 - 0.05 * static_cast<double>(c));
        }
        for (const std::string text : {"fourier", "c-header,precision=double"}) {
            INFO(text);
            const Through whole = through(text, map);
            CHECK(whole.check.not_held_nm == 0.0);
            CHECK(whole.check.largest_error_nm < 1e-11);
            CHECK(whole.written.warnings.empty());
        }
        CHECK(through("c-header", map).check.largest_error_nm < 1e-4);
        for (const std::string text : {"beckhoff-ax8000", "lut", "moteus,kt=0.1"}) {
            INFO(text);
            const auto warnings = through(text, map).written.warnings;
            CHECK(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
                return warning.find("the second comb is left out") != std::string::npos;
            }));
        }
    }
}

TEST_CASE("the drive's slots: ten harmonics, whole orders up to 200, phases in degrees") {
    const Through found =
        through("beckhoff-ax8000,form=sine", flat({1, 2, 2.5, 3, 4, 5, 6, 7, 8, 9, 10, 11, 201}));
    CHECK(found.written.warnings.size() == 3);
    CHECK_THAT(found.written.bytes, Catch::Contains("0x32CB:07,UINT32,1,"));
    CHECK_THAT(found.written.bytes, Catch::Contains("0x32CB:24,REAL32,"));
    CHECK(found.check.largest_error_nm < 1e-4);
    CHECK_THAT(through("beckhoff-ax8000,channel=b", flat({2.0})).written.bytes,
               Catch::Contains("0x36CB:07,UINT32,2,"));
}

TEST_CASE("a table is wrong by no more than it says, a byte's step included") {
    const Through table = through("lut,entries=256", flat({1.0, 2.0}));
    CHECK(table.check.largest_error_nm < 0.72 / 2.0 * std::pow(2.0 * 3.1416 * 2.0 / 256.0, 2) / 8.0 +
                                             0.72 * std::pow(2.0 * 3.1416 / 256.0, 2) / 8.0 + 1e-5);
    CHECK(through("lut,entries=4096,form=c", flat({1.0, 2.0})).check.largest_error_nm < 1e-5);
    // 1.1 Nm at most over 127 steps, half a step of error, and what interpolation adds.
    CHECK(through("moteus,kt=0.1", flat({1.0, 2.0})).check.largest_error_nm < 0.5 * 1.1 / 127.0 + 1e-4);
}

TEST_CASE("a file that was changed is refused with its name") {
    const RippleMap map = flat({1.0, 2.0});
    const MapTarget& target = find_map_target("fourier");
    const Settings settings("target", parse_spec("fourier"), target.keys);
    std::string bytes = target.write(map, settings, {}).bytes;
    bytes.replace(bytes.find("2,both"), 6, "3,both");
    CHECK_THROWS_WITH(target.read(bytes, "x.csv", map, settings), Catch::Contains("x.csv: read '3,both"));
}
