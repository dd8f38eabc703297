// SPDX-License-Identifier: MIT
// What no effect explains is reported with its place and under no name.
#include <cmath>
#include <numbers>

#include "diagnose_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

bool holds(const std::vector<Span>& spans, double at) {
    for (const Span& span : spans) {
        if (span.from - 0.1 <= at && at <= span.to + 0.1) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("something touched for a third of a second is unexplained, at its time, and names nothing") {
    Trace log = logged(joint(), tour(), 4);
    for (std::size_t k = 0; k < log.size(); ++k) {
        const double share = (log.time_s[k] - 6.9) / 0.33;
        if (share > 0.0 && share < 1.0) log.torque_nm[k] += 1.2 * std::sin(std::numbers::pi * share);
    }
    const Diagnosis found = diagnose(opened(joint()), log.view(), nullptr);
    CHECK(found.named.empty());
    CHECK(found.verdict == DiagnosisVerdict::unexplained);
    REQUIRE(!found.unexplained.empty());
    CHECK(found.unexplained[0].kind == RegionKind::time);
    CHECK(holds(found.unexplained[0].where.time_s, 7.06));
    const ResidualRegion& touch = found.unexplained[0];
    CHECK(touch.rms_nm > 0.5);
    // What was added there, beside the noise; and what part that is of the squares of all that is left.
    const Span& when = touch.where.time_s.at(0);
    double square = 0.0, rows = 0.0;
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (log.time_s[k] < when.from - 1e-9 || log.time_s[k] > when.to + 1e-9) continue;
        const double share = std::clamp((log.time_s[k] - 6.9) / 0.33, 0.0, 1.0);
        square += std::pow(1.2 * std::sin(std::numbers::pi * share), 2);
        rows += 1.0;
    }
    CHECK(touch.rms_nm == Approx(std::sqrt(square / rows)).epsilon(0.05));
    // The corners of the ramps, which do not count here, are in the gap.
    const double all = std::pow(found.gap.after_nm, 2) * static_cast<double>(log.size());
    CHECK(touch.part == Approx(std::pow(touch.rms_nm, 2) * rows / all).epsilon(0.08));
}

TEST_CASE("with its entry taken out of the catalogue, an effect is unexplained at the right place") {
    Model truth = joint();
    truth.terms.push_back(parse_term("tone,frequency_hz=37,amplitude_nm=0.2,phase_deg=20"));
    const Trace log = logged(truth, tour(), 5);
    const std::vector<std::string> tone = {"tone"};
    const Diagnosis without = diagnose(opened(joint()), log.view(), nullptr, {.without = tone});
    CHECK(without.named.empty());
    CHECK(without.verdict == DiagnosisVerdict::unexplained);
    REQUIRE(!without.unexplained.empty());
    REQUIRE(without.unexplained[0].where.hz.size() == 1);
    CHECK(without.unexplained[0].where.hz[0] == Approx(37.0).margin(0.05));
    CHECK(without.unexplained[0].rms_nm == Approx(0.2 / std::numbers::sqrt2).epsilon(0.05));
    const Diagnosis with = diagnose(opened(joint()), log.view(), nullptr);
    CHECK(with.named == std::vector<std::string>{"tone"});
    CHECK(with.unexplained.empty());
}
