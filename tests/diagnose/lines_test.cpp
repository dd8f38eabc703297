// SPDX-License-Identifier: MIT
// Lines of a residual, against time and against the angle.
#include "diagnose/case/lines.hpp"

#include <cmath>
#include <numbers>

#include "bench_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

std::vector<double> noise(std::uint64_t seed) {
    std::vector<double> values(along_tour().size(), 0.0);
    add_white_noise(values, noise_nm, seed, NoiseChannel::torque);
    return values;
}

// Cycles per second, or per degree, of 0.1 Nm.
std::vector<double> with_line(double cycles, const std::vector<double>& where) {
    std::vector<double> values = noise(61);
    for (std::size_t k = 0; k < values.size(); ++k)
        values[k] += 0.1 * std::cos(2.0 * std::numbers::pi * cycles * where[k]);
    return values;
}

std::vector<ResidualLine> told(const std::vector<double>& values) {
    return standing_out(along_tour(), values, limits::regions::line_prominence, 4);
}

}  // namespace

TEST_CASE("noise has no lines") {
    for (std::uint64_t seed = 62; seed < 66; ++seed) CHECK(told(noise(seed)).empty());
}

TEST_CASE("a tone is a line in time, with its frequency and its size") {
    const auto lines = told(with_line(37.0, along_tour().motion.time_s));
    REQUIRE(!lines.empty());
    CHECK(!lines[0].by_angle);
    CHECK(lines[0].frequency == Approx(37.0).margin(0.02));
    CHECK(lines[0].amplitude_nm == Approx(0.1).epsilon(0.15));
    const auto tones = strongest_tones_hz(along_tour(), with_line(37.0, along_tour().motion.time_s));
    REQUIRE(!tones.empty());
    CHECK(tones[0] == Approx(37.0).margin(0.02));
}

TEST_CASE("a tone is heard on both sides of a gap of any length") {
    // A spectrum of the whole would be a comb, and end at 6 Hz and at 3 mHz.
    for (const double gap_s : {60.0, 4e4, 1e8}) {
        Case far = along_tour();
        for (std::size_t k = far.size() / 3; k < far.size(); ++k) far.motion.time_s[k] += gap_s;
        const auto values = with_line(37.0, far.motion.time_s);
        INFO("a gap of " << gap_s << " s");
        const auto lines = standing_out(far, values, limits::regions::line_prominence, 4);
        REQUIRE(!lines.empty());
        CHECK(!lines[0].by_angle);
        CHECK(lines[0].frequency == Approx(37.0).margin(0.02));
        CHECK(lines[0].amplitude_nm == Approx(0.1).epsilon(0.2));
        const auto tones = strongest_tones_hz(far, values);
        REQUIRE(!tones.empty());
        CHECK(tones[0] == Approx(37.0).margin(0.02));
        CHECK(standing_out(far, noise(67), limits::regions::line_prominence, 4).empty());
    }
}

TEST_CASE("a tone of a long log of which pieces are looked at is that of all pieces together") {
    // Eight pieces of a log of a quarter of an hour.
    Case pieces = along_tour();
    const std::size_t each = pieces.size() / 8;
    for (std::size_t k = 0; k < pieces.size(); ++k)
        pieces.motion.time_s[k] += 120.0 * static_cast<double>(k / each);
    const auto values = with_line(37.1234, pieces.motion.time_s);
    const auto tones = strongest_tones_hz(pieces, values);
    REQUIRE(!tones.empty());
    // A fiftieth of a cycle from end to end.
    CHECK(tones[0] == Approx(37.1234).margin(0.02 / 840.0));
}

TEST_CASE("a slow swing is a tone down to 5 Hz") {
    const auto with = [](double hz) {
        return strongest_tones_hz(along_tour(), with_line(hz, along_tour().motion.time_s));
    };
    CHECK(with(8.0).at(0) == Approx(8.0).margin(0.02));
    for (const double hz : with(3.0)) CHECK(hz > 4.9);
}

TEST_CASE("what goes with the angle is an order") {
    const auto lines = told(with_line(400.0 / 360.0, along_tour().motion.position_deg));
    REQUIRE(!lines.empty());
    CHECK(lines[0].by_angle);
    CHECK(lines[0].frequency * 360.0 == Approx(400.0).margin(0.2));
}

TEST_CASE("the ratio that puts the ripple on its lines comes first") {
    Model truth = joint();
    truth.gear_ratio = GearRatio(80.0);
    const Case c = case_of(plain_log(truth, 66));
    const RatioCandidates found = likely_ratios(c, c.torque_nm, {1.0, 2.0}, {40.0, 250.0});
    REQUIRE(found.ratios.size() == limits::screening::most_ratios);
    CHECK(found.ratios[0] == Approx(80.0).margin(0.5));
    CHECK(found.compared > 100.0);
}
