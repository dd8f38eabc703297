// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/ledger.hpp"

#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("a twentieth left is 26 dB off, and what a filter should leave is its response's share") {
    const OrderLevel level{1.0, 25.0, {0.8, 0.04}, 0.07};
    CHECK(attenuation_db(level).value() == Approx(20.0 * std::log10(20.0)));
    CHECK_FALSE(attenuation_db({1.0, 25.0, {0.0, 0.0}, {}}).has_value());
    FilterMetrics metrics;
    CHECK_FALSE(predicted_nm(metrics, 0).has_value());
    metrics.gear = GearAccount{GearRatio(100.0), {Order(1.0)}, {}, {}, "test"};
    metrics.levels = RippleLevels{};
    metrics.levels->orders = {level};
    metrics.levels->windows = 3;
    // Of what the log shows, unless table or joint say what the ripple is.
    CHECK(predicted_nm(metrics, 0).value() == Approx(0.8 * 0.07));
    metrics.gear->amplitude_nm = {1.2};
    CHECK(predicted_nm(metrics, 0).value() == Approx(1.2 * 0.07));
}
