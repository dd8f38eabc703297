// SPDX-License-Identifier: MIT
// A map subtracted, and as the mean of the oscillator.

#include "filter/mapped.hpp"
#include "filter/tables.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

std::string with_map(const std::string& method, const RippleMap& map) {
    std::string text = method;
    for (const auto& [key, value] : map_as_keys(map)) text += "," + key + "=" + value;
    return text;
}

Samples samples_of(const Trace& trace) { return {trace.velocity_deg_s, trace.torque_nm, trace.position_deg}; }

std::vector<double> slow_part(const Trace& trace) {
    std::vector<double> torque;
    for (const double t : trace.time_s) torque.push_back(6.0 * std::sin(0.5 * t));
    return torque;
}

double rms_from(const std::vector<double>& a, const std::vector<double>& b, std::size_t first) {
    double sum = 0.0;
    for (std::size_t k = first; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(sum / static_cast<double>(a.size() - first));
}

}  // namespace

TEST_CASE("the method map subtracts the closed form at the measured angle, at once") {
    for (RippleMap map : {plain_map(), with_zero(rich_map(), 12.5)}) {
        const Trace log = mapped_log(map, 6.0, 0.0, 3);
        const auto out = filtered(*start(with_map("map", map)), samples_of(log));
        const auto expected = slow_part(log);
        double worst = 0.0;
        for (std::size_t k = 0; k < out.size(); ++k) worst = std::max(worst, std::abs(out[k] - expected[k]));
        CHECK(worst < 1e-9);
    }
}

TEST_CASE("a map with a value too few is refused with the number that it takes") {
    CHECK_THROWS_WITH(start("map,gear-ratio=100,orders=1:2,cosines=0.1:0.2:0.3,sines=0:0"),
                      Catch::Contains("3 values, and 2 orders of 1 take 2"));
}

TEST_CASE("without a position and a start the map passes the torque") {
    const Trace log = mapped_log(plain_map(), 1.0, 0.01, 3);
    Samples blind = samples_of(log);
    blind.position_deg = {};
    CHECK(filtered(*start(with_map("map", plain_map())), blind) == log.torque_nm);
}

TEST_CASE("an oscillator with a map starts right, and follows what the map does not know") {
    const RippleMap map = rich_map();
    const Trace log = mapped_log(map, 6.0, 0.05, 9);
    const auto truth = slow_part(log);
    const auto warm = filtered(*start(with_map("oscillator,slip=0", map)), samples_of(log));
    CHECK(rms_from(warm, truth, 0) < 0.03);
    const auto cold = filtered(*start("oscillator,gear-ratio=100,orders=2,slip=0"), samples_of(log));
    CHECK(rms_from(warm, truth, 0) < rms_from(cold, truth, 0));
    // The joint's ripple has grown by half since the map was made.
    RippleMap grown = map;
    for (auto& value : grown.values[0]) value *= 1.5;
    const Trace later = mapped_log(grown, 6.0, 0.05, 9);
    const auto followed = filtered(*start(with_map("oscillator", map)), samples_of(later));
    const auto subtracted = filtered(*start(with_map("map", map)), samples_of(later));
    CHECK(rms_from(followed, truth, 1000) < 0.6 * rms_from(subtracted, truth, 1000));
}

TEST_CASE("after an encoder swap the map's zero is found within one motor turn") {
    const RippleMap map = plain_map();
    for (const double shift_deg : {0.3, 1.1, 2.9, -1.7}) {
        const Trace log = mapped_log(map, 3.0, 0.05, 9, shift_deg);
        const auto truth = slow_part(log);
        double turned = 0.0;
        std::size_t first = 0;
        while (turned < 1.0) turned += mapped_ratio * std::abs(log.velocity_deg_s[first++]) / 360000.0;
        const auto found = filtered(*start(with_map("oscillator,zero=unknown", map)), samples_of(log));
        const auto wrong = filtered(*start(with_map("oscillator", map)), samples_of(log));
        CHECK(rms_from(found, truth, first) < 0.05);
        CHECK(rms_from(found, truth, first) < rms_from(wrong, truth, first));
    }
}
