// SPDX-License-Identifier: MIT
// A real effect has one size wherever it acts; a stand-in has several.
#include "diagnose/judging/doubt.hpp"

#include "bench_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {}  // namespace

TEST_CASE("an effect that is there has the same size early and late, slow and fast, forth and back") {
    const TestBench on(case_of(plain_log(joint_with({viscous}), 51)));
    CHECK(unevenness(on.bench, joint_with({viscous}), 3).part < 0.1);
}

TEST_CASE("a stand-in has another size slow than fast, however well it is fitted") {
    const TestBench on(case_of(plain_log(joint_with({viscous}), 51)));
    const Candidate stand_in =
        on.fitted(joint_with({"quadratic-viscous-friction,coefficient_nm_per_deg2_s2=0.00005"}));
    const Unevenness uneven = unevenness(on.bench, stand_in.stated, 3);
    CHECK(uneven.part > limits::evenness::most_uneven);
    CHECK(!uneven.where.empty());
}

TEST_CASE("a drift that is half over is uneven early and late when it is taken for an offset") {
    Trace log = plain_log(joint(), 52);
    for (std::size_t k = 0; k < log.size(); ++k) log.torque_nm[k] += k < log.size() / 2 ? 0.1 : 0.5;
    const TestBench on(case_of(log));
    const Candidate offset = on.fitted(joint_with({"offset,torque_nm=0.3"}));
    const Unevenness uneven = unevenness(on.bench, offset.stated, 3);
    CHECK(uneven.part > 0.4);
    CHECK(uneven.where == "early and late in the log");
}

TEST_CASE("a torque that changes only where samples do not count may be any constant") {
    const Model truth = joint_with({"coulomb-friction,torque_nm=0.5,width_deg_s=0.2"});
    Case one_way = case_of(plain_log(truth, 53));
    for (std::size_t k = 0; k < one_way.size(); ++k) {
        if (one_way.motion.velocity_deg_s[k] < 5.0) one_way.use[k] = 0;
    }
    const TestBench on(std::move(one_way));
    CHECK(unevenness(on.bench, truth, 3).part == 1.0);
}
