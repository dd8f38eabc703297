// SPDX-License-Identifier: MIT
// Maps of several motors in one torque.

#include "filter/mapped.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

/// Another joint, which swings at a frequency of its own.
Trace motion_of(unsigned seed) { return mapped_log(plain_map(), 20.0, 0.0, seed, 0.0, 1.13); }

/// A joint with its own ripple and, where `share` is not 0, that of the motor of another one.
Trace torque_with(const Trace& other, unsigned seed, double share) {
    Trace log = mapped_log(plain_map(), 20.0, 0.05, seed);
    const std::vector<double> ripple = map_along(two_comb_map(), other.view());
    for (std::size_t k = 0; k < log.size(); ++k) log.torque_nm[k] += share * ripple[k];
    return log;
}

MapFit fit_of(const Trace& log, const Trace& other, std::size_t pairs = 2, bool own = true) {
    const TraceView view = log.view();
    const GearAccount gear = mapped_gear();
    const OtherMotor motor{"other", mapped_gear(), {other.view()}};
    return fit_joint_map({&view, 1}, own ? &gear : nullptr, {&motor, 1}, pairs);
}

double rms(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<double> less(std::vector<double> values, const std::vector<double>& others) {
    for (std::size_t k = 0; k < values.size(); ++k) values[k] -= others[k];
    return values;
}

}  // namespace

TEST_CASE("the ripple of two motors in one torque is told apart by their angles") {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        const Trace other = motion_of(100 + seed), log = torque_with(other, seed, 0.5);
        for (const bool own : {true, false}) {
            const MapFit fit = fit_of(log, other, 2, own);
            INFO(seed << ", own gear known: " << own << ": " << map_verdict(fit));
            REQUIRE(fit.others.size() == 1);
            REQUIRE(fit.others[0].finding == MapFinding::mapped);
            CHECK(fit.others[0].doubt.empty());
            REQUIRE(fit.map.others.size() == 1);
            CHECK(fit.map.others[0].joint == "other");
            if (own)
                CHECK(rms(less(map_along(fit.map, log.view()), map_along(plain_map(), log.view()))) < 0.05);
            std::vector<double> truth = map_along(two_comb_map(), other.view());
            for (double& nm : truth) nm *= 0.5;
            const std::vector<double> left = less(map_along(fit.map.others[0], other.view()), truth);
            CHECK(rms(left) < (own ? 0.05 : 0.3) * rms(truth) + 0.02);
        }
    }
}

TEST_CASE("another motor whose ripple is not in the torque is not claimed, and a bound is stated") {
    std::size_t claimed = 0, bounds = 0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Trace other = motion_of(200 + seed), log = torque_with(other, seed, 0.0);
        const MapFit fit = fit_of(log, other);
        claimed += fit.others[0].finding == MapFinding::mapped ? 1 : 0;
        for (const MapOrderScore& score : fit.others[0].scores)
            bounds += !score.in_map && score.detectable_nm < 0.2 ? 1 : 0;
        CHECK(fit.map.others.empty());
        CHECK(fit.finding == MapFinding::mapped);
    }
    CHECK(claimed == 0);
    CHECK(bounds >= 36);
}

TEST_CASE("two joints that move alike cannot be told apart, and nothing is subtracted") {
    const Trace log = torque_with(motion_of(1), 1, 0.0), same = mapped_log(plain_map(), 20.0, 0.0, 1);
    const MapFit own_known = fit_of(log, same);
    CHECK(own_known.map.others.empty());
    // Ripple of its own motor, whose gear is not known, is not that of a joint that moves alike.
    const MapFit own_unknown = fit_of(log, same, 2, false);
    CHECK(own_unknown.others[0].finding == MapFinding::mapped);
    CHECK_THAT(own_unknown.others[0].doubt, Catch::Contains("whose gear ratio is not known"));
    CHECK(own_unknown.map.others.empty());
    // Without a gear of its own, both of two other joints could have made it.
    const TraceView view = log.view();
    const std::vector<OtherMotor> two = {{"a", mapped_gear(), {same.view()}},
                                         {"b", mapped_gear(), {same.view()}}};
    const MapFit fit = fit_joint_map({&view, 1}, nullptr, two, 2);
    REQUIRE(fit.others.size() == 2);
    REQUIRE(fit.others[0].finding == MapFinding::mapped);
    CHECK_THAT(fit.others[0].doubt, Catch::Contains("Cannot tell the ripple of the motor of a from that of"));
    CHECK(fit.map.others.empty());
}

TEST_CASE("a map with other motors is the same after JSON, and is subtracted from any log of these joints") {
    const Trace other = motion_of(101), log = torque_with(other, 1, 0.5);
    const MapFit fit = fit_of(log, other);
    const MapFit read = map_from_json(map_text(fit, {}), "test");
    REQUIRE(read.others.size() == 1);
    REQUIRE(read.map.others.size() == 1);
    CHECK(read.map.others[0].joint == "other");
    CHECK(read.others[0].finding == MapFinding::mapped);
    const Trace next = motion_of(301), after = torque_with(next, 9, 0.5), clean = torque_with(next, 9, 0.0);
    const TraceView view = after.view();
    const OtherMotor motor{"other", mapped_gear(), {next.view()}};
    std::vector<double> left = without_other_motors({&view, 1}, read.map, {&motor, 1}).front();
    for (std::size_t k = 0; k < left.size(); ++k) left[k] -= clean.torque_nm[k];
    CHECK(rms(left) < 0.1 * 0.5 * rms(map_along(two_comb_map(), next.view())) + 0.02);
}

TEST_CASE("the rows of another joint have to be those of the torque") {
    const Trace log = torque_with(motion_of(1), 1, 0.0);
    const Trace shorter = mapped_log(plain_map(), 10.0, 0.0, 2);
    CHECK_THROWS_AS(fit_of(log, shorter), DataError);
}
