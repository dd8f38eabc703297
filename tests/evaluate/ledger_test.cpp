// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>

#include "evaluate/contenders.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using namespace ripplenotch::testing;

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

namespace {

// 100 samples at 1 kHz. The truth steps from 0 to 10 Nm at sample 10, so that 0.5, 1, 2 and 5 % of its range
// are 0.05, 0.1, 0.2 and 0.5 Nm.
struct Planted {
    std::vector<double> time_s, truth_nm, out_nm;
    std::vector<Switch> changes;
    Planted() {
        for (int k = 0; k < 100; ++k) {
            time_s.push_back(0.001 * k);
            truth_nm.push_back(k < 10 ? 0.0 : 10.0);
        }
        out_nm = truth_nm;
    }
    void add(std::size_t from, std::size_t end, double error_nm) {
        for (std::size_t k = from; k < end; ++k) out_nm[k] += error_nm;
    }
    [[nodiscard]] std::vector<SwitchEntry> ledger(std::size_t block, std::size_t gap_before = 0) const {
        SwitchLedger ledger(truth_nm);
        for (std::size_t at = 0; at < out_nm.size();) {
            if (at > 0 && at == gap_before) ledger.split();
            std::size_t end = std::min(at + block, out_nm.size());
            if (at < gap_before) end = std::min(end, gap_before);
            std::vector<Switch> so_far;  // a filter lists a change once it has put out that sample
            for (const Switch& change : changes) {
                if (change.sample < end) so_far.push_back(change);
            }
            ledger.add(std::span(time_s).subspan(at, end - at), std::span(out_nm).subspan(at, end - at),
                       so_far);
            at = end;
        }
        return ledger.entries();
    }
};

// Two changes: after the first the output is off by 1 Nm for 5 ms, by -2 at 5 ms, 0.3 to 10 ms, 0.08 to 20
// ms.
Planted two_changes() {
    Planted planted;
    planted.changes = {{20, 1, 2, 36.0, 1.25}, {60, 2, 3, 54.0, 0.08}};
    planted.add(19, 20, -0.25);
    planted.add(20, 25, 1.0);
    planted.add(25, 26, -2.0);
    planted.add(26, 30, 0.3);
    planted.add(30, 40, 0.08);
    planted.add(60, 100, 0.08);
    return planted;
}

double ms(const std::optional<Seconds>& time) { return 1e3 * time.value().value(); }

}  // namespace

TEST_CASE("an error planted after a change has the peak and the settling times that were planted") {
    const auto entries = two_changes().ledger(100);
    REQUIRE(entries.size() == 2);
    const SwitchEntry& first = entries[0];
    CHECK(first.change.from_band == 1);
    CHECK(first.time.value() == Approx(0.020));
    CHECK(1e3 * first.stretch.value() == Approx(39.0));  // samples 20 to 59
    CHECK(*first.error_before_nm == Approx(0.25));
    CHECK(*first.peak_error_nm == Approx(2.0));
    CHECK(ms(first.peak_after) == Approx(5.0));
    CHECK(ms(first.settle[0]) == Approx(20.0));  // 0.08 Nm is more than 0.5 % of 10 Nm ...
    CHECK(ms(first.settle[1]) == Approx(10.0));  // ... and less than 1 %
    CHECK(ms(first.settle[2]) == Approx(10.0));  // 0.3 Nm is more than 2 % ...
    CHECK(ms(first.settle[3]) == Approx(6.0));   // ... and less than 5 %
}

TEST_CASE(
    "an error that does not fall until the next change has not settled, one within from the start needs no "
    "time") {
    const SwitchEntry last = two_changes().ledger(100).back();
    CHECK(*last.error_before_nm == 0.0);
    CHECK(*last.peak_error_nm == Approx(0.08));
    CHECK_FALSE(last.settle[0].has_value());
    CHECK(ms(last.settle[1]) == 0.0);
    CHECK(ms(last.settle[3]) == 0.0);
    CHECK(1e3 * last.stretch.value() == Approx(39.0));  // to the end of the log
}

TEST_CASE("what leaves its band again has settled only after that") {
    Planted planted = two_changes();
    planted.add(45, 47, 0.7);
    const SwitchEntry first = planted.ledger(100).front();
    for (const auto& settle : first.settle) CHECK(ms(settle) == Approx(27.0));  // 47 - 20
    CHECK(*first.peak_error_nm == Approx(2.0));
}

TEST_CASE("the switching ledger does not depend on how the log is cut into blocks") {
    const auto whole = two_changes().ledger(100);
    for (const std::size_t block : {1U, 7U, 20U, 33U}) {
        const auto cut = two_changes().ledger(block);
        REQUIRE(cut.size() == whole.size());
        for (std::size_t i = 0; i < whole.size(); ++i) {
            CHECK(cut[i].peak_error_nm == whole[i].peak_error_nm);
            CHECK(cut[i].error_before_nm == whole[i].error_before_nm);
            CHECK(cut[i].settle == whole[i].settle);
            CHECK(cut[i].stretch == whole[i].stretch);
        }
    }
}

TEST_CASE("a gap ends a change's stretch, and what was before it is not before the next change") {
    Planted planted = two_changes();
    planted.add(50, 60, 5.0);  // behind the gap: nobody's
    const auto entries = planted.ledger(100, 50);
    CHECK(*entries[0].peak_error_nm == Approx(2.0));
    CHECK(ms(entries[0].settle[0]) == Approx(20.0));
    CHECK(1e3 * entries[0].stretch.value() == Approx(29.0));
    const auto right_after = planted.ledger(100, 60);
    CHECK_FALSE(right_after[1].error_before_nm.has_value());
}

TEST_CASE("without a truth a change has a time and a jump, and no errors") {
    Planted planted = two_changes();
    planted.truth_nm.clear();
    const auto entries = planted.ledger(100);
    REQUIRE(entries.size() == 2);
    CHECK(entries[0].change.jump_nm == 1.25);
    CHECK(1e3 * entries[0].stretch.value() == Approx(39.0));
    CHECK_FALSE(entries[0].peak_error_nm.has_value());
    CHECK_FALSE(entries[0].settle[3].has_value());
}

TEST_CASE("a twentieth left is 26 dB off, and what a filter should leave is its response's share") {
    const OrderLevel level{1.0, 25.0, {0.8, 0.04}, 0.07};
    CHECK(attenuation_db(level).value() == Approx(20.0 * std::log10(20.0)));
    CHECK_FALSE(attenuation_db({1.0, 25.0, {0.0, 0.0}, {}}).has_value());
    FilterMetrics metrics;
    CHECK_FALSE(predicted_nm(metrics, 0).has_value());
    metrics.gear = GearAccount{GearRatio(100.0), {Order(1.0)}, {}, {}, "test"};
    metrics.measured = LogLevels{};
    metrics.measured->lines.orders = {level};
    metrics.measured->lines.windows = 3;
    // Of what the log shows, unless table or joint say what the ripple is.
    CHECK(predicted_nm(metrics, 0).value() == Approx(0.8 * 0.07));
    metrics.gear->amplitude_nm = {1.2};
    CHECK(predicted_nm(metrics, 0).value() == Approx(1.2 * 0.07));
}
