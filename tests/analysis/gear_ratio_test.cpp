// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/gear_ratio.hpp"

#include <array>
#include <cmath>

#include "analysis/traces.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

OrderLine line_at(double order_output, double amplitude, double error = 0.01, double snr = 50.0) {
    return {order_output, error, snr, amplitude, 120.0};
}

/// Lines as real joints show them: a few times the noise.
OrderLine faint(double order_output, double amplitude, double error = 0.2) {
    return line_at(order_output, amplitude, error, 10.0);
}

double best(const GearRatioResult& result) { return result.fit.candidates.at(0).value; }

double probability_of(const GearRatioResult& result, double ratio) {
    for (const RatioCandidate& one : result.fit.candidates)
        if (std::abs(one.value - ratio) < 0.02 * ratio) return one.score;
    return 0.0;
}

}  // namespace

TEST_CASE("clear lines at 1 : 2 are orders 1 and 2, and the half ratio is a rival with its lines") {
    const std::vector lines{line_at(100.0, 0.8, 0.01, 400.0), line_at(200.0, 0.5, 0.01, 300.0)};
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinAbs(100.0, 0.01));
    CHECK(result.order_of_line[0] == 1);
    CHECK(result.order_of_line[1] == 2);
    CHECK(result.fit.candidates[0].score > conclusive_probability);
    REQUIRE(result.fit.candidates.size() > 1);
    CHECK_THAT(result.fit.candidates[1].value, WithinRel(50.0, 0.02));
    CHECK_THAT(result.fit.candidates[1].reason, Contains("in catalogues; n = 2, 4"));
    CHECK_FALSE(result.fit.second_comb.has_value());
    double total = 0.0;
    for (const auto& candidate : result.fit.candidates) total += candidate.score;
    CHECK(total <= 1.0 + 1e-12);
}

TEST_CASE("an odd line decides between a ratio and its double") {
    const std::vector lines{line_at(240.0, 0.5), line_at(360.0, 0.2)};
    CHECK_THAT(best(fit_gear_ratio(lines, {})), WithinRel(120.0, 1e-3));
}

TEST_CASE("lines of 80 that are those of 160 as well leave both, and a faint one at n = 6 decides") {
    std::vector lines{faint(160.0, 0.056), faint(320.4, 0.037), faint(640.0, 0.057)};
    const auto open = fit_gear_ratio(lines, {});
    CHECK(probability_of(open, 80.0) + probability_of(open, 160.0) > 0.95);
    CHECK(probability_of(open, 80.0) > 0.05);
    CHECK(probability_of(open, 160.0) > 0.05);
    lines.push_back(faint(480.3, 0.02));
    const auto decided = fit_gear_ratio(lines, {});
    REQUIRE(decided.fit.value.has_value());
    CHECK_THAT(*decided.fit.value, WithinRel(80.0, 0.01));
    CHECK(probability_of(decided, 80.0) > probability_of(open, 80.0));
}

TEST_CASE("a missing fundamental does not halve or double the ratio: lines at 2, 4 and 6 with a weak 1") {
    const std::vector lines{faint(240.6, 0.39), faint(481.0, 0.23), faint(721.0, 0.07), faint(120.0, 0.14)};
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinRel(120.2, 0.005));
    CHECK(result.fit.candidates[0].score > conclusive_probability);
}

TEST_CASE("a line on its own: at 202, 101 as n = 2 is the most probable, and at 1768 nothing is") {
    const auto result = fit_gear_ratio(std::vector{faint(202.0, 0.5)}, {});
    CHECK_THAT(best(result), WithinRel(101.0, 0.011));
    CHECK_FALSE(result.fit.value.has_value());
    const auto alone = fit_gear_ratio(std::vector{faint(1768.0, 0.06)}, {.lowest = 12.0, .highest = 2500.0});
    CHECK_FALSE(alone.fit.value.has_value());
    CHECK_FALSE(alone.order_of_line[0].has_value());
}

TEST_CASE("lines that have nothing to do with each other make no conclusive ratio") {
    tests::Noise noise(7);
    int conclusive = 0;
    constexpr int runs = 200;
    for (int run = 0; run < runs; ++run) {
        std::vector<OrderLine> lines;
        for (int i = 0; i < 1 + run % 6; ++i)
            lines.push_back(faint(30.0 + std::fmod(std::abs(noise()) * 3000.0, 850.0), 0.2 + 0.01 * i));
        const auto fit = fit_gear_ratio(lines, {}).fit;
        conclusive += fit.value && fit.candidates[0].score > conclusive_probability ? 1 : 0;
    }
    INFO(conclusive << " of " << runs);
    CHECK(conclusive <= runs / 20);
}

TEST_CASE("lines of both splines give one ratio: 2, 4 and 6 times 100 and 1 and 8 times 101") {
    std::vector<OrderLine> lines;
    for (const int n : {2, 4, 6}) lines.push_back(line_at(100.0 * n, 0.5, 0.03));
    for (const int n : {1, 8}) lines.push_back(line_at(101.0 * n, 0.2, 0.05));
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinAbs(100.0, 0.01));
    REQUIRE(result.fit.second_comb.has_value());
    CHECK_THAT(*result.fit.second_comb, WithinAbs(101.0, 0.01));
    CHECK(result.order_of_line[0] == 2.0);
    REQUIRE(result.order_of_line[4].has_value());
    CHECK_THAT(*result.order_of_line[4], WithinRel(8.08, 1e-4));
}

TEST_CASE("lines of the other spline alone make its turns the ratio") {
    const auto result =
        fit_gear_ratio(std::vector{line_at(101.0, 0.1), line_at(202.0, 0.5), line_at(404.0, 0.2)}, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinAbs(101.0, 0.01));
    CHECK_FALSE(result.fit.second_comb.has_value());
}

TEST_CASE("combs too close together to be separated widen the interval: 480 beside 484.7 is 120") {
    const std::vector lines{line_at(120.0, 0.1, 0.1), line_at(240.4, 0.5, 0.1), line_at(480.0, 0.5, 0.1),
                            line_at(484.7, 0.3, 0.1), line_at(721.0, 0.2, 0.2), line_at(726.0, 0.2, 0.2)};
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinRel(120.0, 0.005));
    CHECK(result.fit.ci95_low < 120.1);
    CHECK(result.fit.ci95_high > 119.9);
    CHECK(result.fit.second_comb.has_value());
}

TEST_CASE("80 is not taken for 160 where a line at 6 times 81 shows the second comb") {
    const std::vector lines{line_at(160.5, 0.05, 0.06),  line_at(640.17, 0.03, 0.11),
                            line_at(320.56, 0.03, 0.18), line_at(960.16, 0.02, 0.67),
                            line_at(485.96, 0.02, 0.37), line_at(1279.2, 0.01, 0.86)};
    CHECK_THAT(best(fit_gear_ratio(lines, {.highest = 1500.0})), WithinRel(80.0, 0.01));
}

TEST_CASE("a stated ratio settles what the lines leave open, and is fitted") {
    const auto agreed =
        fit_gear_ratio(std::vector{line_at(1768.0, 0.06)}, {.hint = GearRatio(221.0), .highest = 2500.0});
    REQUIRE(agreed.fit.value.has_value());
    CHECK_THAT(*agreed.fit.value, WithinAbs(221.0, 1e-6));
    CHECK(agreed.order_of_line[0] == 8);
    CHECK_THAT(agreed.fit.candidates[0].reason, Contains("stated; n = 8"));
    for (const double ratio : {6.0, 16.0, 45.0, 257.0}) {
        CAPTURE(ratio);
        const std::vector lines{line_at(ratio, 0.4, 0.002), line_at(2.0 * ratio, 0.3, 0.002)};
        const auto low = fit_gear_ratio(lines, {.hint = GearRatio(ratio), .lowest = 0.9 * ratio});
        REQUIRE(low.fit.value.has_value());
        CHECK_THAT(*low.fit.value, WithinRel(ratio, 1e-4));
        CHECK(low.fit.candidates[0].score > conclusive_probability);
    }
}

TEST_CASE("a stated ratio is kept where the lines contradict it, which is told with what they give") {
    const auto refused =
        fit_gear_ratio(std::vector{line_at(100.0, 0.8), line_at(200.0, 0.5)}, {.hint = GearRatio(130.0)});
    CHECK(refused.fit.value == 130.0);
    CHECK(refused.fit.contradicted);
    CHECK(probability_of(refused, 100.0) + probability_of(refused, 50.0) > 0.9);
    // Of a belt the stated ratio is the motor's: its own line is named, and those of the gear behind it
    // speak.
    const auto belt =
        fit_gear_ratio(std::vector{faint(200.0, 0.5), faint(100.2, 0.3), faint(84.3, 0.2), faint(400.0, 0.1)},
                       {.hint = GearRatio(84.1666)});
    CHECK(belt.fit.value.value() == Approx(84.1666).epsilon(0.02));
    CHECK(belt.order_of_line[2] == 1.0);
}

TEST_CASE("one line that is off hardly moves the ratio") {
    std::vector<OrderLine> lines;
    for (int n = 1; n <= 8; ++n) lines.push_back(line_at(100.0 * n + (n == 3 ? 0.1 : 0.0), 0.8, 0.02));
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinAbs(100.0, 0.001));  // a plain mean is off by 0.0015
    CHECK(result.fit.residuals.size() == 8);
}

TEST_CASE("the 95 % interval covers the truth in 93 to 97 of a hundred fits") {
    tests::Noise noise(21);
    int covered = 0, given = 0;
    constexpr int runs = 1000;
    for (int run = 0; run < runs; ++run) {
        std::vector<OrderLine> lines{line_at(100.0, 0.8, 0.05, 400.0), line_at(200.0, 0.5, 0.08, 400.0)};
        for (OrderLine& line : lines) line.order_output += line.error * noise();
        const auto result = fit_gear_ratio(lines, {});
        if (!result.fit.value) continue;
        ++given;
        covered += result.fit.ci95_low <= 100.0 && 100.0 <= result.fit.ci95_high;
    }
    CHECK(given >= 990);
    CHECK(covered >= 930);
    CHECK(covered <= 970);
}

TEST_CASE("the comb of five published peaks has its base at 40.26 Hz") {
    // [39.01628, 81.93419, 120.95047, 159.96675, 241.90094] Hz are n = 1, 2, 3, 4, 6; least squares through
    // the origin: sum n f / sum n^2 = 2657.01 / 66 = 40.2577. Here frequencies stand for twice the orders of
    // a joint at 720 deg/s.
    std::vector<OrderLine> lines;
    for (const double hz : {39.01628, 81.93419, 120.95047, 159.96675, 241.90094})
        lines.push_back({0.5 * hz, 0.6, 50.0, 1.0, 720.0});
    const auto result = fit_gear_ratio(lines, {.hint = GearRatio(20.1)});
    CHECK_THAT(best(result), WithinRel(0.5 * 40.2577, 1e-4));
    for (std::size_t i = 0; i < lines.size(); ++i)
        CHECK(result.order_of_line[i] == std::array{1, 2, 3, 4, 6}[i]);
    const std::array expected{-1.24, 1.42, 0.18, -1.06, 0.35};
    REQUIRE(result.fit.residuals.size() == 5);
    for (std::size_t i = 0; i < 5; ++i)
        CHECK_THAT(result.fit.residuals[i].residual_hz, WithinAbs(expected[i], 0.01));
}

TEST_CASE("no lines, no ratio, no candidates") {
    const auto result = fit_gear_ratio({}, {.hint = GearRatio(100.0)});
    CHECK_FALSE(result.fit.value.has_value());
    CHECK(result.fit.candidates.empty());
}

TEST_CASE("a hinted order settles what a lone line is, and leaves it open when no line is there") {
    const std::vector lines{line_at(1768.0, 0.06)};
    const std::vector<int> eight{8};
    const auto hinted = fit_gear_ratio(lines, {.hinted_orders = eight, .highest = 2500.0});
    REQUIRE(hinted.fit.value.has_value());
    CHECK_THAT(*hinted.fit.value, WithinRel(221.0, 1e-3));
    CHECK(hinted.order_of_line[0] == 8);
}

TEST_CASE("a ratio half a per cent off the stated one names the scale error, one within its error does not") {
    const std::vector off{line_at(99.5, 0.8), line_at(199.0, 0.5)};
    const auto odd = fit_gear_ratio(off, {.hint = GearRatio(100.0)});
    REQUIRE(odd.fit.value.has_value());
    CHECK_THAT(*odd.fit.value, WithinRel(99.5, 1e-6));
    REQUIRE_FALSE(odd.notes.empty());
    CHECK(odd.notes.back().find("scale reads 0.50 % high") != std::string::npos);
    const std::vector right{line_at(100.0, 0.8), line_at(200.0, 0.5)};
    CHECK(fit_gear_ratio(right, {.hint = GearRatio(100.0)}).notes.empty());
}
