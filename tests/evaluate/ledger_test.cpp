// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/ledger.hpp"

#include <cmath>
#include <numbers>

#include "evaluate/contenders.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using namespace ripplenotch::testing;

namespace {}  // namespace

TEST_CASE("the ramp delay of every entry of a ledger, measured on a ramp, is its DC group delay") {
    for (const Contender& method : {contender("switching,table=table.json", paper_table()),
                                    contender("fixed,centers=25Hz:50Hz"), contender("lowpass,cutoff=13rad/s"),
                                    contender("tracking,gear-ratio=100,orders=1:2"), contender("none")}) {
        const auto ledger = delay_ledger(method, 1000_Hz, {});
        REQUIRE_FALSE(ledger.empty());
        for (const LedgerEntry& entry : ledger) {
            CAPTURE(method.text, entry.filter);
            REQUIRE(entry.ramp_delay);
            CHECK(entry.ramp_delay->value() == Approx(entry.dc_delay.value()).margin(1e-7));
            REQUIRE(entry.step);
            for (std::size_t i = 1; i < 4; ++i)
                CHECK(entry.step->settle[i].value() <= entry.step->settle[i - 1].value());
        }
    }
}

TEST_CASE("a table's ledger has one entry a band, with the band's own figures") {
    const auto table = paper_table();
    const auto ledger = delay_ledger(contender("switching,table=table.json", table), 1000_Hz, {12_Hz, true});
    REQUIRE(ledger.size() == 9);
    for (std::size_t i = 0; i < 9; ++i) {
        const Band& band = table->bands()[i];
        CHECK(ledger[i].band == band.number);
        CHECK(ledger[i].from == band.from);
        CHECK(ledger[i].dc_delay == band.dc_delay);
        CHECK(ledger[i].step->settle[0].value() == Approx(band.settle.value()).margin(1.1e-3));
        CHECK(ledger[i].step->overshoot_percent == Approx(band.overshoot_percent).margin(1e-6));
        const auto gain = response(band.cascade(), 12_Hz, SampledAt(1000_Hz));
        CHECK(std::remainder(*ledger[i].phase_lag_deg + degrees_per_radian * std::arg(gain), 360.0) ==
              Approx(0.0).margin(1e-9));
        CHECK(*ledger[i].crossover_db == Approx(20.0 * std::log10(std::abs(gain))).margin(1e-9));
    }
}

TEST_CASE("far below every centre the phase lag is the delay: 0.36 degrees for each hertz and millisecond") {
    const auto figures = [](const Contender& method, double hz) {
        const auto frozen = method.frozen(1000_Hz, 90_deg_s);
        const auto at = at_crossover(frozen->cascade, Hertz(hz), SampledAt(1000_Hz));
        return at.phase_lag_deg /
               (0.36 * hz * 1e3 * group_delay(frozen->cascade, Hertz(0.0), SampledAt(1000_Hz)).value());
    };
    CHECK(figures(contender("fixed,centers=25Hz:50Hz"), 0.05) == Approx(1.0).epsilon(1e-4));
    CHECK(figures(contender("lowpass,cutoff=13Hz,order=4"), 0.05) == Approx(1.0).epsilon(1e-4));
}

TEST_CASE("a long row of notches has the published phase lag, beyond a half turn too") {
    // ArduPilot's regression case with single notches, at 1, 2, 5, 10 Hz: 11.999, 24.015, 60.339, 122.904
    // deg.
    Cascade cascade;
    for (int copy = 0; copy < 8; ++copy) {
        for (int harmonic = 1; harmonic <= 4; ++harmonic) {
            const double f = 46.0 * harmonic, low = f - 11.5 * harmonic;
            cascade.push_back(
                design_notch({Hertz(f), f * low / (f * f - low * low), 60.0, WidthRule::analog}, 2000_Hz));
        }
    }
    CHECK(at_crossover(cascade, 1_Hz, SampledAt(2000_Hz)).phase_lag_deg == Approx(11.999).margin(0.01));
    CHECK(at_crossover(cascade, 10_Hz, SampledAt(2000_Hz)).phase_lag_deg == Approx(122.904).margin(0.01));
    CHECK(at_crossover(cascade, 16_Hz, SampledAt(2000_Hz)).phase_lag_deg > 180.0);
    CHECK_THROWS_AS(at_crossover(cascade, 1000_Hz, SampledAt(2000_Hz)), UsageError);
    CHECK_THROWS_AS(at_crossover(cascade, 0_Hz, SampledAt(2000_Hz)), UsageError);
}

TEST_CASE("the longest delay of a range of speeds is that of the slowest notch in it") {
    const auto table = paper_table();
    const Contender method = contender("switching,table=table.json", table);
    CHECK(longest_delay(method, 1000_Hz, {40_deg_s, 170_deg_s}).delay == table->bands()[1].dc_delay);
    CHECK(longest_delay(method, 1000_Hz, {100_deg_s, 170_deg_s}).delay == table->bands()[4].dc_delay);
    CHECK(longest_delay(contender("none"), 1000_Hz, {0_deg_s, 100_deg_s}).delay.value() == 0.0);
    CHECK(longest_delay(contender("lowpass,cutoff=13rad/s"), 1000_Hz, {0_deg_s, 0_deg_s}).delay.value() ==
          Approx(0.0769).margin(1e-4));
}

TEST_CASE("from the speed that a method names on, it keeps the delay, and just below it does not") {
    const Contender method = contender("tracking,gear-ratio=100,orders=1:2,q=2");
    for (const double ms : {5.0, 10.0, 20.0}) {
        const auto from = within_from(method, 1000_Hz, Seconds(1e-3 * ms));
        REQUIRE(from);
        // 1.5 / (2 pi f1 Q), equation 4
        CHECK(from->value() == Approx(3.6 * 1.5 / (2.0 * std::numbers::pi * 2.0 * 1e-3 * ms)).epsilon(0.03));
        CHECK(longest_delay(method, 1000_Hz, {*from, 300_deg_s}).delay.value() <= 1e-3 * ms);
        CHECK(longest_delay(method, 1000_Hz, {0.97 * *from, 300_deg_s}).delay.value() > 1e-3 * ms);
    }
    CHECK(within_from(contender("none"), 1000_Hz, Seconds(1e-6))->value() == 0.0);
    CHECK_FALSE(within_from(contender("lowpass,cutoff=1Hz"), 1000_Hz, Seconds(1e-3)));
}
