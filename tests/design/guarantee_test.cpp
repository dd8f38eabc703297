// SPDX-License-Identifier: MIT
#include "ripplenotch/design/guarantee.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "design/band_fit.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

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
    TableSpec digital = plain;
    digital.width = WidthRule::digital;
    digital.depth_db = 40.0;
    return {plain, doubtful, weighed, robot, digital};
}

// Most of what a frontier costs are its last points, of fifty bands and more: one of two ripples has them.
DesignGoal within_bands(DesignGoal asked, bool bounded) {
    if (bounded) asked.most_bands = 16;
    return asked;
}

}  // namespace

TEST_CASE("a designed table holds its attenuation at every speed and every gear ratio that is possible") {
    for (const TableSpec& spec : ripples()) {
        for (const double db : {6.0, 20.0, 30.0}) {
            for (const std::optional<double> delay_ms : {std::optional<double>(), std::optional(60.0)}) {
                const auto [table, reason, delay] = design_for(spec, goal(db, delay_ms));
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
        for (const double ms : {12.0, 80.0}) {
            DesignGoal asked = goal(std::nullopt, ms);
            if (ms < 20.0) asked.most_bands = 12;  // else as many as are worth it, which takes long to tell
            const auto choice = design_for(spec, asked);
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

TEST_CASE("a longer delay never takes more bands, and with as many bands never holds less") {
    for (const TableSpec& spec : ripples()) {
        std::size_t bands = 1000;
        double held = 0.0;
        for (const double ms : {10.0, 14.0, 20.0, 30.0, 45.0, 70.0, 110.0}) {
            const auto table = design_for(spec, goal(15.0, ms)).table;
            CHECK(table.bands().size() <= bands);
            bands = table.bands().size();
            DesignGoal eight = goal(std::nullopt, ms);
            eight.most_bands = 8;
            const auto best = design_for(spec, eight).table;
            CHECK(best.bands().size() <= 8);
            double least = 1e9;
            for (const Band& band : best.bands()) least = std::min(least, band.held_attenuation_db);
            CHECK(least >= held - 0.005);
            held = least;
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

TEST_CASE("orders count by their amplitudes: a weak one may stay and saves delay or bands") {
    TableSpec equal = paper_ripple(), weak = paper_ripple();
    equal.amplitude_nm = {0.5, 0.5};
    weak.amplitude_nm = {0.5, 0.05};
    DesignGoal together = goal(std::nullopt, 20.0);
    together.min_ripple_reduction_db = 20.0;
    const auto a = design_for(equal, together).table, b = design_for(weak, together).table;
    // Of each order the same goal is the same table, whatever the amplitudes.
    for (const TableSpec& spec : {equal, weak}) {
        const auto each = design_for(spec, goal(20.0, 20.0)).table;
        for (const Band& band : each.bands()) CHECK(band.least_attenuation_db() >= 20.0);
    }
    CHECK(b.bands().size() < a.bands().size());
    for (const Band& band : b.bands()) {
        CHECK(band.held_attenuation_db >= 20.0);
        CHECK(band.worst_attenuation_db[1] < 20.0);
        for (std::size_t i = 0; i < 2; ++i) {
            CHECK(band.predicted_residual_nm[i] ==
                  Approx(weak.amplitude_nm[i] * std::pow(10.0, -band.worst_attenuation_db[i] / 20.0)));
        }
    }
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
    DesignGoal few = goal(40.0, 20.0);
    few.most_bands = 32;
    CHECK_THAT(refusal(paper_ripple(), few), Contains("takes 179 bands, more than --max-bands 32") &&
                                                 Contains("so many hold 24.9 dB, or 40 dB with 81.9 ms"));
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

TEST_CASE("what those refusals offer instead does hold") {
    DesignGoal instead = goal(40.0, 81.9);
    instead.most_bands = 32;
    CHECK(design_for(paper_ripple(), instead).table.bands().size() <= 32);
    instead = goal(24.9, 20.0);
    instead.most_bands = 32;
    CHECK(design_for(paper_ripple(), instead).table.bands().size() <= 32);
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

TEST_CASE("along a frontier neither figure gets better without the other getting worse") {
    for (const std::size_t ripple : {2U, 4U}) {
        const TableSpec spec = ripples()[ripple];
        const auto asking = [&](std::optional<double> db, std::optional<double> delay_ms) {
            return within_bands(goal(db, delay_ms), ripple == 4);
        };
        const Frontier by_attenuation = design_frontier(spec, asking(std::nullopt, std::nullopt));
        REQUIRE(by_attenuation.points.size() > 3);
        for (std::size_t i = 1; i < by_attenuation.points.size(); ++i) {
            CHECK(by_attenuation.points[i].attenuation_db > by_attenuation.points[i - 1].attenuation_db);
            CHECK(by_attenuation.points[i].delay.value() >=
                  by_attenuation.points[i - 1].delay.value() * (1.0 - 1e-4));
        }
        const Frontier by_delay = design_frontier(spec, asking(20.0, std::nullopt));
        for (std::size_t i = 1; i < by_delay.points.size(); ++i) {
            CHECK(by_delay.points[i].bands > by_delay.points[i - 1].bands);
            CHECK(by_delay.points[i].delay.value() <= by_delay.points[i - 1].delay.value() * (1.0 + 1e-4));
        }
        const Frontier by_bands = design_frontier(spec, asking(std::nullopt, 20.0));
        for (std::size_t i = 1; i < by_bands.points.size(); ++i) {
            CHECK(by_bands.points[i].bands > by_bands.points[i - 1].bands);
            CHECK(by_bands.points[i].attenuation_db > by_bands.points[i - 1].attenuation_db - 0.005);
        }
    }
}

TEST_CASE("the point that a frontier recommends is the table that the same goal designs") {
    for (const std::size_t ripple : {1U, 3U}) {
        const TableSpec spec = ripples()[ripple];
        for (const DesignGoal& plain :
             {goal(20.0, std::nullopt), goal(std::nullopt, 20.0), goal(15.0, 40.0)}) {
            const DesignGoal asked = within_bands(plain, ripple == 3);
            const Frontier frontier = design_frontier(spec, asked);
            const DesignChoice choice = design_for(spec, asked);
            const TradePoint& point = frontier.points[frontier.recommended];
            CHECK(point.bands == choice.table.bands().size());
            CHECK(point.delay.value() == largest_delay_s(choice.table));
            CHECK(frontier.reason == choice.reason);
            double overshoot_percent = 0.0, settle_s = 0.0;
            for (const Band& band : choice.table.bands()) {
                overshoot_percent = std::max(overshoot_percent, band.overshoot_percent);
                settle_s = std::max(settle_s, band.settle.value());
            }
            CHECK(point.overshoot_percent == overshoot_percent);
            CHECK(point.settle.value() == settle_s);
        }
    }
}

// A digital notch of Q 0.25 at an eighth of the sample rate would be half of it wide: the search took such
// notches for quick ones, and what it designed held nothing.
TEST_CASE("a table of digital notches near half the sample rate holds what was asked, within its delay") {
    TableSpec spec = paper_ripple();
    spec.gear_ratio = GearRatio(50.0);
    spec.orders = {Order(0.5), Order(2.0), Order(4.0)};
    spec.sample_rate = 500_Hz;
    spec.width = WidthRule::digital;
    for (const double delay_ms : {18.1, 40.0}) {
        for (const double wanted_db : {10.0, 16.4, 20.0}) {
            DesignGoal asked = goal(wanted_db, delay_ms);
            asked.from = DegPerSec(39.9);
            asked.to = DegPerSec(199.5);
            const CandidateTable table = design_for(spec, asked).table;
            CHECK(largest_delay_s(table) <= delay_ms / 1e3 * (1.0 + 1e-9));
            for (const Band& band : table.bands()) {
                for (const double speed : {band.from.value(), band.to.value()})
                    CHECK(attenuation_db(band, spec, 50.0, speed) >= wanted_db - 1e-6);
            }
        }
    }
}

// What a search is told beforehand, and what it finds out sooner, changes nothing of what it finds.

namespace {

TableSpec searched_ripple(WidthRule width, std::vector<double> amplitudes_nm) {
    TableSpec spec = paper_ripple();
    spec.width = width;
    spec.amplitude_nm = std::move(amplitudes_nm);
    return spec;
}

}  // namespace

TEST_CASE("the Q for a delay is the one that halving alone comes to, to the last bit") {
    for (const WidthRule width : {WidthRule::analog, WidthRule::digital}) {
        const TableSpec spec = searched_ripple(width, {});
        const BandFit fit(spec, {});
        const auto delay_s = [&](double center_deg_s, double q) {
            return fit.delay_s(*fit.tune(center_deg_s, {q, std::nullopt}));
        };
        for (double center_deg_s = 3.0; center_deg_s < 800.0; center_deg_s *= 1.3) {
            for (double most_s = 1e-4; most_s < 1.0; most_s *= 1.5) {
                INFO(center_deg_s << " deg/s, " << most_s << " s");
                const auto found = fit.tune(center_deg_s, {std::nullopt, most_s});
                double low = widest_q, high = narrowest_q;
                // A digital notch of a Q below f over half the sample rate would be wider than that half.
                const double line_hz = center_deg_s * 2.0 * 100.0 / 360.0;
                if (width == WidthRule::digital) low = std::max(low, (1.0 + 1e-6) * line_hz / 500.0);
                const bool begins_lower = low == widest_q;
                if (delay_s(center_deg_s, low) <= most_s) {
                    high = low;
                } else if (!(delay_s(center_deg_s, high) <= most_s)) {
                    REQUIRE(!found);
                    continue;
                }
                while (high - low > 1e-9 * high) {
                    const double middle = std::sqrt(low * high);
                    (delay_s(center_deg_s, middle) <= most_s ? high : low) = middle;
                }
                REQUIRE(found);
                // Of a search that begins elsewhere by a bit no more is equal than it is exact.
                if (begins_lower)
                    REQUIRE(found->q.front() == high);
                else
                    REQUIRE(found->q.front() == Approx(high).epsilon(2e-9));
            }
        }
    }
}

TEST_CASE("what is known of an attenuation or a delay spares looks and changes no result") {
    for (const auto& amplitudes_nm : {std::vector<double>{}, std::vector<double>{0.8, 0.1}}) {
        const TableSpec spec = searched_ripple(WidthRule::analog, amplitudes_nm);
        DesignGoal goal;
        goal.from = 18_deg_s;
        goal.to = 120_deg_s;
        const BandSearch search(spec, goal);
        std::optional<double> before_s;
        for (const std::size_t bands : {3U, 5U, 9U}) {
            const auto least_s = search.delay_s(20.0, bands, {});
            REQUIRE(least_s);
            if (before_s) CHECK(search.delay_s(20.0, bands, {0.0, *before_s}) == least_s);
            const auto more_s = search.delay_s(25.0, bands, {});
            CHECK(search.delay_s(25.0, bands, {*least_s * (1.0 - delay_as_exact), 1e9}) == more_s);
            const auto held_db = search.attenuation_db(bands, search.rule(*least_s));
            REQUIRE(held_db);
            CHECK(*held_db >= 20.0);
            CHECK(search.attenuation_db(bands, search.rule(*least_s), 0.0, 20.0) == held_db);
            before_s = least_s;
        }
    }
}
