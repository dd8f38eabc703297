// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/synchronous_average.hpp"

#include "analysis/order_signals.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE("two hundred turns of a noisy sine average to the sine, with the noise down by the root of 200") {
    // 10 Hz for 20 s at 500 Hz: 200 turns of 50 samples; noise 0.1.
    auto signal = tests::shaft(tests::straight(10.0, 10.0, 10000), 500.0);
    for (double& turns : signal.turns) turns = std::round(turns * 50.0) / 50.0;
    tests::add_line(signal, {1.0, 1.0, -0.5 * std::numbers::pi});
    tests::add_noise(signal, 0.1, 21);
    const TurnAverage average = average_turn(signal.turns, signal.torque_nm, 50);
    CHECK_THAT(average.turns, WithinAbs(200.0, 0.03));
    double square = 0.0, stated = 0.0;
    for (std::size_t part = 0; part < 50; ++part) {
        CHECK(average.samples[part] == 200);
        const double truth = std::sin(average.angle_deg[part] / degrees_per_radian);
        square += std::pow(average.torque_nm[part] - truth, 2) / 50.0;
        stated += std::pow(average.standard_error_nm[part], 2) / 50.0;
    }
    // 0.1 / sqrt(200) = 0.00707; the rms of 50 values is known to 10 %: three of that.
    CHECK_THAT(std::sqrt(square), WithinRel(0.00707, 0.3));
    CHECK_THAT(std::sqrt(stated), WithinRel(0.00707, 0.03));
}

TEST_CASE(
    "parts that no sample reaches are nan, negative angles belong to the same turn, one part is refused") {
    const std::vector<double> turns{-0.25, 0.0, 0.75}, torque{1.0, 2.0, 3.0};
    const TurnAverage average = average_turn(turns, torque, 4);
    CHECK_THAT(average.torque_nm[0], WithinAbs(2.0, 0.0));
    CHECK(std::isnan(average.torque_nm[1]));
    CHECK_THAT(average.torque_nm[3], WithinAbs(2.0, 0.0));
    CHECK(average.samples[3] == 2);
    CHECK(std::isnan(average.standard_error_nm[0]));
    CHECK_THROWS_AS(average_turn(turns, torque, 1), UsageError);
}
