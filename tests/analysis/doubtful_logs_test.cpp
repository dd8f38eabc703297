// SPDX-License-Identifier: MIT
// Logs that a verdict must not be sure of: tones that look like orders, clocks that are wrong, joints that
// change from log to log.
#include <algorithm>

#include "analysis/traces.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::StartsWith;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using tests::identify_all;

namespace {

const std::vector<tests::Tone> multiples{
    {20.04, 0.3, 0.1}, {30.06, 0.25, 1.0}, {40.08, 0.4, 2.0}, {50.10, 0.2, 3.0}};

Trace at_speed(double speed, std::vector<tests::Ripple> ripple, std::vector<tests::Tone> tones,
               std::uint32_t seed, bool position = true) {
    return tests::make_trace({.rate_hz = 500.0,
                              .seconds = 6.0,
                              .speed_deg_s = [speed](double) { return speed; },
                              .ripple = std::move(ripple),
                              .tones = std::move(tones),
                              .noise_nm = 0.05,
                              .position = position,
                              .seed = seed});
}

std::size_t count_of(const Identification& found, LineKind kind) {
    return static_cast<std::size_t>(std::count_if(found.lines.begin(), found.lines.end(),
                                                  [kind](const Line& line) { return line.kind == kind; }));
}

/// A joint whose ripple has this size, there and back.
Trace there_and_back(double ripple_nm, std::uint32_t seed) {
    return tests::make_trace({.rate_hz = 500.0,
                              .seconds = 8.0,
                              .speed_deg_s = [](double t) { return 80.0 * std::sin(0.8 * t + 0.3); },
                              .ripple = {{100.0, ripple_nm, 0.3}, {200.0, 0.3, 1.1}},
                              .noise_nm = 0.05,
                              .seed = seed});
}

}  // namespace

TEST_CASE("tones that are multiples of one frequency are no orders, at whatever pair of speeds") {
    // Speeds of 3 : 4, 2 : 3, 4 : 5, 1 : 2: two of the tones share an order exactly.
    const double share = GENERATE(4.0 / 3.0, 1.5, 1.25, 2.0);
    const bool position = GENERATE(true, false);
    const Identification found = identify_all(
        {at_speed(36.0, {}, multiples, 1, position), at_speed(36.0 * share, {}, multiples, 2, position)});
    INFO(found.verdict);
    CHECK(count_of(found, LineKind::order) == 0);
    CHECK_FALSE(found.gear_ratio.value.has_value());
    if (share == 1.5) {
        // The tones at 20.04 and 30.06 Hz are as strong as an order 200.4 would be: a tone or an order.
        CHECK(count_of(found, LineKind::tone) + count_of(found, LineKind::unknown) >= 3);
        return;
    }
    CHECK(count_of(found, LineKind::tone) == 4);
    CHECK(found.lines.back().note == "mains 50 Hz");  // the weakest, of 50.1 Hz
}

TEST_CASE("orders stay orders beside such tones, and at speeds that share a divisor") {
    const std::vector<tests::Ripple> ripple{{100.0, 0.8, 0.3}, {200.0, 0.5, 1.1}};
    const bool with_tones = GENERATE(false, true);
    std::vector<Trace> logs;
    // With the tones at speeds where no order meets one of them, without at those that share a divisor.
    for (const double speed : with_tones ? std::vector{37.0, 47.0, 67.0} : std::vector{36.0, 48.0, 72.0})
        logs.push_back(at_speed(speed, ripple, with_tones ? multiples : std::vector<tests::Tone>{},
                                static_cast<std::uint32_t>(speed)));
    const Identification found = identify_all(logs);
    INFO(found.verdict);
    REQUIRE(found.gear_ratio.value.has_value());
    CHECK_THAT(*found.gear_ratio.value, WithinAbs(100.0, 0.3));
    CHECK(found.conclusive);
}

TEST_CASE("two lone lines whose speeds are known badly share no order") {
    // 29.9 Hz at one speed and 40.05 Hz at another: order 297 if both turn, and as likely two tones.
    std::vector<Trace> logs{at_speed(36.0, {}, {{29.9, 0.3, 0.0}}, 1, false),
                            at_speed(47.0, {}, {{40.05, 0.3, 0.0}}, 2, false)};
    for (std::size_t i = 0; i < logs.size(); ++i) {
        auto& v = logs[i].velocity_deg_s;
        for (std::size_t k = 0; k < v.size(); ++k)
            v[k] *= 1.0 + 0.045 * std::sin(0.9 * logs[i].time_s[k] + static_cast<double>(i));
    }
    const Identification found = identify_all(logs);
    INFO(found.verdict);
    CHECK(count_of(found, LineKind::order) == 0);
    CHECK_FALSE(found.gear_ratio.value.has_value());
    if (found.conclusive) CHECK(found.searched.value().detectable_nm > 0.3);
}

TEST_CASE("what is known against a log comes first, and takes ratio, orders and certainty with it") {
    // Catch2 2 keeps a reference to a generated vector that is gone by then.
    const bool in_both = GENERATE(true, false);
    const std::vector<tests::Ripple> ripple{{100.0, 0.8, 0.3}}, none;
    const std::vector<Trace> logs{at_speed(60.0, in_both ? ripple : none, {}, 1),
                                  at_speed(90.0, ripple, {}, 2)};
    IdentifyOptions options;
    options.doubts = {{DoubtReason::clock, "the clock is wrong by 1.475"}};
    const Identification found = identify_all(logs, options);
    CHECK_THAT(found.verdict, StartsWith("Cannot tell: the clock is wrong by 1.475."));
    CHECK_FALSE(found.conclusive);
    CHECK_FALSE(found.gear_ratio.value.has_value());
    CHECK(found.gear_ratio.candidates.empty());
    for (const Line& line : found.lines) {
        CHECK_FALSE(line.order.has_value());
        CHECK_FALSE(line.order_output.has_value());
    }
}

TEST_CASE("recordings between which the ripple grows are told with their values") {
    std::vector<Trace> year;
    const std::vector<double> wear{0.38, 0.45, 0.55, 0.7, 0.85, 0.96};
    for (std::size_t i = 0; i < wear.size(); ++i)
        year.push_back(there_and_back(wear[i], static_cast<std::uint32_t>(10 + i)));
    const Identification found = identify_all(year);
    INFO(found.verdict);
    REQUIRE(found.disagreements.size() == 1);
    const Disagreement& one = found.disagreements.front();
    CHECK(one.about == Disagreement::About::amplitude);
    CHECK(one.order == 1.0);
    REQUIRE(one.values.size() == wear.size());
    for (std::size_t i = 0; i < wear.size(); ++i) CHECK_THAT(one.values[i].value, WithinRel(wear[i], 0.05));
    CHECK_THAT(found.verdict, Contains("The recordings disagree: order 1 from 0.38 to 0.96 Nm"));
    CHECK(found.conclusive);
}

TEST_CASE("recordings of a joint that has not changed agree") {
    int told = 0;
    for (std::uint32_t run = 0; run < 6; ++run) {
        std::vector<Trace> logs;
        for (std::uint32_t i = 0; i < 4; ++i) logs.push_back(there_and_back(0.5, 100 + 10 * run + i));
        told += identify_all(logs).disagreements.empty() ? 0 : 1;
    }
    CHECK(told == 0);
}

TEST_CASE("recordings of two joints of different ratios are no one ratio") {
    std::vector<Trace> logs;
    for (const double ratio : {100.0, 100.6}) {
        for (const double speed : {60.0, 90.0})
            logs.push_back(at_speed(speed, {{ratio, 0.8, 0.0}, {2.0 * ratio, 0.5, 0.0}}, {},
                                    static_cast<std::uint32_t>(speed + ratio)));
    }
    const Identification found = identify_all(logs);
    INFO(found.verdict);
    CHECK_FALSE(found.conclusive);
}
