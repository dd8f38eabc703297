// SPDX-License-Identifier: MIT
// Which method is taken, on logs whose ripple is known.

#include <cmath>
#include <numbers>
#include <random>

#include "evaluate/contenders.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

const GearAccount gear{GearRatio(100.0), {Order(1.0), Order(2.0)}, {}, {}, "test"};

// 90 deg/s at 1 kHz, ripple of 0.8 Nm (order 1) times `ripple`, a ramp, and white noise.
Trace log_of(double ripple, double ramp_nm_s, double seconds = 12.0) {
    std::mt19937 engine(5);
    std::normal_distribution<double> noise(0.0, 0.05);
    Trace trace;
    trace.sample_rate = Hertz(1000.0);
    for (std::size_t k = 0; static_cast<double>(k) < 1000.0 * seconds; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double theta = 2.0 * std::numbers::pi * 100.0 * 90.0 * t / 360.0;
        trace.time_s.push_back(t);
        trace.velocity_deg_s.push_back(90.0);
        trace.position_deg.push_back(90.0 * t);
        trace.torque_nm.push_back(ramp_nm_s * t + ripple * 0.8 * std::cos(theta) + noise(engine));
    }
    return trace;
}

std::vector<Contender> tried() {
    std::vector<Contender> all;
    for (const char* text : {"none", "lowpass,cutoff=3Hz,order=1", "lowpass,cutoff=10Hz,order=1",
                             "tracking,gear-ratio=100,orders=1:2", "tracking,gear-ratio=100,orders=1:2,q=4",
                             "oscillator,gear-ratio=100,orders=1:2"})
        all.push_back(make_contender(parse_spec(text)));
    return all;
}

std::vector<RippleEstimate> ripple_of(const Trace& trace) {
    const TraceView view = trace.view();
    return estimate_ripple({&view, 1}, gear.ratio, gear.orders);
}

Recommendation recommended(const Trace& trace, const RecommendationLimits& limits = {}) {
    return recommend(tried(), {trace.view()}, gear, limits, ripple_of(trace));
}

}  // namespace

TEST_CASE("the rate of a torque is that of its ramp, whatever ripple is on it") {
    CHECK(torque_rate_nm_s(log_of(1.0, 20.0).view(), gear.ratio) == Approx(20.0).epsilon(0.02));
    CHECK(torque_rate_nm_s(log_of(0.0, 20.0).view(), gear.ratio) == Approx(20.0).epsilon(0.02));
    CHECK(torque_rate_nm_s(TraceView{}, gear.ratio) == 0.0);
}

TEST_CASE("without a ripple that is present nothing is recommended, and a short log is not judged") {
    const Recommendation nothing = recommended(log_of(0.0, 0.0));
    CHECK(nothing.finding == RecommendationFinding::no_ripple);
    CHECK_THAT(recommendation_verdict(nothing), Catch::Contains("order 1: no ripple above 0.00"));
    CHECK_THAT(recommendation_verdict(nothing), Catch::Contains("at 90 to 90 deg/s"));
    CHECK(recommended(log_of(1.0, 0.0, 0.5)).finding == RecommendationFinding::cannot_tell);
}

TEST_CASE("what is off is the ripple left and the way of the torque within the delay") {
    const Trace trace = log_of(1.0, 20.0);
    const Recommendation found = recommended(trace);
    REQUIRE(found.finding == RecommendationFinding::recommended);
    for (const JudgedMethod& method : found.methods) {
        const double lag = 1e-3 * *method.figures.dc_delay_ms * found.torque_rate_nm_s;
        CHECK(method.error_nm == Approx(std::hypot(*method.figures.ripple_rms_nm, lag)));
    }
    // A low-pass of 3 Hz is 53 ms late, which is more than a Nm of this ramp.
    CHECK(found.taken()->figures.method.substr(0, 10) == "oscillator");
    CHECK(found.methods.back().figures.method == "lowpass,cutoff=3Hz,order=1");
}

TEST_CASE("the longest delay of a table is that of the slowest band that the log comes into") {
    Trace trace = log_of(1.0, 5.0);
    for (std::size_t k = 0; k < 2000; ++k) trace.velocity_deg_s[k] = 60.0;
    const auto table = testing::paper_table();
    const std::vector<Contender> switching = {testing::contender("switching,table=paper.json", table)};
    const Recommendation found = recommend(switching, {trace.view()}, gear, {}, ripple_of(trace));
    REQUIRE(found.methods.size() == 1);
    CHECK(found.methods[0].delay == table->bands()[2].dc_delay);
    CHECK(found.methods[0].delay_at == DegPerSec(63.0));
}

TEST_CASE("looser limits give the same or a better answer, and every answer is within its limits") {
    const Trace trace = log_of(1.0, 5.0);
    for (const double db : {0.0, 10.0, 20.0, 30.0, 90.0}) {
        double before = 1e9;
        for (const double ms : {0.0, 2.0, 6.0, 20.0, 80.0}) {
            RecommendationLimits limits{Seconds(1e-3 * ms), db};
            const Recommendation found = recommended(trace, limits);
            const JudgedMethod& first = *found.taken();
            if (!first.meets()) {
                CHECK(found.finding == RecommendationFinding::out_of_reach);
                CHECK_THAT(recommendation_verdict(found), Catch::Contains("Nothing is within the limits"));
                CHECK(before == 1e9);
                continue;
            }
            CHECK(1e3 * first.delay.value() <= ms);
            CHECK(*first.weakest->db >= db);
            CHECK(first.error_nm <= before);
            before = first.error_nm;
        }
        CHECK((before < 1e9) == (db < 90.0));
    }
}
