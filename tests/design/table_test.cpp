// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "design/band_fit.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/guarantee.hpp"
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

namespace {

TableSpec paper_ripple() {
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = {Order(1.0), Order(2.0)};
    spec.sample_rate = 1000_Hz;
    return spec;
}

DesignGoal goal(std::optional<double> attenuation_db, std::optional<double> delay_ms) {
    DesignGoal asked;
    asked.min_attenuation_db = attenuation_db;
    if (delay_ms) asked.max_delay = Seconds(*delay_ms / 1e3);
    asked.from = 18_deg_s;
    asked.to = 180_deg_s;
    return asked;
}

double largest_delay_s(const CandidateTable& table) {
    double largest = 0.0;
    for (const Band& band : table.bands()) largest = std::max(largest, band.dc_delay.value());
    return largest;
}

// What is left of the ripple at one speed under a true gear ratio: computed from the coefficients in the
// table, with nothing of the search in it.
double attenuation_db(const Band& band, const TableSpec& spec, double ratio, double speed) {
    double left = 0.0, all = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < spec.orders.size(); ++i) {
        const double hz = spec.orders[i].value() * ratio * speed / 360.0;
        const double gain = std::abs(response(band.cascade(), Hertz(hz), SampledAt(spec.sample_rate)));
        largest = std::max(largest, gain);
        if (spec.amplitude_nm.empty()) continue;
        left += std::pow(gain * spec.amplitude_nm[i], 2);
        all += std::pow(spec.amplitude_nm[i], 2);
    }
    return -20.0 * std::log10(spec.amplitude_nm.empty() ? largest : std::sqrt(left / all));
}

std::string refusal(TableSpec spec, const DesignGoal& asked, ExitCode code = ExitCode::limit_violated) {
    try {
        (void)design_for(std::move(spec), asked);
    } catch (const Error& error) {
        CHECK(error.code() == code);
        return error.what();
    }
    return "accepted";
}

std::vector<TableSpec> ripples() {
    TableSpec plain = paper_ripple();
    TableSpec doubtful = paper_ripple();
    doubtful.ratio_error = 0.005;
    TableSpec weighed = doubtful;
    weighed.amplitude_nm = {0.8, 0.1};
    TableSpec robot = paper_ripple();  // an order near half the sample rate at the upper end: 240 of 250 Hz
    robot.orders = {Order(2.0), Order(4.0), Order(4.8)};
    robot.sample_rate = 500_Hz;
    robot.amplitude_nm = {0.4, 0.2, 0.05};
    TableSpec shallow = plain;
    shallow.depth_db = 40.0;
    return {plain, doubtful, weighed, robot, shallow};
}

}  // namespace

TEST_CASE("a designed table holds its attenuation at every speed and every gear ratio that is possible") {
    for (const TableSpec& spec : ripples()) {
        for (const double db : {6.0, 20.0, 30.0}) {
            for (const std::optional<double> delay_ms : {std::optional<double>(), std::optional(60.0)}) {
                const auto [table, reason] = design_for(spec, goal(db, delay_ms));
                CAPTURE(db, reason, spec.orders.size());
                REQUIRE(table.bands().front().from == 18_deg_s);
                REQUIRE(table.bands().back().to == 180_deg_s);
                double least = 1e9;
                for (const Band& band : table.bands()) {
                    for (int i = 0; i <= 400; ++i) {
                        const double share = i / 400.0;
                        const double speed =
                            band.from.value() + share * (band.to.value() - band.from.value());
                        for (const double off : {-1.0, 0.3, 1.0}) {
                            const double ratio = spec.gear_ratio.value() * (1.0 + off * spec.ratio_error);
                            least = std::min(least, attenuation_db(band, spec, ratio, speed));
                        }
                    }
                    CHECK(band.held_attenuation_db >= db);
                }
                CHECK(least >= db);
            }
        }
    }
}

TEST_CASE("a designed table delays no band by more than its budget") {
    for (const TableSpec& spec : ripples()) {
        for (const double ms : {30.0, 80.0}) {
            const auto choice = design_for(spec, goal(std::nullopt, ms));
            for (const Band& band : choice.table.bands()) {
                const Seconds delay = group_delay(band.cascade(), Hertz(0.0), SampledAt(spec.sample_rate));
                CHECK(delay.value() <= 1e-3 * ms * (1.0 + 1e-9));
            }
            CHECK(largest_delay_s(choice.table) > 0.999e-3 * ms);  // and uses it
        }
    }
}

TEST_CASE("more attenuation never takes fewer bands or less delay") {
    for (const TableSpec& spec : ripples()) {
        for (const std::optional<double> delay_ms : {std::optional<double>(), std::optional(30.0)}) {
            std::size_t bands = 0;
            double delay_s = 0.0;
            for (double db = 3.0; db <= 27.0; db += 3.0) {
                const auto table = design_for(spec, goal(db, delay_ms)).table;
                CAPTURE(db, spec.orders.size());
                CHECK(table.bands().size() >= bands);
                CHECK(largest_delay_s(table) >= delay_s * (1.0 - 1e-4));
                bands = table.bands().size();
                delay_s = largest_delay_s(table);
            }
        }
    }
}

TEST_CASE("a longer delay never takes more bands") {
    for (const TableSpec& spec : ripples()) {
        std::size_t bands = 1000;
        for (const double ms : {10.0, 14.0, 20.0, 30.0, 45.0, 70.0, 110.0}) {
            const auto table = design_for(spec, goal(15.0, ms)).table;
            CHECK(table.bands().size() <= bands);
            bands = table.bands().size();
        }
    }
}

TEST_CASE("one notch far below the sample rate takes the published number of bands per decade") {
    // N = ln 10 / ln rho^2, rho = (k + sqrt(k^2 + 4)) / 2, k = g / (Q sqrt(1 - g^2)): theory.md, equation 12.
    TableSpec spec = paper_ripple();
    spec.orders = {Order(1.0)};
    spec.sample_rate = Hertz(100000.0);
    const std::vector<std::vector<std::size_t>> published = {{12, 23, 46, 115}, {37, 73, 146, 364}};
    for (std::size_t row = 0; row < published.size(); ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            DesignGoal asked = goal(20.0 + 10.0 * static_cast<double>(row), std::nullopt);
            asked.q = std::array{0.5, 1.0, 2.0, 5.0}[column];
            CAPTURE(*asked.min_attenuation_db, *asked.q);
            CHECK(design_for(spec, asked).table.bands().size() == published[row][column]);
        }
    }
}

TEST_CASE("one band fewer than designed does not hold it, wherever its edges are put") {
    // Bands of equal ratio are the best ones far below the sample rate; a step finer than the margin is
    // tried.
    TableSpec spec = paper_ripple();
    spec.sample_rate = 20000_Hz;
    DesignGoal asked = goal(20.0, std::nullopt);
    asked.q = 0.8;
    const std::size_t count = design_for(spec, asked).table.bands().size() - 1;
    double best = 0.0;
    for (double lean = 0.98; lean <= 1.02; lean += 0.001) {
        const double ratio = std::pow(10.0, 1.0 / static_cast<double>(count));
        const double center = 18.0 * std::sqrt(ratio) * lean;
        Band band;
        band.from = 18_deg_s;
        band.to = DegPerSec(18.0 * ratio);
        for (const Order order : spec.orders) {
            const NotchSpec notch{ripple_frequency(order, spec.gear_ratio, DegPerSec(center)), 0.8};
            band.notches.push_back({order, notch, design_notch(notch, spec.sample_rate)});
        }
        measure_band(band, spec);
        best = std::max(best, band.held_attenuation_db);
    }
    CHECK(best < 20.0);
}

TEST_CASE("stated bands keep their edges and get the Q with the least delay that holds") {
    TableSpec spec = paper_ripple();
    spec.bands = bands_by_spacing({36_deg_s, 180_deg_s}, 18_deg_s);
    const auto table = design_for(spec, goal(20.0, std::nullopt)).table;
    REQUIRE(table.spec().bands == spec.bands);
    for (const Band& band : table.bands()) {
        CHECK(band.held_attenuation_db >= 20.0);
        CHECK(band.held_attenuation_db < 20.05);  // a higher Q would not
    }
    const auto within = design_for(spec, goal(std::nullopt, 30.0)).table;
    for (const Band& band : within.bands()) CHECK(band.dc_delay.value() <= 0.03);
}

TEST_CASE("a goal that cannot be met is refused with the limit that stands in the way") {
    CHECK_THAT(refusal(paper_ripple(), goal(std::nullopt, 5.0)),
               Contains("--max-delay 5 ms cannot be met at 18 deg/s") && Contains("Q 5") &&
                   Contains("only from 34.36 deg/s on"));
    TableSpec doubtful = paper_ripple();
    doubtful.ratio_error = 0.005;
    CHECK_THAT(refusal(doubtful, goal(40.0, 20.0)),
               Contains("--min-attenuation 40 dB cannot be held at 18 deg/s within --max-delay 20 ms") &&
                   Contains("0.5 % off"));
    TableSpec shallow = paper_ripple();
    shallow.depth_db = 30.0;
    CHECK_THAT(refusal(shallow, goal(40.0, std::nullopt)), Contains("--depth 30 dB"));
    DesignGoal narrow = goal(std::nullopt, 20.0);
    narrow.q = 1.0;
    CHECK_THAT(refusal(paper_ripple(), narrow), Contains("notches of Q 1 delay by 46"));
    TableSpec wide = paper_ripple();
    wide.bands = {{18_deg_s, 90_deg_s}};
    CHECK_THAT(refusal(wide, goal(20.0, std::nullopt)),
               Contains("band 1 (18-90 deg/s)") && Contains("Q 0.25"));
    wide.bands = {{18_deg_s, 36_deg_s}};
    CHECK_THAT(refusal(wide, goal(20.0, 30.0)), Contains("holding 20 dB takes Q 0.26") && Contains("128"));
}

TEST_CASE("what such a refusal offers instead does hold") {
    DesignGoal faster = goal(std::nullopt, 5.0);
    faster.from = DegPerSec(34.37);
    CHECK(largest_delay_s(design_for(paper_ripple(), faster).table) <= 5e-3);
}

TEST_CASE("a goal that makes no sense is a usage error") {
    const auto usage = [](TableSpec spec, const DesignGoal& asked) {
        return refusal(std::move(spec), asked, ExitCode::usage);
    };
    CHECK_THAT(usage(paper_ripple(), goal(std::nullopt, std::nullopt)), Contains("nothing is asked"));
    CHECK_THAT(usage(paper_ripple(), goal(0.0, std::nullopt)), Contains("outside 0 to 120 dB"));
    CHECK_THAT(usage(paper_ripple(), goal(std::nullopt, -1.0)), Contains("-1 ms is not above 0"));
    DesignGoal standstill = goal(20.0, std::nullopt);
    standstill.from = 0_deg_s;
    CHECK_THAT(usage(paper_ripple(), standstill), Contains("no notch holds anything at standstill"));
    TableSpec slow = paper_ripple();
    slow.sample_rate = 150_Hz;
    CHECK_THAT(usage(slow, goal(20.0, std::nullopt)),
               Contains("order 2 reaches half the sample rate, 75 Hz, at 135"));
    TableSpec fixed = paper_ripple();
    fixed.bands = {{18_deg_s, 36_deg_s}};
    DesignGoal all = goal(20.0, std::nullopt);
    all.q = 0.25;
    CHECK_THAT(usage(fixed, all), Contains("nothing is left to choose"));
}

TEST_CASE("the speed below which a delay cannot be met is that of equation 4 at Q 5") {
    // 1.5 / (2 pi f1 Q) = delay for orders 1 and 2; the sampled notch is a little faster.
    TableSpec spec = paper_ripple();
    spec.sample_rate = 100000_Hz;
    for (const double ms : {1.0, 5.0, 20.0}) {
        const double hz = 1.5 / (2.0 * std::numbers::pi * 5.0 * 1e-3 * ms);
        CHECK(slowest_within(spec, Seconds(1e-3 * ms))->value() == Approx(3.6 * hz).epsilon(1e-4));
    }
    CHECK_FALSE(slowest_within(spec, Seconds(1e-9)).has_value());
}

TEST_CASE("the Q for a delay is the lowest that keeps it, where notches may be as narrow or as wide") {
    const TableSpec spec = paper_ripple();
    const BandFit fit(spec);
    for (double center_deg_s = 3.0; center_deg_s < 800.0; center_deg_s *= 1.3) {
        const auto delay_s = [&](double q) { return fit.delay_s(*fit.tune(center_deg_s, {q, {}})); };
        for (double max_s = 1e-4; max_s < 1.0; max_s *= 1.5) {
            INFO(center_deg_s << " deg/s, " << max_s << " s");
            const auto found = fit.tune(center_deg_s, {{}, max_s});
            REQUIRE(found.has_value() == (delay_s(narrowest_q) <= max_s));
            if (!found) continue;
            REQUIRE((found->q == widest_q) == (delay_s(widest_q) <= max_s));
            if (found->q > widest_q) REQUIRE(delay_s(found->q) == Approx(max_s).epsilon(1e-12));
        }
    }
}

TEST_CASE("what is known of an attenuation spares trials and changes no result") {
    const TableSpec spec = paper_ripple();
    DesignGoal goal;
    goal.from = 18_deg_s;
    goal.to = 120_deg_s;
    const BandSearch search(spec, goal);
    for (const std::size_t bands : {3U, 5U, 9U}) {
        const QRule rule = search.rule(0.03);
        const auto held_db = search.attenuation_db(bands, rule);
        REQUIRE(held_db);
        CHECK(search.attenuation_db(bands, rule, 0.0, 0.9 * *held_db) == held_db);
    }
}
