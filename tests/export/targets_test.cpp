// SPDX-License-Identifier: MIT
// Laws that hold for every export target: a target is under test on the day it is listed.
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/export/target.hpp"
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
