// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/identification.hpp"

#include <algorithm>
#include <array>

#include <cmath>

#include "analysis/traces.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

OrderLine line_at(double order_output, double amplitude, double error = 0.01, double speed = 120.0) {
    return {order_output, error, 50.0, amplitude, true, speed};
}

double best(const GearRatioResult& result) { return result.fit.candidates.at(0).value; }

}  // namespace

TEST_CASE("two lines at 1 : 2 are orders 1 and 2, and the half ratio is named as rival with its reason") {
    const std::vector lines{line_at(100.0, 0.8), line_at(200.0, 0.5)};
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinAbs(100.0, 1e-6));
    CHECK(result.order_of_line[0] == 1);
    CHECK(result.order_of_line[1] == 2);
    REQUIRE(result.fit.candidates.size() > 1);
    CHECK_THAT(result.fit.candidates[1].value, WithinRel(50.0, 0.02));
    CHECK_THAT(result.fit.candidates[1].reason, Contains("no odd order: cannot be distinguished from 100"));
    CHECK_FALSE(result.fit.second_comb.has_value());
    double total = 0.0;
    for (const auto& candidate : result.fit.candidates) total += candidate.score;
    CHECK(total <= 1.0 + 1e-12);
}

TEST_CASE("an odd line decides between a ratio and its double") {
    // Lines at 2 and 3 times 120: neither 240 nor 360 nor 60 explains both as well.
    const std::vector lines{line_at(240.0, 0.5), line_at(360.0, 0.2)};
    CHECK_THAT(best(fit_gear_ratio(lines, {})), WithinRel(120.0, 1e-6));
}

TEST_CASE("a missing fundamental does not halve or double the ratio: lines at 2, 4 and 6 with a weak 1") {
    const std::vector lines{line_at(240.6, 0.39, 0.1), line_at(481.0, 0.23, 0.1), line_at(721.0, 0.07, 0.2),
                            line_at(120.0, 0.14, 0.2)};
    // 2, 4, 8 and 12 times 60 are not excluded, and neither has an odd order that is clear: 120 leads by far.
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.candidates.size() > 1);
    CHECK_THAT(result.fit.candidates[0].value, WithinRel(120.2, 0.003));
    CHECK(result.fit.candidates[0].score > 2.0 * result.fit.candidates[1].score);
}

TEST_CASE("a line on its own settles no ratio: at 202, 101 as n = 2 is the most probable") {
    const std::vector lines{line_at(202.0, 0.5)};
    const auto result = fit_gear_ratio(lines, {});
    CHECK_FALSE(result.fit.value.has_value());
    CHECK_THAT(result.fit.candidates[0].value, WithinRel(101.0, 0.011));
    CHECK_THAT(result.fit.candidates[0].reason, Contains("catalogue"));
    CHECK_THAT(result.fit.candidates[1].value, WithinRel(202.0, 0.006));
}

TEST_CASE("two lines that 100 and 200 explain as well leave both, whichever a catalogue has") {
    const auto result = fit_gear_ratio(std::vector{line_at(200.0, 0.8), line_at(400.0, 0.5)}, {});
    CHECK_FALSE(result.fit.value.has_value());
    const std::vector<double> ratios = undecided_ratios(result.fit);
    REQUIRE(ratios.size() >= 2);
    CHECK_THAT(std::min(ratios[0], ratios[1]), WithinRel(100.0, 0.01));
    CHECK_THAT(std::max(ratios[0], ratios[1]), WithinRel(200.0, 0.01));
    CHECK_FALSE(fit_gear_ratio(std::vector{line_at(240.0, 0.5), line_at(480.0, 0.3), line_at(720.0, 0.1)}, {})
                    .fit.value.has_value());
}

TEST_CASE("strong lines off the comb of a multiple decide for the ratio that explains them") {
    std::vector<OrderLine> lines;  // 45, of which 135 explains three
    for (const int n : {1, 2, 3, 4, 5, 6, 9, 18}) lines.push_back(line_at(45.0 * n, 0.3));
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinRel(45.0, 1e-6));
}

TEST_CASE("two reasons for the same ratio are one ratio") {
    GearRatioFit fit;
    fit.candidates = {
        {100.0, 0.3, "the speed is in rpm", true}, {100.0001, 0.2, "n = 12"}, {120.0, 0.1, "n = 10"}};
    CHECK(undecided_ratios(fit) == std::vector{100.0, 120.0});
    fit.candidates.pop_back();
    CHECK(undecided_ratios(fit).empty());
}

TEST_CASE(
    "a low ratio is found as any other: 16 or its half, not 32, and 6 is what a shaft without a gear may "
    "show, "
    "too") {
    const auto of = [](double ratio, std::optional<GearRatio> hint) {
        const std::vector lines{line_at(ratio, 0.4, 0.002), line_at(2.0 * ratio, 0.3, 0.002)};
        return fit_gear_ratio(lines, {hint}).fit;
    };
    CHECK(undecided_ratios(of(16.0, {})) == std::vector{16.0, 8.0});
    REQUIRE(of(16.0, GearRatio(16.0)).value.has_value());
    CHECK_THAT(*of(16.0, GearRatio(16.0)).value, WithinRel(16.0, 1e-6));
    CHECK_FALSE(of(6.0, {}).value.has_value());
    CHECK(undecided_ratios(of(6.0, {})) == std::vector{6.0, 1.0, 3.0});
    REQUIRE(of(6.0, GearRatio(6.0)).value.has_value());
    CHECK_THAT(*of(6.0, GearRatio(6.0)).value, WithinRel(6.0, 1e-6));
    REQUIRE(of(6.0, GearRatio(1.0)).value.has_value());
    CHECK_THAT(*of(6.0, GearRatio(1.0)).value, WithinRel(1.0, 1e-6));
}

TEST_CASE("orders of a shaft without a gear make no ratio") {
    const auto result = fit_gear_ratio(
        std::vector{line_at(12.0, 0.03, 0.002), line_at(18.0, 0.02, 0.002), line_at(36.0, 0.01, 0.004)}, {});
    CHECK_FALSE(result.fit.value.has_value());
    CHECK(std::any_of(result.fit.candidates.begin(), result.fit.candidates.end(), [](const auto& one) {
        return one.value == 1.0 && one.reason.find("no gear") != std::string::npos;
    }));
}

TEST_CASE("lines once and twice a turn of the joint neither make a ratio nor hide one") {
    const OrderLine once = line_at(1.0, 2.0, 0.003), twice = line_at(2.0, 1.0, 0.003);
    CHECK_FALSE(fit_gear_ratio(std::vector{once, twice}, {}).fit.value.has_value());
    const auto result =
        fit_gear_ratio(std::vector{once, twice, line_at(100.0, 0.5, 0.02), line_at(200.0, 0.4, 0.02)}, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinRel(100.0, 1e-4));
    CHECK_FALSE(result.order_of_line[0].has_value());
}

TEST_CASE("lines of both splines give one ratio: 2, 4 and 6 times 100 and 1, 8, 16 and 18 times 101") {
    std::vector<OrderLine> lines;
    for (const int n : {2, 4, 6}) lines.push_back(line_at(100.0 * n, 0.5, 0.03));
    for (const int n : {1, 8, 16, 18}) lines.push_back(line_at(101.0 * n, 0.2, 0.05));
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinAbs(100.0, 0.01));
    REQUIRE(result.fit.second_comb.has_value());
    CHECK_THAT(*result.fit.second_comb, WithinAbs(101.0, 0.01));
    CHECK(result.order_of_line[0] == 2.0);
    REQUIRE(result.order_of_line[4].has_value());
    CHECK_THAT(*result.order_of_line[4], WithinRel(8.08, 1e-4));
}

TEST_CASE("combs too close together to be separated widen the interval: 480 beside 484.7 is 120") {
    const std::vector lines{line_at(120.0, 0.1, 0.1), line_at(240.4, 0.5, 0.1), line_at(480.0, 0.5, 0.1),
                            line_at(484.7, 0.3, 0.1), line_at(721.0, 0.2, 0.2), line_at(726.0, 0.2, 0.2)};
    const auto result = fit_gear_ratio(lines, {});
    REQUIRE(result.fit.value.has_value());
    CHECK_THAT(*result.fit.value, WithinRel(120.0, 0.005));
    CHECK(result.fit.ci95_low < 120.0);
    CHECK(result.fit.ci95_high > 120.0);
    CHECK(result.fit.ci95_high - result.fit.ci95_low > 0.3);  // each line alone claims 0.1 or better
}

TEST_CASE("80 is not taken for 160 where a line at 6 times 81 shows the second comb") {
    const std::vector lines{line_at(160.5, 0.05, 0.06),  line_at(640.17, 0.03, 0.11),
                            line_at(320.56, 0.03, 0.18), line_at(960.16, 0.02, 0.67),
                            line_at(485.96, 0.02, 0.37), line_at(1279.2, 0.01, 0.86)};
    const auto result = fit_gear_ratio(lines, {});
    CHECK_THAT(best(result), WithinRel(80.0, 0.01));
    if (result.fit.value) CHECK_THAT(*result.fit.value, WithinRel(80.0, 0.01));
}

TEST_CASE("a lone line that nothing explains leaves the ratio open and lists what it could be") {
    const std::vector lines{line_at(1768.0, 0.06)};
    const auto result = fit_gear_ratio(lines, {});
    CHECK_FALSE(result.fit.value.has_value());
    CHECK_FALSE(result.fit.candidates.empty());
    CHECK_FALSE(result.order_of_line[0].has_value());
}

TEST_CASE("a hint settles what the lines leave open, and is refused when no line agrees with it") {
    const std::vector lines{line_at(1768.0, 0.06)};
    const auto agreed = fit_gear_ratio(lines, {GearRatio(221.0)});
    REQUIRE(agreed.fit.value.has_value());
    CHECK_THAT(*agreed.fit.value, WithinAbs(221.0, 1e-6));
    CHECK(agreed.order_of_line[0] == 8);
    CHECK_THAT(agreed.fit.candidates[0].reason, Contains("agrees with the hint 221"));

    const auto refused =
        fit_gear_ratio(std::vector{line_at(100.0, 0.8), line_at(200.0, 0.5)}, {GearRatio(130.0)});
    REQUIRE(refused.fit.value.has_value());
    CHECK_THAT(*refused.fit.value, WithinAbs(100.0, 1e-6));
    REQUIRE_FALSE(refused.notes.empty());
    CHECK_THAT(refused.notes[0], Contains("hint 130 is not supported"));
}

TEST_CASE("a speed in the wrong unit is the likeliest explanation of its lines, and no ratio is given then") {
    struct Slip {
        double factor;
        std::string reason;
    };
    // A speed in rad/s read as deg/s makes every order 57.3 times too large, and so on. A factor of 6 (rpm)
    // puts the lines at n = 6 and 12 of the true ratio: nothing in them tells.
    for (const Slip& slip : {Slip{degrees_per_radian, "if the speed is in rad/s, not deg/s"},
                             Slip{1.0 / degrees_per_radian, "if the speed is in deg/s, not rad/s"},
                             Slip{60.0, "if the speed is wrong by a factor of 60"},
                             Slip{360.0, "if the speed is in turns/s, not deg/s"}}) {
        const std::vector lines{line_at(100.0 * slip.factor, 0.8), line_at(200.0 * slip.factor, 0.5)};
        for (const bool hinted : {false, true}) {
            CAPTURE(slip.reason, hinted);
            RatioQuestion question;
            if (hinted) question.hint = GearRatio(100.0);
            const auto result = fit_gear_ratio(lines, question);
            CHECK_FALSE(result.fit.value.has_value());
            REQUIRE_FALSE(result.fit.candidates.empty());
            CHECK_THAT(result.fit.candidates[0].value, WithinRel(100.0, 1e-6));
            CHECK(result.fit.candidates[0].score > 0.5);
            CHECK_THAT(result.fit.candidates[0].reason, Contains(slip.reason));
            REQUIRE_FALSE(result.notes.empty());
            CHECK_THAT(result.notes.back(), Contains(slip.reason));
        }
    }
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
        std::vector<OrderLine> lines{line_at(100.0, 0.8, 0.05), line_at(200.0, 0.5, 0.08)};
        for (OrderLine& line : lines) line.order_output += line.error * noise();
        const auto result = fit_gear_ratio(lines, {});
        // Where the errors put the lines on combs of their own, several ratios are possible and none is
        // given.
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
        lines.push_back(line_at(0.5 * hz, 1.0, 0.6, 720.0));
    // So coarse, half of it stays possible: which of the two is stated.
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
    const auto result = fit_gear_ratio({}, {GearRatio(100.0)});
    CHECK_FALSE(result.fit.value.has_value());
    CHECK(result.fit.candidates.empty());
}

TEST_CASE("a hinted order settles what a lone line is, and leaves it open when no line is there") {
    const std::vector lines{line_at(1768.0, 0.06)};
    CHECK_FALSE(fit_gear_ratio(lines, {}).fit.value.has_value());
    const std::vector<int> eight{8};
    const auto hinted = fit_gear_ratio(lines, {std::nullopt, eight});
    REQUIRE(hinted.fit.value.has_value());
    CHECK_THAT(*hinted.fit.value, WithinRel(221.0, 1e-6));
    CHECK(hinted.order_of_line[0] == 8);
}

TEST_CASE("a ratio half a per cent off a hint names the scale error, one within its error does not") {
    const std::vector off{line_at(99.5, 0.8), line_at(199.0, 0.5)};
    const auto odd = fit_gear_ratio(off, {GearRatio(100.0)});
    REQUIRE(odd.fit.value.has_value());
    CHECK_THAT(*odd.fit.value, WithinRel(99.5, 1e-6));
    REQUIRE_FALSE(odd.notes.empty());
    CHECK(odd.notes.back().find("scale reads 0.50 % high") != std::string::npos);
    REQUIRE(odd.fit.candidates.size() > 1);
    CHECK(odd.fit.candidates[1].value == 100.0);
    CHECK(odd.fit.candidates[1].score > 0.2);
    const std::vector right{line_at(100.0, 0.8), line_at(200.0, 0.5)};
    CHECK(fit_gear_ratio(right, {GearRatio(100.0)}).notes.empty());
}
