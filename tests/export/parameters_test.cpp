// SPDX-License-Identifier: MIT
// Frequency, width and depth as drives say them: published cases.
#include "export/text.hpp"

#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/export/target.hpp"
#include "ripplenotch/export/verify.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

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
