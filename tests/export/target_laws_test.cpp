// SPDX-License-Identifier: MIT
// Laws that hold for every export target: a target is under test on the day it is listed.
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/export/verify.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

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

std::string page_of(const Target& target) {
    std::ifstream file(source_folder() + "/docs/export/" + std::string(target.name) + ".md");
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
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
