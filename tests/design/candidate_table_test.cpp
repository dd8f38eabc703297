// SPDX-License-Identifier: MIT
#include "ripplenotch/design/candidate_table.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/design/notch.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

namespace {

TableSpec paper_spec() {
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = {Order(1.0), Order(2.0)};
    spec.sample_rate = 1000_Hz;
    spec.bands = bands_by_spacing({18_deg_s, 180_deg_s}, 18_deg_s);
    return spec;
}

TableSpec with_bands(std::vector<std::pair<DegPerSec, DegPerSec>> bands) {
    TableSpec spec = paper_spec();
    spec.bands = std::move(bands);
    return spec;
}

}  // namespace

TEST_CASE("Table 1 of the paper: nine bands, centres 7.5 ... 47.5 and 15 ... 95 Hz, to the last bit") {
    const CandidateTable table = CandidateTable::design(paper_spec());
    REQUIRE(table.bands().size() == 9);
    for (std::size_t i = 0; i < 9; ++i) {
        const Band& band = table.bands()[i];
        const double k = static_cast<double>(i);
        CHECK(band.number == static_cast<int>(i) + 1);
        CHECK(band.from.value() == 18.0 + 18.0 * k);
        CHECK(band.to.value() == 36.0 + 18.0 * k);
        REQUIRE(band.notches.size() == 2);
        CHECK(band.notches[0].notch.center.value() == 7.5 + 5.0 * k);
        CHECK(band.notches[1].notch.center.value() == 15.0 + 10.0 * k);
        CHECK(band.notches[0].notch.q == 0.25);
    }
    // "What the twin-T costs": candidate 1 delays by 127 ms.
    CHECK(1e3 * table.bands()[0].dc_delay.value() == Approx(127.0).margin(0.5));
}

TEST_CASE("a table's figures are those of its own sections") {
    const CandidateTable table = CandidateTable::design(paper_spec());
    for (const Band& band : table.bands()) {
        const Cascade cascade = band.cascade();
        CHECK(band.dc_delay == group_delay(cascade, 0_Hz, SampledAt(1000_Hz)));
        CHECK(band.settle == measure_step(cascade, 1000_Hz, 0.5).settle);
        for (std::size_t n = 0; n < 2; ++n) {
            double worst = 1e300;
            for (int k = 0; k <= 10000; ++k) {
                const double v = band.from.value() + (band.to.value() - band.from.value()) * k / 10000.0;
                const Hertz at = ripple_frequency(band.notches[n].order, GearRatio(100.0), DegPerSec(v));
                worst =
                    std::min(worst, -20.0 * std::log10(std::abs(response(cascade, at, SampledAt(1000_Hz)))));
            }
            CHECK(band.worst_attenuation_db[n] == Approx(worst).margin(0.001));
            CHECK(band.worst_attenuation_db[n] <= worst + 1e-9);
        }
    }
}

TEST_CASE("a band holds the speeds above its start up to and including its end, in both directions") {
    const CandidateTable table = CandidateTable::design(paper_spec());
    for (const double sign : {1.0, -1.0}) {
        CHECK(table.find(DegPerSec(sign * 0.0)) == -1);
        CHECK(table.find(DegPerSec(sign * 18.0)) == -1);
        CHECK(table.find(DegPerSec(sign * std::nextafter(18.0, 20.0))) == 0);
        CHECK(table.find(DegPerSec(sign * 36.0)) == 0);
        CHECK(table.find(DegPerSec(sign * std::nextafter(36.0, 40.0))) == 1);
        CHECK(table.find(DegPerSec(sign * 90.0)) == 3);
        CHECK(table.find(DegPerSec(sign * 180.0)) == 8);
        CHECK(table.find(DegPerSec(sign * std::nextafter(180.0, 200.0))) == -2);
        CHECK(table.find(DegPerSec(sign * std::numeric_limits<double>::infinity())) == -2);
    }
    CHECK(table.find(DegPerSec(std::numeric_limits<double>::quiet_NaN())) == -1);
}

TEST_CASE("a hole between two bands belongs to neither") {
    const CandidateTable table =
        CandidateTable::design(with_bands({{18_deg_s, 36_deg_s}, {60_deg_s, 100_deg_s}}));
    CHECK(table.find(36_deg_s) == 0);
    CHECK(table.find(37_deg_s) == -1);
    CHECK(table.find(60_deg_s) == -1);
    CHECK(table.find(61_deg_s) == 1);
}

TEST_CASE("looking a speed up agrees with trying every band in turn") {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> width(0.5, 20.0), hole(0.0, 1.0), speed(-150.0, 150.0);
    for (int round = 0; round < 20; ++round) {
        std::vector<std::pair<DegPerSec, DegPerSec>> bands;
        double at = width(engine);
        while (at < 100.0) {
            const double from = hole(engine) < 0.3 ? at + width(engine) : at;
            at = from + width(engine);
            bands.emplace_back(DegPerSec(from), DegPerSec(at));
        }
        const CandidateTable table = CandidateTable::design(with_bands(bands));
        for (int i = 0; i < 1000; ++i) {
            const double v = speed(engine);
            int expected = std::abs(v) > at ? -2 : -1;
            for (std::size_t k = 0; k < bands.size(); ++k) {
                if (bands[k].first.value() < std::abs(v) && std::abs(v) <= bands[k].second.value()) {
                    expected = static_cast<int>(k);
                }
            }
            REQUIRE(table.find(DegPerSec(v)) == expected);
        }
    }
}

TEST_CASE("bands by spacing touch, cover the range, and carry no dust") {
    const auto bands = bands_by_spacing({DegPerSec(0.1), DegPerSec(1.0)}, DegPerSec(0.1));
    REQUIRE(bands.size() == 9);
    CHECK(bands[2].first.value() == 0.3);
    for (std::size_t i = 1; i < bands.size(); ++i) CHECK(bands[i].first == bands[i - 1].second);
    CHECK(bands.front().first.value() == 0.1);
    CHECK(bands.back().second.value() == 1.0);
    CHECK(bands_by_spacing({0_deg_s, 18_deg_s}, 18_deg_s).size() == 1);
}

TEST_CASE("a range that cannot be cut into whole bands is refused with a width that can") {
    CHECK_THROWS_WITH(bands_by_spacing({18_deg_s, 180_deg_s}, 20_deg_s), Contains("18 deg/s gives 9"));
    CHECK_THROWS_WITH(bands_by_spacing({18_deg_s, 30_deg_s}, 20_deg_s), Contains("12 deg/s gives 1"));
    CHECK_THROWS_WITH(bands_by_spacing({180_deg_s, 18_deg_s}, 18_deg_s),
                      Contains("must end above its start"));
    CHECK_THROWS_WITH(bands_by_spacing({18_deg_s, 18_deg_s}, 18_deg_s), Contains("must end above its start"));
    CHECK_THROWS_WITH(bands_by_spacing({DegPerSec(-18.0), 18_deg_s}, 18_deg_s), Contains("-18"));
    CHECK_THROWS_WITH(bands_by_spacing({18_deg_s, 180_deg_s}, 0_deg_s), Contains("not above 0"));
    CHECK_THROWS_WITH(bands_by_spacing({18_deg_s, 180_deg_s}, DegPerSec(1e-9)),
                      Contains("more than 10000 bands"));
    CHECK_THROWS_WITH(
        bands_by_spacing({18_deg_s, DegPerSec(std::numeric_limits<double>::infinity())}, 18_deg_s),
        Contains("not finite"));
}

TEST_CASE("a table that cannot exist is refused, naming the band and the limit") {
    const auto refused = [](auto change) {
        TableSpec spec = paper_spec();
        change(spec);
        try {
            (void)CandidateTable::design(spec);
        } catch (const UsageError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    CHECK_THAT(refused([](TableSpec& s) { s.sample_rate = 180_Hz; }),
               Contains("band 9 (162-180 deg/s)") && Contains("95 Hz") && Contains("90 Hz"));
    CHECK_THAT(refused([](TableSpec& s) { s.sample_rate = Hertz(); }), Contains("sample rate is 0 Hz"));
    CHECK_THAT(refused([](TableSpec& s) { s.q = 0.0; }),
               Contains("band 1") && Contains("Q 0 is not above 0"));
    CHECK_THAT(refused([](TableSpec& s) { s.orders.clear(); }), Contains("no orders"));
    CHECK_THAT(refused([](TableSpec& s) { s.orders = {Order(2.0), Order(1.0)}; }), Contains("lowest first"));
    CHECK_THAT(refused([](TableSpec& s) {
                   s.orders = {Order(1.0), Order(1.0)};
               }),
               Contains("each order once"));
    CHECK_THAT(refused([](TableSpec& s) { s.orders = {Order(-1.0)}; }), Contains("order -1 is not above 0"));
    CHECK_THAT(refused([](TableSpec& s) { s.gear_ratio = GearRatio(0.0); }), Contains("gear ratio 0"));
    CHECK_THAT(refused([](TableSpec& s) { s.bands.clear(); }), Contains("no speed bands"));
    CHECK_THAT(refused([](TableSpec& s) { s.settle_band_percent = 0.0; }), Contains("settling band 0 %"));
    CHECK_THAT(refused([](TableSpec& s) {
                   s.bands = {{18_deg_s, 36_deg_s}, {30_deg_s, 50_deg_s}};
               }),
               Contains("band 2 (30-50 deg/s) overlaps band 1 (18-36 deg/s)"));
    CHECK_THAT(refused([](TableSpec& s) {
                   s.bands = {{36_deg_s, 18_deg_s}};
               }),
               Contains("must end above its start"));
    CHECK_THAT(refused([](TableSpec& s) {
                   s.bands = {{DegPerSec(-18.0), 18_deg_s}};
               }),
               Contains("start at 0"));
    CHECK_THAT(refused([](TableSpec& s) { s.width = WidthRule::digital, s.q = 0.1; }), Contains("Hz wide"));
}

namespace {

// Notches of Q 0.25 at `center` Hz and 1 kHz.
Band band_of(std::size_t notches, double center) {
    const NotchSpec spec{Hertz(center), 0.25, infinite_depth_db, WidthRule::analog};
    Band band;
    band.notches.assign(notches, {Order(1.0), spec, design_notch(spec, Hertz(1000.0))});
    return band;
}

// How many of such bands are taken.
std::size_t taken(std::size_t notches, double center, std::string& refusal) {
    const Band band = band_of(notches, center);
    TableWork work;
    for (std::size_t count = 0;; ++count) {
        try {
            work.add(band, 0.5);
        } catch (const UsageError& error) {
            refusal = error.what();
            return count;
        }
    }
}

}  // namespace

TEST_CASE("the work on a table is bounded in bands, in notches and in samples", "[design]") {
    std::string refusal;
    CHECK(taken(1, 100.0, refusal) == max_bands);
    CHECK_THAT(refusal, Contains("more than 10000 bands"));
    CHECK(taken(most_orders + 1, 100.0, refusal) == 0);
    CHECK_THAT(refusal, Contains("65 notches in a band, expected at most 64"));
    CHECK(taken(60, 100.0, refusal) == 60000 / (60 * 60));
    CHECK_THAT(refusal, Contains("too many notches"));
    // At 0.01 Hz the slower pole takes 59 s, 59,000 samples, and some 31 of these are counted.
    const std::size_t slow = taken(2, 0.01, refusal);
    CHECK(slow > 2);
    CHECK(slow < 200);
    CHECK_THAT(refusal, Contains("settle too slowly"));
}

TEST_CASE("a table of ten thousand bands can be designed and read", "[design]") {
    TableWork work;
    const Band band = band_of(2, 12.5);  // a low centre, in every band
    for (std::size_t i = 0; i < max_bands; ++i) work.add(band, 0.5);
    CHECK_THROWS_AS(work.add(band, 0.5), UsageError);
}
