// SPDX-License-Identifier: MIT
// Dates of logs, and the regression of a trend.
#include <cmath>

#include "fleet/trend/joint_history.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/model/noise.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE("a date is the number of its seconds, and back") {
    CHECK(date_seconds("1970-01-01") == 0.0);
    CHECK(date_seconds("2026-11-22T23:30:00Z") == 1795390200.0);  // date -u -d 2026-11-22T23:30:00Z +%s
    CHECK(date_seconds("2000-02-29 12:00") == 951825600.0);
    for (double seconds = -1e9; seconds < 5e9; seconds += 12345678.0) {
        const std::string text = date_text(seconds);
        CHECK(date_seconds(text) == seconds);
        CHECK(text.size() == 20);
    }
}

TEST_CASE("dates sort as their texts do") {
    std::string before;
    for (double seconds = 0.0; seconds < 4e9; seconds += 7654321.0) {
        CHECK(before < date_text(seconds));
        before = date_text(seconds);
    }
}

TEST_CASE("what is no date is none") {
    for (const char* text :
         {"", "2026", "2026-13-01", "2026-02-29", "2026-01-00", "2026-01-01T24:00", "2026-01-01T12",
          "2026-1-1", "20260101", "2026-01-01x", "2026-01-01T12:00:00+01"})
        CHECK_FALSE(date_seconds(text));
}

TEST_CASE("a pattern takes date and robot from a name or from the end of a path") {
    const NamePattern pattern("{robot}_%Y-%m-%d.csv");
    const auto found = pattern.match("logs/2026/R7_2026-03-09.csv");
    REQUIRE(found);
    CHECK(found->robot == "R7");
    CHECK(found->date == "2026-03-09T00:00:00Z");
    CHECK_FALSE(pattern.match("R7_2026-03-09.csv.gz"));
    CHECK_FALSE(pattern.match("R7_2026-02-30.csv"));
    const auto timed = NamePattern("*/%Y%m%d?%H%M%S*").match("a/b/20260309T121314_run.mcap");
    REQUIRE(timed);
    CHECK(timed->date == "2026-03-09T12:13:14Z");
    CHECK(NamePattern("{robot}/%Y-%m-%d.csv").match("x/R7/2026-03-09.csv")->robot == "R7");
}

TEST_CASE("a pattern without a day is refused") {
    for (const char* text : {"", "%Y-%m", "%Y%m%d%d", "%Y%m%d%", "%Y%m%d%x"})
        CHECK_THROWS_AS(NamePattern(text), UsageError);
}

TEST_CASE("one more column has the t that arithmetic gives") {
    // Three values of 1, 2, 3 and three of 5, 6, 7: means 2 and 6, pooled variance 1, t = 4 / sqrt(2 / 3).
    const std::vector<double> value = {1, 2, 3, 5, 6, 7}, ones(6, 1.0), step = {0, 0, 0, 1, 1, 1};
    const Regression regression(value, {ones});
    const auto extra = regression.extra(step);
    REQUIRE(extra);
    CHECK_THAT(extra->size, WithinRel(4.0, 1e-12));
    CHECK_THAT(extra->error, WithinRel(std::sqrt(2.0 / 3.0), 1e-12));
    CHECK_THAT(extra->t_squared, WithinRel(24.0, 1e-12));
    CHECK_THAT(regression.first_value(), WithinRel(4.0, 1e-12));
}

TEST_CASE("a column that the others hold has nothing to say") {
    const std::vector<double> value = {1, 2, 3, 5, 6, 7}, ones(6, 1.0), step = {0, 0, 0, 1, 1, 1};
    CHECK_FALSE(Regression(value, {ones, step}).extra(step));
    CHECK(Regression(value, {ones, ones, step}).freedom() == 4.0);
}

TEST_CASE("residuals are beside every column") {
    std::vector<double> value, ones, slope;
    Noise noise(3, NoiseChannel::torque);
    for (int i = 0; i < 40; ++i) {
        value.push_back(2.0 + 0.5 * i + noise.normal());
        ones.push_back(1.0);
        slope.push_back(i);
    }
    const Regression regression(value, {ones, slope});
    double along_ones = 0.0, along_slope = 0.0;
    for (std::size_t i = 0; i < value.size(); ++i) {
        along_ones += regression.residual()[i];
        along_slope += regression.residual()[i] * slope[i];
    }
    CHECK_THAT(along_ones, WithinAbs(0.0, 1e-9));
    CHECK_THAT(along_slope, WithinAbs(0.0, 1e-8));
    CHECK_THAT(regression.first_value(), WithinAbs(2.0, 1.0));
}
