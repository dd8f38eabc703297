// SPDX-License-Identifier: MIT
// What float, six digits and four decimals do to a narrow notch at a low frequency, against published
// figures; and the three structures in float and double.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <random>

#include "export/code/switching_code.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

ExportSection notch(Hertz center, double q, Hertz rate) {
    const NotchSpec spec{center, q};
    return {std::nullopt, spec, center, design_notch(spec, rate)};
}

template <class Rounding>
Biquad each(Biquad f, Rounding rounding) {
    for (double* value : {&f.b0, &f.b1, &f.b2, &f.a1, &f.a2}) *value = rounding(*value);
    return f;
}

Biquad to_float(const Biquad& f) {
    return each(f, [](double v) { return static_cast<double>(static_cast<float>(v)); });
}
Biquad to_six_digits(const Biquad& f) {
    return each(f, [](double v) { return *parse_number(fmt::format("{:g}", v)); });
}
Biquad to_four_decimals(const Biquad& f) {
    return each(f, [](double v) { return *parse_number(fmt::format("{:.4f}", v)); });
}

// What float leaves of a signal, against the same structure in double with the coefficients as designed.
struct Lost {
    double mean_nm, rms_nm;
};

Lost lost_in_float(const ExportSection& designed, Form form, std::span<const double> in, Hertz rate) {
    const bool svf = form == Form::svf;
    const LoadedSection single = svf ? loaded(svf_of(designed, rate), Precision::float32)
                                     : loaded(to_float(designed.section), {form, Precision::float32});
    const LoadedSection exact = svf ? loaded(svf_of(designed, rate), Precision::float64)
                                    : loaded(designed.section, {form, Precision::float64});
    std::vector<double> rounded(in.size()), wanted(in.size());
    run_section(single, in, rounded);
    run_section(exact, in, wanted);
    double sum = 0.0, squares = 0.0;
    for (std::size_t k = in.size() / 2; k < in.size(); ++k) {
        sum += rounded[k] - wanted[k];
        squares += (rounded[k] - wanted[k]) * (rounded[k] - wanted[k]);
    }
    const auto count = static_cast<double>(in.size() - in.size() / 2);
    return {sum / count, std::sqrt(squares / count)};
}

}  // namespace

// Q 1, bilinear, prewarped: rounding figures measured once with other code (NumPy), to the digits given
// there.
TEST_CASE("float coefficients move a 2 Hz notch by 0.02 % at 1 kHz, 0.2 % at 4 kHz, 0.9 % at 10 kHz") {
    struct Case {
        double rate_hz, center_hz, shift_percent, shift_margin, depth_db;
    };
    for (const Case& c :
         {Case{1000, 2, 0.02, 0.005, 67}, Case{4000, 2, 0.2, 0.05, 48}, Case{10000, 2, -0.9, 0.05, 35},
          Case{10000, 0.5, 9.9, 0.05, 14}, Case{10000, 50, 0.003, 0.0005, 85}}) {
        CAPTURE(c.rate_hz, c.center_hz);
        const ExportSection designed = notch(Hertz(c.center_hz), 1.0, Hertz(c.rate_hz));
        const SectionCheck check = check_response(to_float(designed.section), designed, Hertz(c.rate_hz));
        CHECK_THAT(*check.shift_percent, WithinAbs(c.shift_percent, c.shift_margin));
        CHECK_THAT(check.response_depth_db, WithinAbs(c.depth_db, 0.6));
        CHECK(check.pole_radius < 1.0);
    }
}

TEST_CASE("six significant digits move it by 1.6 %, 19 % and 59 %, and make 0.5 Hz at 10 kHz unstable") {
    struct Case {
        double rate_hz, center_hz, shift_percent, depth_db;
    };
    for (const Case& c : {Case{1000, 2, -1.6, 30}, Case{4000, 2, 19, 8}, Case{10000, 2, 59, 1.5},
                          Case{10000, 50, 0.12, 52}}) {
        CAPTURE(c.rate_hz, c.center_hz);
        const ExportSection designed = notch(Hertz(c.center_hz), 1.0, Hertz(c.rate_hz));
        const SectionCheck check =
            check_response(to_six_digits(designed.section), designed, Hertz(c.rate_hz));
        CHECK_THAT(*check.shift_percent, WithinAbs(c.shift_percent, 0.03 * std::abs(c.shift_percent) + 0.02));
        CHECK_THAT(check.response_depth_db, WithinAbs(c.depth_db, 0.6));
    }
    const ExportSection at_4k = notch(2_Hz, 1.0, 4000_Hz);
    CHECK_THAT(20.0 * std::log10(std::abs(dc_gain(to_six_digits(at_4k.section)))), WithinAbs(0.64, 0.01));
    CHECK_THAT(pole_radius(to_six_digits(notch(0.5_Hz, 1.0, 10000_Hz).section)), WithinAbs(1.0019, 1e-4));
}

TEST_CASE("four decimals move it by 13 % and 3.8 %, double the gain at 0 Hz, or put the pole on the circle") {
    const ExportSection slow = notch(2_Hz, 1.0, 1000_Hz), fast = notch(50_Hz, 1.0, 10000_Hz);
    CHECK_THAT(*check_response(to_four_decimals(slow.section), slow, 1000_Hz).shift_percent,
               WithinAbs(13.0, 0.5));
    CHECK_THAT(20.0 * std::log10(dc_gain(to_four_decimals(slow.section))), WithinAbs(6.0, 0.1));
    CHECK_THAT(*check_response(to_four_decimals(fast.section), fast, 10000_Hz).shift_percent,
               WithinAbs(-3.8, 0.05));
    for (const auto& [hz, rate] : {std::pair{2.0, 4000.0}, {2.0, 10000.0}, {0.5, 10000.0}}) {
        CHECK(pole_radius(to_four_decimals(notch(Hertz(hz), 1.0, Hertz(rate)).section)) >= 1.0 - 1e-12);
    }
}

// Published for one input on an 8 Nm offset, 2 Hz at 4 kHz: mean error DF1 -3.3 mNm, DF2T -4.2 mNm,
// state-variable form 5e-10 Nm (6e-6 rms). Sign and digits go with the input, the size does not.
TEST_CASE(
    "in float, direct forms lose millinewton-metres of an 8 Nm load, the state-variable form a thousandth of "
    "that") {
    const ExportSection designed = notch(2_Hz, 1.0, 4000_Hz);
    std::vector<double> ripple(80000), noise(80000);
    std::mt19937_64 engine(1);
    for (std::size_t k = 0; k < ripple.size(); ++k) {
        ripple[k] = 8.0 + std::sin(2.0 * std::numbers::pi * 2.0 / 4000.0 * static_cast<double>(k));
        noise[k] = 8.0 + 0.17 * (static_cast<double>(engine() >> 11) * 0x1p-53 - 0.5);
    }
    for (const Form form : {Form::df1, Form::df2t}) {
        const Lost with_ripple = lost_in_float(designed, form, ripple, 4000_Hz);
        const Lost with_noise = lost_in_float(designed, form, noise, 4000_Hz);
        CAPTURE(with_ripple.mean_nm, with_ripple.rms_nm, with_noise.mean_nm, with_noise.rms_nm);
        CHECK((std::abs(with_ripple.mean_nm) > 2e-3 && std::abs(with_ripple.mean_nm) < 8e-3));
        CHECK((with_noise.rms_nm > 1e-3 && with_noise.rms_nm < 8e-3));
    }
    const Lost with_ripple = lost_in_float(designed, Form::svf, ripple, 4000_Hz);
    const Lost with_noise = lost_in_float(designed, Form::svf, noise, 4000_Hz);
    CAPTURE(with_ripple.mean_nm, with_ripple.rms_nm, with_noise.mean_nm, with_noise.rms_nm);
    CHECK(with_ripple.rms_nm < 5e-5);
    CHECK((with_noise.rms_nm < 2e-5 && std::abs(with_noise.mean_nm) < 5e-6));
}

TEST_CASE("the state-variable form has the transfer function of the section, notches and low-passes alike") {
    std::vector<std::pair<ExportSection, Hertz>> sections;
    for (const double hz : {0.5, 7.5, 100.0, 450.0}) {
        for (const WidthRule width : {WidthRule::analog, WidthRule::digital}) {
            for (const double depth : {20.0, infinite_depth_db}) {
                const NotchSpec spec{Hertz(hz), 1.0, depth, width};
                sections.push_back({{std::nullopt, spec, Hertz(hz), design_notch(spec, 1000_Hz)}, 1000_Hz});
            }
        }
    }
    for (const int order : {1, 2, 5}) {
        const FilterSet low_pass = filter_set(LowPassSpec{13_Hz, order}, 1000_Hz);
        for (const ExportSection& section : low_pass.bands.front().sections)
            sections.push_back({section, 1000_Hz});
    }
    for (const auto& [section, rate] : sections) {
        CAPTURE(section.center.value());
        const Biquad same = biquad_of(svf_of(section, rate));
        for (const double hz : {0.0, 0.1, 3.0, 25.0, 120.0, 333.0, 499.0}) {
            const auto difference = response(same, Hertz(hz), SampledAt(rate)) -
                                    response(section.section, Hertz(hz), SampledAt(rate));
            CHECK(std::abs(difference) < 1e-9);
        }
    }
}

TEST_CASE("all three structures put out the same in double, and differ by rounding alone in float") {
    const ExportSection designed = notch(25_Hz, 0.5, 1000_Hz);
    std::vector<double> in(2000);
    for (std::size_t k = 0; k < in.size(); ++k)
        in[k] = 2.0 + std::sin(0.3 * static_cast<double>(k)) + (k % 97 == 0 ? 1.0 : 0.0);
    for (const Precision precision : {Precision::float64, Precision::float32}) {
        std::vector<double> df1(in.size()), df2t(in.size()), svf(in.size());
        run_section(loaded(designed.section, {Form::df1, precision}), in, df1);
        run_section(loaded(designed.section, {Form::df2t, precision}), in, df2t);
        run_section(loaded(svf_of(designed, 1000_Hz), precision), in, svf);
        const double tolerance = precision == Precision::float64 ? 1e-11 : 1e-4;
        for (std::size_t k = 0; k < in.size(); ++k) {
            REQUIRE_THAT(df2t[k], WithinAbs(df1[k], tolerance));
            REQUIRE_THAT(svf[k], WithinAbs(df1[k], tolerance));
        }
    }
}

TEST_CASE("every finite double and float reads back from its literal, bit for bit") {
    std::mt19937_64 random(13);
    for (int exponent = 0; exponent < 2047; ++exponent) {
        for (int shift = 0; shift <= 52; shift += 4) {
            const std::uint64_t bits = (random() & 0x8000'0000'0000'0000U) |
                                       (static_cast<std::uint64_t>(exponent) << 52U) |
                                       ((random() >> 12U) >> shift << shift);
            const double value = std::bit_cast<double>(bits);
            INFO(decimal(value));
            REQUIRE(std::bit_cast<std::uint64_t>(std::strtod(decimal(value).c_str(), nullptr)) == bits);
            const auto single = std::bit_cast<float>(static_cast<std::uint32_t>(bits >> 32U));
            if (!std::isfinite(single)) continue;
            const std::string text = decimal_float(static_cast<double>(single));
            INFO(text);
            REQUIRE(text.back() == 'f');
            REQUIRE(std::strtof(text.c_str(), nullptr) == single);
        }
    }
}

// The measurement of what was read back, on sections whose faults are known, and the bank that the C header
// runs.

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
