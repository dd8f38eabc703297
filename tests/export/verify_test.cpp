// SPDX-License-Identifier: MIT
// The measurement of what was read back, on sections whose faults are known, and the bank that the C header
// runs.
#include "ripplenotch/export/target.hpp"

#include <cmath>
#include <numbers>

#include "export/code/switching_code.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;
using Catch::Matchers::WithinAbs;

namespace {

FilterSet notch_at(Hertz center, double q = 1.0, double depth_db = infinite_depth_db) {
    const NotchSpec spec{center, q, depth_db};
    return filter_set({&spec, 1}, 1000_Hz);
}

SectionCheck checked(const FilterSet& filters, const Biquad& section) {
    const LoadedFilters loaded_filters{{{loaded(section, {Form::df2t, Precision::float64})}}};
    return verify_export(filters, loaded_filters, "test").front();
}

LoadedFilters as_svf(const FilterSet& filters) {
    LoadedFilters held;
    for (const ExportBand& band : filters.bands) {
        auto& sections = held.bands.emplace_back();
        for (const ExportSection& section : band.sections)
            sections.push_back(loaded(svf_of(section, filters.sample_rate), Precision::float64));
    }
    return held;
}

FilterSet table(OutsideRule below, OutsideRule above) {
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = {Order(1.0)};
    spec.sample_rate = 1000_Hz;
    spec.bands = {{20_deg_s, 40_deg_s}, {60_deg_s, 80_deg_s}};
    spec.below = below;
    spec.above = above;
    return filter_set(CandidateTable::design(spec));
}

}  // namespace

TEST_CASE("a notch that was moved by 1 % is found 1 % off, as deep as the detuning law says") {
    const FilterSet filters = notch_at(25_Hz);
    const SectionCheck check = checked(filters, design_notch({25.25_Hz, 1.0}, 1000_Hz));
    CHECK_THAT(*check.shift_percent, WithinAbs(1.0, 1e-9));
    // |1 - r^2| / sqrt((1 - r^2)^2 + (r / Q)^2) on the bilinear scale: r = tan(pi 25/1000) /
    // tan(pi 25.25/1000).
    const double r = std::tan(0.025 * std::numbers::pi) / std::tan(0.02525 * std::numbers::pi);
    CHECK_THAT(*check.depth_db,
               WithinAbs(-20.0 * std::log10((1.0 - r * r) / std::hypot(1.0 - r * r, r)), 1e-6));
    CHECK_THAT(*check.depth_db, WithinAbs(34.0, 0.05));  // the law's round figure for 1 % and Q 1
    CHECK_THAT(check.response_depth_db, WithinAbs(*check.depth_db, 1e-6));
    CHECK_THAT(check.q, WithinAbs(1.0, 1e-9));
}

TEST_CASE("gain at 0 Hz, mean error and depth are what was planted") {
    Biquad f = design_notch({25_Hz, 1.0, 40.0}, 1000_Hz);
    for (double* b : {&f.b0, &f.b1, &f.b2}) *b *= 1.01;
    const SectionCheck check = checked(notch_at(25_Hz, 1.0, 40.0), f);
    CHECK_THAT(*check.dc_error_db, WithinAbs(20.0 * std::log10(1.01), 1e-8));
    CHECK_THAT(*check.mean_error_nm, WithinAbs(0.08, 1e-8));
    CHECK_THAT(*check.depth_db, WithinAbs(40.0 - 20.0 * std::log10(1.01), 1e-6));
}

TEST_CASE("an unstable section is named whatever the limits, and is not run") {
    Biquad f = design_notch({25_Hz, 1.0}, 1000_Hz);
    f.a2 = 1.01;
    const SectionCheck check = checked(notch_at(25_Hz), f);
    CHECK_FALSE(check.depth_db);
    CHECK_FALSE(check.dc_error_db);
    const auto violations = export_violations({check}, {});
    REQUIRE(violations.size() == 1);
    CHECK_THAT(violations.front(), Contains("section 1 (25 Hz): unstable, pole radius 1.00498"));
}

TEST_CASE("a tolerance is violated by each fault alone") {
    SectionCheck good;
    good.center = 25_Hz;
    good.shift_percent = 0.1;
    good.designed_gain = 0.01;
    good.depth_db = good.response_depth_db = 40.1;
    good.mean_error_nm = -0.01;
    good.pole_radius = 0.9;
    CHECK(export_violations({good}, 0.2).empty());
    const auto found = [&](auto change) {
        SectionCheck bad = good;
        change(bad);
        CHECK(export_violations({bad}, std::nullopt).empty());
        const auto violations = export_violations({good, bad}, 0.2);
        REQUIRE(violations.size() == 1);
        return violations.front();
    };
    CHECK_THAT(found([](auto& c) { c.shift_percent = -0.3; }),
               Contains("centre shifted by -0.3 %, tolerance 0.2 %"));
    CHECK_THAT(found([](auto& c) { c.shift_percent.reset(); }), Contains("no centre is left"));
    CHECK_THAT(found([](auto& c) { c.depth_db = 34.0; }), Contains("gain error at the centre 0.9953 %"));
    CHECK_THAT(found([](auto& c) { c.mean_error_nm = -0.024; }), Contains("gain error at 0 Hz -0.3 %"));
    CHECK_THAT(found([](auto& c) { c.mean_error_nm.reset(); }), Contains("too slow to be run"));
}

TEST_CASE("sections that are missing are refused") {
    const FilterSet filters = notch_at(25_Hz);
    CHECK_THROWS_WITH(verify_export(filters, {}, "a.h"), Contains("a.h: read 0 bands, expected 1"));
    CHECK_THROWS_WITH(verify_export(filters, {{{}}}, "a.h"),
                      Contains("a.h: read 0 sections in band 0, expected 1"));
}

TEST_CASE("numbers of C, MATLAB and YAML are read, and only numbers") {
    TextReader c("/* {9} */ x = {3.0f, -1.5e0f, 3}", "a.h", Comments::c, Precision::float32);
    CHECK(c.numbers('{', '}', 3) == std::vector<double>{3.0, -1.5, 3.0});
    TextReader tenth("0.1f 0.1", "a.h", Comments::c, Precision::float32);
    CHECK(tenth.number() == static_cast<double>(0.1F));
    TextReader m("s = [ 1 2 % 7\n 3 ];", "a.m", Comments::percent, Precision::float64);
    CHECK(m.numbers('[', ']', 3) == std::vector<double>{1.0, 2.0, 3.0});
    for (const std::string text :
         {"[1, 2]", "[1, 2, 3, 4]", "[1, 2, x]", "[1, 2, 0x]", "[1, 2, --3]", "[1, 2, 3"}) {
        CAPTURE(text);
        TextReader wrong(text, "a.yaml", Comments::hash, Precision::float64);
        CHECK_THROWS_WITH(wrong.numbers('[', ']', 3), Contains("a.yaml:1: read"));
    }
}

TEST_CASE("the exported bank passes, holds and fades where the table says") {
    const auto settled_output = [](const FilterSet& filters, double speed) {
        // 20 samples of another torque at that speed tell: passed, filtered, or a share of it.
        const auto regions = switching_regions(filters);
        std::size_t at = 0;
        while (at + 1 < regions.size() && speed > regions[at].to_deg_s) ++at;
        return regions[at];
    };
    CHECK(settled_output(table(OutsideRule::pass, OutsideRule::pass), 10.0).code() == -1);
    CHECK(settled_output(table(OutsideRule::hold, OutsideRule::pass), 10.0).code() == -2);
    CHECK(settled_output(table(OutsideRule::pass, OutsideRule::hold), 90.0).code() == -2);
    CHECK(settled_output(table(OutsideRule::pass, OutsideRule::pass), 50.0).code() == -1);
    CHECK(settled_output(table(OutsideRule::pass, OutsideRule::pass), 20.0).code() == -1);
    CHECK(settled_output(table(OutsideRule::pass, OutsideRule::pass), 20.001).code() == 0);
    CHECK(settled_output(table(OutsideRule::pass, OutsideRule::pass), 40.0).code() == 0);
    const SpeedRegion below = settled_output(table(OutsideRule::fade, OutsideRule::fade), 15.0);
    CHECK((below.code() == 0 && below.full_deg_s == 20.0 && below.none_deg_s == 10.0));
    const SpeedRegion hole = settled_output(table(OutsideRule::fade, OutsideRule::fade), 55.0);
    CHECK((hole.code() == 1 && hole.full_deg_s == 60.0 && hole.none_deg_s == 50.0));
    const SpeedRegion above = settled_output(table(OutsideRule::fade, OutsideRule::fade), 100.0);
    CHECK((above.code() == 1 && above.full_deg_s == 80.0 && above.none_deg_s == 120.0));
}

TEST_CASE("the test vector goes through every region and is not the identity") {
    const FilterSet filters = table(OutsideRule::pass, OutsideRule::fade);
    const auto regions = switching_regions(filters);
    const GoldenVector golden = golden_vector(filters, as_svf(filters));
    std::vector<bool> visited(regions.size());
    std::size_t changed = 0;
    for (std::size_t k = 0; k < golden.torque_nm.size(); ++k) {
        std::size_t at = 0;
        while (at + 1 < regions.size() && std::abs(golden.speed_deg_s[k]) > regions[at].to_deg_s) ++at;
        visited[at] = true;
        changed += golden.expected_nm[k] != golden.torque_nm[k] ? 1 : 0;
        CHECK(golden.torque_nm[k] == static_cast<double>(static_cast<float>(golden.torque_nm[k])));
        CHECK(golden.speed_deg_s[k] == static_cast<double>(static_cast<float>(golden.speed_deg_s[k])));
    }
    CHECK(visited == std::vector<bool>(regions.size(), true));
    CHECK(changed > golden.torque_nm.size() / 3);
}
