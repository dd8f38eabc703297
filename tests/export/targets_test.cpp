// SPDX-License-Identifier: MIT
// Laws that hold for every export target: a target is under test on the day it is listed.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

#include "export/map/map_target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"
#include "ripplenotch/export/target.hpp"
#include "ripplenotch/model/motion.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

// What every target can hold: two whole-hertz notches of Q 2 and 1 % left, and a table of the same shape.
FilterSet two_notches() {
    const std::vector<NotchSpec> specs = {{60_Hz, 2.0, 40.0}, {120_Hz, 2.0, 40.0}};
    return filter_set(specs, 1000_Hz);
}

FilterSet two_full_nulls() {
    const std::vector<NotchSpec> specs = {{60_Hz, 2.0}, {120_Hz, 2.0}};
    return filter_set(specs, 1000_Hz);
}

FilterSet small_table(OutsideRule below = OutsideRule::pass, OutsideRule above = OutsideRule::hold) {
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = {Order(1.0), Order(2.0)};
    spec.sample_rate = 1000_Hz;
    spec.bands = {{180_deg_s, 252_deg_s}, {252_deg_s, 324_deg_s}, {396_deg_s, 468_deg_s}};
    spec.q = 2.0;
    spec.depth_db = 40.0;
    spec.below = below;
    spec.above = above;
    return filter_set(CandidateTable::design(spec));
}

// Firmware's own ranges are tested with each target.
Settings settings_of(const Target& target) {
    Spec spec{std::string(target.name), {}};
    for (const Key& key : target.keys) {
        if (key.name == "limits") spec.values.emplace_back("limits", "none");
    }
    return Settings("target", spec, target.keys);
}

// Filters that this target takes: some do not follow speed.
std::vector<FilterSet> filters_for(const Target& target) {
    std::vector<FilterSet> taken;
    for (const FilterSet& filters : {two_notches(), two_full_nulls(), small_table()}) {
        try {
            static_cast<void>(target.write(filters, settings_of(target), {}));
            taken.push_back(filters);
        } catch (const UsageError&) {
        }
    }
    return taken;
}

/// Its page, or its section of the page of all.
std::string page_of(const Target& target) {
    const std::string folder = source_folder() + "/docs/export/", name(target.name);
    std::stringstream text;
    if (std::ifstream file(folder + name + ".md"); file.good()) {
        text << file.rdbuf();
        return text.str();
    }
    text << std::ifstream(folder + "README.md").rdbuf();
    const std::string all = text.str(), head = "\n## " + name + "\n";
    const std::size_t begin = all.find(head);
    return begin == all.npos ? "" : all.substr(begin, all.find("\n## ", begin + head.size()) - begin);
}

}  // namespace

TEST_CASE("every target has a name of its own, a summary and a source, and is found by its name") {
    std::set<std::string_view> names;
    for (const Target* target : export_targets()) {
        CAPTURE(target->name);
        CHECK(names.insert(target->name).second);
        CHECK_FALSE(target->summary.empty());
        CHECK_FALSE(target->source.empty());
        CHECK(&find_target(target->name) == target);
    }
    CHECK_THROWS_WITH(find_target("c-heder"), Contains("did you mean c-header?"));
}

TEST_CASE(
    "every target takes a filter, and what it writes reads back as stable notches at the designed centres") {
    for (const Target* target : export_targets()) {
        CAPTURE(target->name);
        const auto taken = filters_for(*target);
        REQUIRE(taken.size() >= 2);
        for (const FilterSet& filters : taken) {
            const Settings settings = settings_of(*target);
            const Written written = target->write(filters, settings, {});
            const auto checks =
                verify_export(filters, target->read(written.bytes, "test", filters, settings), "test");
            REQUIRE(checks.size() == filters.bands.size() * filters.sections_per_band());
            for (const SectionCheck& check : checks) {
                CHECK(check.pole_radius < 1.0);
                REQUIRE(check.shift_percent);
                CHECK(std::abs(*check.shift_percent) < 0.01);
                CHECK(std::abs(*check.dc_error_db) < 1e-4);
                CHECK(*check.depth_db > 39.5);
                CHECK(check.q == Approx(2.0).epsilon(0.02));  // whole hertz
            }
        }
    }
}

TEST_CASE("the same filters give the same bytes, and the heading changes comments alone") {
    const std::vector<std::string> heading = {"Made by ripplenotch:",
                                              "ripplenotch export 'a */ int x; /*.json'\n{7, 8}"};
    for (const Target* target : export_targets()) {
        CAPTURE(target->name);
        for (const FilterSet& filters : filters_for(*target)) {
            const Settings settings = settings_of(*target);
            const Written plain = target->write(filters, settings, {});
            CHECK(plain.bytes == target->write(filters, settings, {}).bytes);
            const Written headed = target->write(filters, settings, heading);
            const auto a = target->read(plain.bytes, "test", filters, settings);
            const auto b = target->read(headed.bytes, "test", filters, settings);
            for (std::size_t band = 0; band < a.bands.size(); ++band) {
                for (std::size_t i = 0; i < a.bands[band].size(); ++i)
                    CHECK(a.bands[band][i].biquad == b.bands[band][i].biquad);
            }
        }
    }
}

TEST_CASE("a file cut off anywhere never passes for the whole one in silence") {
    for (const Target* target : export_targets()) {
        CAPTURE(target->name);
        const FilterSet filters = filters_for(*target).back();
        const Settings settings = settings_of(*target);
        const std::string bytes = target->write(filters, settings, {}).bytes;
        const auto whole = target->read(bytes, "test", filters, settings);
        std::size_t refused = 0;
        const std::size_t stride = 1 + bytes.size() / 300;
        for (std::size_t size = 0; size < bytes.size(); size += stride) {
            CAPTURE(size);
            try {
                const auto part =
                    target->read(std::string_view(bytes).substr(0, size), "cut.txt", filters, settings);
                // Then what is missing was not about the filters: a closing brace, a test vector.
                for (std::size_t band = 0; band < whole.bands.size(); ++band) {
                    for (std::size_t i = 0; i < whole.bands[band].size(); ++i)
                        REQUIRE(part.bands.at(band).at(i).biquad == whole.bands[band][i].biquad);
                }
            } catch (const DataError& error) {
                ++refused;
                CHECK_THAT(error.what(), Contains("cut.txt"));
            } catch (const UsageError&) {
                ++refused;  // a number cut short makes a filter that cannot be designed
            }
        }
        CHECK(refused > 0);
    }
}

TEST_CASE("targets that hold coefficients hold low-passes, and those that follow no speed ask for a band") {
    const FilterSet low_pass = filter_set(LowPassSpec{13_Hz, 3}, 1000_Hz);
    for (const Target* target : export_targets()) {
        CAPTURE(target->name);
        const Settings settings = settings_of(*target);
        if (target->notches_only) {
            CHECK_THROWS_WITH(target->write(low_pass, settings, {}),
                              Contains("c-header, ") && Contains(" hold both"));
            continue;
        }
        const auto loaded =
            target->read(target->write(low_pass, settings, {}).bytes, "test", low_pass, settings);
        for (const SectionCheck& check : verify_export(low_pass, loaded, "test")) {
            CHECK_FALSE(check.depth_db);
            CHECK(std::abs(*check.shift_percent) < 0.01);
            CHECK(std::abs(*check.dc_error_db) < 1e-3);
        }
    }
    for (const Target* target : export_targets()) {
        CAPTURE(target->name);
        if (!target->switches) continue;
        const Settings settings = settings_of(*target);
        const std::string bytes = target->write(small_table(), settings, {}).bytes;
        CHECK(target->read(bytes, "test", small_table(), settings).bands.size() == 3);
    }
    const Target& ros = find_target("ros-filters");
    CHECK_THROWS_WITH(ros.write(small_table(), settings_of(ros), {}),
                      Contains("a target that switches: c-header, "));
    CHECK_THROWS_WITH(ros.write(small_table(), settings_of(ros), {}),
                      Contains("3 bands") && Contains("--band"));
    CHECK_NOTHROW(ros.write(only_band(small_table(), 2), settings_of(ros), {}));
    CHECK_THROWS_WITH(only_band(small_table(), 4),
                      Contains("there is no band 4; the table has bands 1 to 3"));
    CHECK_THROWS_WITH(only_band(two_notches(), 1), Contains("only a table has bands"));
}

TEST_CASE("CMSIS-DSP gets a1 and a2 with the opposite sign, says so, and is padded by one") {
    const Target& target = find_target("cmsis-dsp");
    const FilterSet filters = two_notches();
    const std::string text = target.write(filters, settings_of(target), {}).bytes;
    const Biquad& f = filters.bands[0].sections[0].section;
    CHECK(f.a1 < 0.0);
    CHECK_THAT(text, Contains(fmt::format("{}, {}, {}, {}, {},", decimal_float(f.b0), decimal_float(f.b1),
                                          decimal_float(f.b2), decimal_float(-f.a1), decimal_float(-f.a2))));
    CHECK_THAT(text, Contains("ADDS a1 y[n-1]"));
    CHECK_THAT(text, Contains("[5 * RIPPLENOTCH_STAGES + 1]"));
}

TEST_CASE("names that are no identifiers are refused where they would break the file") {
    for (const std::string_view name : {"c-header", "cmsis-dsp", "matlab"}) {
        const Target& target = find_target(name);
        for (const std::string bad : {"9lives", "a-b", "a b", "x;y"}) {
            const Settings settings("target", Spec{std::string(name), {{"name", bad}}}, target.keys);
            CHECK_THROWS_WITH(target.write(two_notches(), settings, {}), Contains("is no name"));
        }
    }
}

TEST_CASE("every target has a page that agrees with its record") {
    for (const Target* target : export_targets()) {
        CAPTURE(target->name);
        const std::string page = page_of(*target);
        REQUIRE_FALSE(page.empty());
        CHECK_THAT(page, Contains(std::string(target->source)));
        for (const Key& key : target->keys) {
            CHECK_THAT(page, Contains(fmt::format(
                                 "| `{}` | {} |", key.name,
                                 key.default_text.empty() ? "-" : fmt::format("`{}`", key.default_text))));
        }
    }
}

// Frequency, width and depth as drives say them: published cases.

namespace {

Settings settings_of(const Target& target, const std::string& text) {
    return Settings("target", parse_spec(text), target.keys);
}

Written written(std::string_view name, const FilterSet& filters, const std::string& keys = "") {
    const Target& target = find_target(name);
    return target.write(filters, settings_of(target, std::string(name) + keys), {});
}

LoadedFilters there_and_back(std::string_view name, const FilterSet& filters, const std::string& keys = "") {
    const Target& target = find_target(name);
    const Settings settings = settings_of(target, std::string(name) + keys);
    return target.read(target.write(filters, settings, {}).bytes, "test", filters, settings);
}

FilterSet notches(std::vector<NotchSpec> specs, Hertz rate = 1000_Hz) { return filter_set(specs, rate); }

double depth_at(const LoadedFilters& filters, Hertz at, Hertz rate) {
    double gain = 1.0;
    for (const LoadedSection& section : filters.bands.front())
        gain *= std::abs(response(section.biquad, at, SampledAt(rate)));
    return -20.0 * std::log10(gain);
}

}  // namespace

TEST_CASE(
    "drive codes: width 0.50, 0.71, 1.00, 2.00, 4.00, 16.00 of the centre at codes 0, 2, 4, 8, 12, 20") {
    for (const auto& [code, width] :
         {std::pair{0, 0.50}, {2, 0.7071}, {4, 1.00}, {8, 2.00}, {12, 4.00}, {20, 16.00}}) {
        const Written out = written("servo-drive", notches({{60_Hz, 1.0 / width}}));
        CHECK_THAT(out.bytes, Contains(fmt::format(",1,60,{},0\n", code)));
        CHECK(out.warnings.empty());
    }
}

TEST_CASE("drive codes: depth d leaves d per cent, 1 is 40 dB, 10 is 20 dB, 50 is 6 dB, 0 is all") {
    for (const auto& [code, db] :
         {std::pair{1, 40.0}, {5, 26.0206}, {10, 20.0}, {25, 12.0412}, {50, 6.0206}}) {
        const auto set = notches({{60_Hz, 1.0, db}});
        CHECK_THAT(written("servo-drive", set).bytes, Contains(fmt::format(",4,{}\n", code)));
        CHECK_THAT(depth_at(there_and_back("servo-drive", set), 60_Hz, 1000_Hz), WithinAbs(db, 1e-3));
    }
}

TEST_CASE("a drive cannot hold what is sharper than Q 2.0, wider than Q 1/16, or below 50 Hz, and says so") {
    CHECK_THROWS_WITH(written("servo-drive", notches({{60_Hz, 5.0}})),
                      Contains("cannot hold Q 5") && Contains("sharpest Q 2.0"));
    CHECK_THROWS_AS(written("servo-drive", notches({{60_Hz, 2.1}})), UsageError);
    CHECK_NOTHROW(written("servo-drive", notches({{60_Hz, 2.0}})));
    CHECK_THROWS_WITH(written("servo-drive", notches({{60_Hz, 0.05}})),
                      Contains("widest width code is 20, Q 0.0625"));
    CHECK_THROWS_WITH(written("servo-drive", notches({{25_Hz, 1.0}})),
                      Contains("would be 25") && Contains("50 to 4999"));
    CHECK_NOTHROW(written("servo-drive", notches({{25_Hz, 1.0}}), ",limits=none"));
    CHECK_THAT(written("servo-drive", notches({{60.4_Hz, 1.1}})).warnings.at(0),
               Contains("60.4 Hz is 60 Hz"));
}

TEST_CASE("a drive refuses low-passes, mixed shapes and the digital width rule") {
    CHECK_THROWS_WITH(written("servo-drive", filter_set(LowPassSpec{13_Hz, 2}, 1000_Hz)),
                      Contains("notches only"));
    CHECK_THROWS_WITH(written("servo-drive", notches({{60_Hz, 1.0}, {120_Hz, 2.0}})), Contains("Q 1 and 2"));
    CHECK_THROWS_WITH(written("servo-drive", notches({{60_Hz, 1.0, infinite_depth_db, WidthRule::digital}})),
                      Contains("digital width rule"));
}

// Maps in the form of each target, read back and run.

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

namespace {

constexpr double pi = std::numbers::pi;

Model model_of(const std::vector<std::string>& specs) {
    Model model{GearRatio(100.0), {}};
    for (const std::string& spec : specs) model.terms.push_back(parse_term(spec));
    return model;
}

// The effect with something to hold in every value.
Term something(const Effect& effect) {
    Term term{&effect, {}};
    for (const Parameter& parameter : effect.parameters)
        term.values.emplace_back(parameter.start != 0.0 ? parameter.start : parameter.neutral);
    return term;
}

constexpr std::string_view tree = R"(<?xml version="1.0"?>
<!-- <mujoco> <joint name="elbow"/> -->
<mujoco><default><joint damping="3"/></default><worldbody><body>
<joint
  name='elbow' damping = "5"/><body><joint name="wrist" axis="0 1 0"></joint></body></body></worldbody>
<equality><joint name="elbow" joint1="wrist"/></equality></mujoco>
)";

}  // namespace

TEST_CASE("every effect of the catalogue is held, or the reason why not is told") {
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        Model model{GearRatio(100.0), {something(*effect)}};
        const JointMjcf mjcf = joint_mjcf(model);
        CHECK(mjcf.holds.size() + mjcf.not_held.size() == 1);
        CHECK(mjcf.held.terms.size() == mjcf.holds.size());
        const auto& told = mjcf.holds.empty() ? mjcf.not_held : mjcf.holds;
        CHECK(told.front().effect == effect->name);
        CHECK(!told.front().words.empty());
        const std::string text = write_mjcf(mjcf, "joint", {});
        CHECK_THAT(text, Contains(std::string(effect->name)));
    }
}

TEST_CASE("values are in newton-metres, radians and seconds") {
    const JointMjcf mjcf = joint_mjcf(
        model_of({"inertia,inertia_kgm2=0.5", "viscous-friction,coefficient_nm_per_deg_s=0.01",
                  "quadratic-viscous-friction,coefficient_nm_per_deg2_s2=1e-4",
                  "coulomb-friction,torque_nm=2,width_deg_s=0.9", "hysteresis,torque_nm=3,width_deg=18",
                  "ripple,order=2,amplitude_nm=0.4,phase_deg=30",
                  "output-ripple,order=3,amplitude_nm=0.2,phase_deg=-100", "gear-ratio,error_percent=10"}));
    CHECK(mjcf.inertia_kgm2 == 0.5);
    CHECK(mjcf.damping == Approx(1.8 / pi));
    CHECK(mjcf.quadratic_damping == Approx(3.24 / pi / pi));
    CHECK(mjcf.frictionloss_nm == 2.0);
    CHECK(mjcf.friction_width_rad_s == Approx(0.005 * pi));
    REQUIRE(mjcf.bristles.size() == 1);
    CHECK(mjcf.bristles[0].stiffness_nm_rad == Approx(30.0 / pi));
    REQUIRE(mjcf.waves.size() == 2);
    CHECK(mjcf.waves[0].poles == Approx(220.0));  // with the ratio of the log
    CHECK(mjcf.waves[0].phase_rad == Approx(2.0 * pi / 3.0));
    CHECK(mjcf.waves[1].poles == 3.0);
    CHECK(mjcf.waves[1].phase_rad == Approx(35.0 / 18.0 * pi));
    CHECK(mjcf.not_held.empty());
}

TEST_CASE("two weights are one, and two lines of an order have names of their own") {
    const Model model =
        model_of({"gravity,amplitude_nm=3,phase_deg=20", "gravity,amplitude_nm=2,phase_deg=130",
                  "ripple,order=1,amplitude_nm=1,phase_deg=0", "ripple,order=1,amplitude_nm=1,phase_deg=90"});
    const JointMjcf mjcf = joint_mjcf(model);
    const Motion motion = make_motion("poly6,from=-90deg,to=200deg,duration=2s", 50_Hz);
    const auto expected = predict_nm(model, motion);
    for (std::size_t k = 0; k < motion.size(); ++k) {
        const double q = motion.position_deg[k] * pi / 180.0;
        double sum = mjcf.weight_nm * std::cos(q + mjcf.weight_rad);
        for (const MjcfWave& wave : mjcf.waves)
            sum += wave.amplitude_nm * std::sin(wave.poles * q + wave.phase_rad);
        CHECK(sum == Approx(expected[k]).margin(1e-9));
    }
    CHECK(mjcf.waves[0].name != mjcf.waves[1].name);
}

TEST_CASE("ripple that a resonance of its own changes is not held without it") {
    Model model{GearRatio(100.0), {}};
    for (const char* term :
         {"ripple,order=1,amplitude_nm=0.2,phase_deg=0", "ripple,order=2,amplitude_nm=0.3,phase_deg=0",
          "resonance,frequency_hz=30,damping=0.3,direct=1,direct_phase_deg=180,order=2"})
        model.terms.push_back(parse_term(term));
    const JointMjcf mjcf = joint_mjcf(model);
    REQUIRE(mjcf.waves.size() == 1);
    CHECK(mjcf.waves[0].name == "ripple_1");
    REQUIRE(mjcf.not_held.size() == 2);
    CHECK(mjcf.not_held[0].effect == "ripple");
    CHECK(mjcf.not_held[1].effect == "resonance");
}

TEST_CASE("a friction below 0 is the simulation's, and no joint holds it") {
    for (const char* name : {"coulomb-friction", "viscous-friction", "hysteresis"}) {
        Model model = model_of({name});
        Term& term = model.terms[0];
        for (std::size_t p = 0; p < term.values.size(); ++p)
            term.values[p] = term.effect->parameters[p].start;
        term.values[0] = -0.3;
        const JointMjcf mjcf = joint_mjcf(model);
        CHECK(mjcf.held.terms.empty());
        REQUIRE(mjcf.not_held.size() == 1);
        CHECK_THAT(mjcf.not_held[0].words, Contains("below 0"));
    }
}

TEST_CASE("a second step of friction is told, and so is a bristle that does not begin at rest") {
    const JointMjcf two = joint_mjcf(model_of(
        {"coulomb-friction,torque_nm=2,width_deg_s=0.2", "coulomb-friction,torque_nm=1,width_deg_s=0.2"}));
    CHECK(two.frictionloss_nm == 2.0);
    REQUIRE(two.not_held.size() == 1);
    CHECK_THAT(two.not_held[0].words, Contains("one frictionloss"));
    const JointMjcf begun = joint_mjcf(model_of({"hysteresis,torque_nm=3,width_deg=18,initial_state=0.5"}));
    REQUIRE(begun.not_held.size() == 1);
    CHECK_THAT(begun.not_held[0].words, Contains("act of friction_1 to 0.157"));
    CHECK(begun.held.terms[0].values[2] == 0.0);
}

TEST_CASE("a file of its own keeps the inertia, however much the link weighs") {
    for (const char* weight : {"0.1", "3", "400"}) {
        const std::string text =
            write_mjcf(joint_mjcf(model_of({"inertia,inertia_kgm2=0.5",
                                            "gravity,phase_deg=0,amplitude_nm=" + std::string(weight)})),
                       "a<b", {});
        const auto number = [&](const std::string& word) {
            return std::stod(text.substr(text.find(word + "=\"") + word.size() + 2));
        };
        const double mass = number("mass"), distance = number("pos");
        CHECK(9.81 * mass * distance == Approx(std::stod(weight)));
        CHECK(number("armature") + mass * distance * distance == Approx(0.5));
        CHECK(number("armature") > 0.3);
        CHECK_THAT(text, Contains("name=\"a&lt;b\""));
    }
}

TEST_CASE("a heading cannot end the comment that it stands in") {
    const std::vector<std::string> heading = {"diagnose --> log.csv --model m.json"};
    const std::string text = write_mjcf(joint_mjcf(model_of({"inertia,inertia_kgm2=1"})), "joint", heading);
    CHECK(text.find("-->") > text.find("A torque sensor shows"));
}

TEST_CASE("of a tree one joint's friction and motors change, and nothing else") {
    const JointMjcf mjcf = joint_mjcf(model_of(
        {"coulomb-friction,torque_nm=2,width_deg_s=0.2", "ripple,order=1,amplitude_nm=1,phase_deg=0"}));
    const std::string once = write_into_mjcf(mjcf, tree, "arm.xml", "elbow", {});
    CHECK_THAT(once, Contains("<joint solreffriction") || Contains("<joint frictionloss=\"2\""));
    CHECK_THAT(once, Contains("name='elbow' damping = \"0\"/>"));
    CHECK_THAT(once, Contains("<joint name=\"wrist\" axis=\"0 1 0\"></joint>") &&
                         Contains("<joint damping=\"3\"/>"));
    CHECK_THAT(once, Contains("name=\"ripple_1_elbow\"") &&
                         Contains("<equality><joint name=\"elbow\" joint1=\"wrist\"/>"));
    CHECK(once.starts_with("<?xml version=\"1.0\"?>\n<!-- <mujoco> <joint name=\"elbow\"/> -->\n<!--\n"));
    // Once more into what was written: names stay different.
    const std::string twice = write_into_mjcf(mjcf, once, "arm.xml", "elbow", {});
    CHECK_THAT(twice, Contains("name=\"ripple_1_elbow_again\""));
    CHECK_THROWS_WITH(write_into_mjcf(mjcf, tree, "arm.xml", "knee", {}),
                      Contains("arm.xml: there is no joint with name=\"knee\""));
}
