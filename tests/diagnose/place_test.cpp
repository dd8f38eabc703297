// SPDX-License-Identifier: MIT
// Where in a log a torque acts.
#include "diagnose/case/case.hpp"

#include "bench_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

template <class Function>
Place placed(const Case& c, const Function& torque_at, std::string_view term = "offset,torque_nm=1") {
    std::vector<double> torque_nm;
    for (std::size_t k = 0; k < c.size(); ++k) torque_nm.push_back(torque_at(k));
    return place_of(c, torque_nm, parse_term(term));
}

}  // namespace

TEST_CASE("what acts everywhere acts nowhere in particular, at rest too") {
    const Place place = placed(along_tour(), [](std::size_t) { return 0.3; });
    CHECK(place.direction == Direction::at_rest_too);
    CHECK(place.time_s.empty());
    CHECK(place.speed_deg_s.empty());
    CHECK(place.position_deg.empty());
}

TEST_CASE("what acts in one direction, or in both, is told so") {
    const auto& speed = along_tour().motion.velocity_deg_s;
    CHECK(placed(along_tour(), [&](std::size_t k) { return speed[k] > 0.0 ? 1.0 : 0.0; }).direction ==
          Direction::positive);
    CHECK(placed(along_tour(), [&](std::size_t k) { return speed[k] < 0.0 ? 1.0 : 0.0; }).direction ==
          Direction::negative);
    CHECK(placed(along_tour(), [&](std::size_t k) { return speed[k] != 0.0 ? 1.0 : 0.0; }).direction ==
          Direction::both);
}

TEST_CASE("what acts for two seconds or at some positions is told with these") {
    const Motion& motion = along_tour().motion;
    const Place in_time =
        placed(along_tour(), [&](std::size_t k) { return motion.time_s[k] > 4.0 && motion.time_s[k] < 6.0; });
    REQUIRE(in_time.time_s.size() == 1);
    CHECK(in_time.time_s[0].from == Approx(4.0).margin(0.9));
    CHECK(in_time.time_s[0].to == Approx(6.0).margin(0.9));
    const Place at = placed(along_tour(), [&](std::size_t k) { return motion.position_deg[k] > 110.0; });
    REQUIRE(at.position_deg.size() == 1);
    CHECK(at.position_deg[0].from == Approx(110.0).margin(11.0));
}

TEST_CASE("a ripple is told with its order and a tone with its frequency") {
    const auto nothing = [](std::size_t) { return 0.0; };
    CHECK(placed(along_tour(), nothing, "ripple,order=4,amplitude_nm=0.3,phase_deg=0").order ==
          std::vector<double>{4.0});
    CHECK(placed(along_tour(), nothing, "tone,frequency_hz=30,amplitude_nm=0.3,phase_deg=0").hz ==
          std::vector<double>{30.0});
}
