// SPDX-License-Identifier: MIT
// A curve of friction that the catalogue does not have is not named after the nearest that it has.
#include <algorithm>
#include <cmath>

#include "diagnose_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

Diagnosis diagnosed_with_power(double power) {
    Trace log = logged(joint(), coarse_tour(), 61);
    const auto& velocity_deg_s = coarse_tour().velocity_deg_s;
    for (std::size_t k = 0; k < log.size(); ++k)
        log.torque_nm[k] +=
            std::copysign(0.6 * std::pow(std::abs(velocity_deg_s[k]) / 130.0, power), velocity_deg_s[k]);
    return diagnose(opened(joint()), log.view(), nullptr);
}

bool names_a_curve(const Diagnosis& found) {
    return std::any_of(found.named.begin(), found.named.end(), [](const std::string& name) {
        return name == "viscous-friction" || name == "quadratic-viscous-friction";
    });
}

}  // namespace

TEST_CASE("friction that grows with another power of the speed is none of the two that are listed") {
    for (const double power : {2.5, 3.0}) {
        const Diagnosis found = diagnosed_with_power(power);
        CAPTURE(power);
        CHECK_FALSE(names_a_curve(found));
        CHECK(found.verdict != DiagnosisVerdict::explained);
    }
    CHECK(names_a_curve(diagnosed_with_power(2.0)));
}
