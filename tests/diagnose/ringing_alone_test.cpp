// SPDX-License-Identifier: MIT
// A joint by itself whose ripple drives a mass on a spring.

#include <cmath>
#include <numbers>

#include "diagnose_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

// y'' + 2 damping w y' + w^2 y = w^2 x by the trapezoidal rule, settled at the start.
std::vector<double> on_spring(const std::vector<double>& x, double rate_hz, double hertz, double damping) {
    const double c = rate_hz / (std::numbers::pi * hertz);
    const double a0 = c * c + 2.0 * damping * c + 1.0, a1 = 2.0 - 2.0 * c * c,
                 a2 = c * c - 2.0 * damping * c + 1.0;
    std::vector<double> y(x.size(), x[0]);
    for (std::size_t k = 1; k < x.size(); ++k) {
        const std::size_t before = k > 1 ? k - 2 : 0;
        y[k] = (x[k] + 2.0 * x[k - 1] + x[before] - a1 * y[k - 1] - a2 * y[before]) / a0;
    }
    return y;
}

// The joint's ripple made so at 8 kHz, and logged at 500 Hz.
Trace ringing_log(double hertz, double damping, std::uint64_t seed) {
    constexpr std::size_t finer = 16;
    const Motion fine = tour_at(Hertz(500.0 * finer));
    Model ripple = joint();
    std::erase_if(ripple.terms, [](const Term& term) { return !term.effect->ripple_order; });
    const std::vector<double> drive = predict_nm(ripple, fine);
    const std::vector<double> rung = on_spring(drive, 500.0 * finer, hertz, damping);
    Trace log = logged(joint(), tour(), seed);
    for (std::size_t k = 0; k < log.torque_nm.size() && finer * k < drive.size(); ++k)
        log.torque_nm[k] += rung[finer * k] - drive[finer * k];
    return log;
}

}  // namespace

TEST_CASE("ripple that drives a mass on a spring is explained whole, ramps through the mode included",
          "[!shouldfail]") {
    const Diagnosis found = diagnose(opened(joint()), ringing_log(36.0, 0.04, 51).view(), nullptr);
    CHECK(found.named == std::vector<std::string>{"resonance"});
    CHECK(found.verdict == DiagnosisVerdict::explained);
    // What kinks of the motion leave of a joint that does not ring is left here too, and nothing else.
    const Diagnosis plain = diagnose(opened(joint()), logged(joint(), tour(), 51).view(), nullptr);
    CHECK(found.gap.before_nm > 10.0 * plain.gap.after_nm);
    CHECK(found.gap.after_nm < 1.01 * plain.gap.after_nm);
}
