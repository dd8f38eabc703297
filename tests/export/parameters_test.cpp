// SPDX-License-Identifier: MIT
// Frequency, width and depth as firmware and drives say them: identities and published cases.
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

FilterSet table(double q, double depth_db, std::vector<double> orders = {1.0, 2.0},
                OutsideRule below = OutsideRule::pass) {
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    for (const double order : orders) spec.orders.emplace_back(order);
    spec.sample_rate = 1000_Hz;
    spec.bands = bands_by_spacing({180_deg_s, 360_deg_s}, 60_deg_s);
    spec.q = q;
    spec.depth_db = depth_db;
    spec.below = below;
    return filter_set(CandidateTable::design(spec));
}

double depth_at(const LoadedFilters& filters, Hertz at, Hertz rate) {
    double gain = 1.0;
    for (const LoadedSection& section : filters.bands.front())
        gain *= std::abs(response(section.biquad, at, SampledAt(rate)));
    return -20.0 * std::log10(gain);
}

}  // namespace

TEST_CASE("the two firmwares' definitions of Q are one, and each turns back into itself") {
    // Centre 80 Hz, band 40 Hz wide: lower edge 60 Hz, 80 * 60 / (80^2 - 60^2) = 12/7. So for 400 and 300 Hz.
    CHECK_THAT(q_from_bandwidth(80.0, 40.0), WithinRel(12.0 / 7.0, 1e-12));
    CHECK_THAT(q_from_cutoff(400.0, 300.0), WithinRel(12.0 / 7.0, 1e-12));
    for (const double q : {0.0625, 0.25, 1.0, 2.0, 30.0}) {
        for (const double center : {7.5, 25.0, 400.0}) {
            CHECK_THAT(q_from_cutoff(center, cutoff_from_q(center, q)), WithinRel(q, 1e-12));
            CHECK_THAT(q_from_bandwidth(center, bandwidth_from_q(center, q)), WithinRel(q, 1e-11));
        }
    }
}

TEST_CASE("ArduPilot's defaults give the published coefficients and attenuation") {
    const auto set = notches({{80_Hz, q_from_bandwidth(80.0, 40.0), 40.0}});
    CHECK_THAT(written("ardupilot", set).bytes,
               Contains("INS_HNTCH_FREQ,80\nINS_HNTCH_BW,40\nINS_HNTCH_ATT,40\nINS_HNTCH_HMNCS,1\n"));
    const LoadedFilters filters = there_and_back("ardupilot", set);
    const Biquad& f = filters.bands.at(0).at(0).biquad;
    const double single = 1e-7;  // the firmware's floats
    CHECK_THAT(f.b0, WithinAbs(0.878031589487365, single));
    CHECK_THAT(f.b1, WithinAbs(-1.536690667387618, single));
    CHECK_THAT(f.b2, WithinAbs(0.875567581194181, single));
    CHECK_THAT(f.a1, WithinAbs(-1.536690667387618, single));
    CHECK_THAT(f.a2, WithinAbs(0.753599170681546, single));
    for (const auto& [hz, db] :
         {std::pair{80.0, 40.0}, {60.0, 2.868}, {70.0, 7.322}, {90.0, 8.155}, {100.0, 3.990}})
        CHECK_THAT(depth_at(filters, Hertz(hz), 1000_Hz), WithinAbs(db, 1e-3));
}

TEST_CASE("ArduPilot's own unit test: 43 dB at 47 Hz divides a sine by 141") {
    const auto set = notches({{47_Hz, q_from_bandwidth(47.0, 23.5), 43.0}}, 2000_Hz);
    const LoadedFilters filters = there_and_back("ardupilot", set);
    constexpr double period = 2000.0 / 47.0;
    const auto count = static_cast<std::size_t>(1002.0 * period);
    std::vector<double> in(count), out(count);
    for (std::size_t k = 0; k < count; ++k)
        in[k] = 0.7 * std::sin(2.0 * 3.14159265358979 * 47.0 / 2000.0 * static_cast<double>(k));
    run_section(filters.bands.at(0).at(0), in, out);
    double before = 0.0, after = 0.0;
    for (auto k = static_cast<std::size_t>(2.0 * period); k < count; ++k) {
        before += std::abs(in[k]);
        after += std::abs(out[k]);
    }
    CHECK_THAT(before / after, WithinRel(std::pow(10.0, 43.0 / 20.0), 0.01));
}

TEST_CASE("ArduPilot's mask has bit 0 for the first harmonic: 11 is harmonics 1, 2 and 4, 13 is 1, 3 and 4") {
    CHECK_THAT(written("ardupilot", table(1.0, 40.0, {1.0, 2.0, 4.0})).bytes, Contains("HMNCS,11\n"));
    CHECK_THAT(written("ardupilot", table(1.0, 40.0, {1.0, 3.0, 4.0})).bytes, Contains("HMNCS,13\n"));
    CHECK_THAT(written("ardupilot", notches({{25_Hz, 1.0, 40.0}, {75_Hz, 1.0, 40.0}})).bytes,
               Contains("HMNCS,5\n"));
}

TEST_CASE("ArduPilot holds no full null and no unrelated centres, and says so") {
    const Written full = written("ardupilot", notches({{80_Hz, 1.0}}));
    CHECK_THAT(full.bytes, Contains("ATT,50\n"));
    REQUIRE(full.warnings.size() == 1);
    CHECK_THAT(full.warnings.front(), Contains("no full null"));
    CHECK_THROWS_WITH(written("ardupilot", notches({{25_Hz, 1.0, 40.0}, {60_Hz, 1.0, 40.0}})),
                      Contains("60 Hz is 2.4 times 25 Hz"));
    CHECK_THROWS_WITH(written("ardupilot", notches({{7_Hz, 1.0, 40.0}})),
                      Contains("INS_HNTCH_FREQ would be 7"));
    CHECK_NOTHROW(written("ardupilot", notches({{7_Hz, 1.0, 40.0}}), ",limits=none"));
}

TEST_CASE("Betaflight's Q is written times 100, its weights are what is taken away at the centre") {
    // 50 Hz at 180 deg/s; a depth of 20 dB leaves 10 %, so the weight is 90.
    const Written out = written("betaflight", table(5.0, 20.0, {1.0, 3.0}));
    CHECK_THAT(out.bytes, Contains("set rpm_filter_harmonics = 3\nset rpm_filter_weights = 90,0,90\n"
                                   "set rpm_filter_q = 500\nset rpm_filter_min_hz = 50\n"));
    // -3 dB from f / 2Q below to f / 2Q above: 300 Hz at Q 5 is 60 Hz wide.
    const auto sections = there_and_back("betaflight", table(5.0, infinite_depth_db)).bands;
    const ExportSection designed = table(5.0, infinite_depth_db).bands.at(0).sections.at(0);
    const SectionCheck check = check_response(sections.at(0).at(0).biquad, designed, 1000_Hz);
    CHECK_THAT(check.q, WithinRel(5.0, 1e-5));
    CHECK_THAT(*check.shift_percent, WithinAbs(0.0, 1e-4));
}

TEST_CASE(
    "Betaflight's fade leaves 0, 1.9, 6.0, 14.0 dB and everything at 0, 20, 50, 80 and 100 % of the way") {
    // The published case has 100 Hz and 50 Hz of fade. Here the first band begins at 360 deg/s, 100 Hz, and
    // below=fade makes min 50 Hz and fade 50 Hz; so bands are read at motor frequencies of 50 to 100 Hz.
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = {Order(1.0)};
    spec.sample_rate = 1000_Hz;
    spec.q = 5.0;
    spec.below = OutsideRule::fade;
    spec.bands = {{360_deg_s, 400_deg_s}};
    FilterSet set = filter_set(CandidateTable::design(spec));
    const Target& target = find_target("betaflight");
    const Settings settings = settings_of(target, "betaflight");
    const std::string bytes = target.write(set, settings, {}).bytes;
    CHECK_THAT(bytes, Contains("min_hz = 50\nset rpm_filter_fade_range_hz = 50\n"));
    for (const auto& [percent, db] : {std::pair{0.0, 0.0}, {20.0, 1.938}, {50.0, 6.021}, {80.0, 13.979}}) {
        const double motor_hz = 50.0 + 0.5 * percent;
        set.bands.front().from = set.bands.front().to = DegPerSec(3.6 * motor_hz);
        CHECK_THAT(depth_at(target.read(bytes, "test", set, settings), Hertz(motor_hz), 1000_Hz),
                   WithinAbs(db, 1e-3));
    }
    set.bands.front().from = set.bands.front().to = 360_deg_s;
    CHECK(depth_at(target.read(bytes, "test", set, settings), 100_Hz, 1000_Hz) > 100.0);
}

TEST_CASE("Betaflight's ranges are kept unless the firmware is another") {
    CHECK_THROWS_WITH(written("betaflight", table(0.25, infinite_depth_db)),
                      Contains("rpm_filter_q would be 25"));
    CHECK_NOTHROW(written("betaflight", table(0.25, infinite_depth_db), ",limits=none"));
    CHECK_THROWS_WITH(written("betaflight", table(5.0, infinite_depth_db, {1.0, 4.0})),
                      Contains("harmonics 1 to 3 of the motor's turning, and this table has order 4"));
    CHECK_THROWS_WITH(written("betaflight", table(5.0, infinite_depth_db, {0.5})), Contains("order 0.5"));
    CHECK_THROWS_WITH(written("betaflight", notches({{25_Hz, 1.0}, {50_Hz, 1.0}, {75_Hz, 1.0}})),
                      Contains("2 static notches, and this filter has 3"));
    const Written rounded = written("betaflight", notches({{25.4_Hz, 0.25}}));
    CHECK_THAT(rounded.bytes, Contains("set gyro_notch1_hz = 25\nset gyro_notch1_cutoff = 6\n"));
    CHECK_THAT(rounded.warnings.at(0), Contains("25.4 Hz, Q 0.25 is 25 Hz, Q 0.2547"));
}

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

TEST_CASE("parameter targets refuse low-passes, mixed shapes and the digital width rule") {
    for (const std::string_view name : {"servo-drive", "betaflight", "ardupilot"}) {
        CAPTURE(name);
        CHECK_THROWS_WITH(written(name, filter_set(LowPassSpec{13_Hz, 2}, 1000_Hz)),
                          Contains("notches only"));
        CHECK_THROWS_WITH(written(name, notches({{60_Hz, 1.0}, {120_Hz, 2.0}})), Contains("Q 1 and 2"));
        CHECK_THROWS_WITH(written(name, notches({{60_Hz, 1.0, infinite_depth_db, WidthRule::digital}})),
                          Contains("digital width rule"));
    }
}
