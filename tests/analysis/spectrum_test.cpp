// SPDX-License-Identifier: MIT
#include <algorithm>

#include "analysis/traces.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE("a sine between bins is found with its frequency, amplitude and phase") {
    const double hz = GENERATE(20.0, 20.03, 20.07, 20.1, 133.3337);
    const Trace trace = tests::make_trace({.seconds = 5.0, .tones = {{hz, 0.8, 0.6}}, .noise_nm = 0.01});
    const Spectrum spectrum = torque_spectrum(trace.view(), {});
    REQUIRE(spectrum.peaks.size() == 1);
    const SpectralPeak& peak = spectrum.peaks.front();
    CHECK_THAT(peak.hz, WithinAbs(hz, 1e-3 * spectrum.bin_width.value()));
    CHECK_THAT(peak.hz, WithinAbs(hz, 5.0 * peak.hz_stderr));
    CHECK_THAT(peak.amplitude_nm, WithinRel(0.8, 2e-3));
    CHECK_THAT(peak.phase_deg, WithinAbs(0.6 * degrees_per_radian, 0.5));
}

TEST_CASE("the area under the density is the variance of the torque") {
    const auto segment = GENERATE(std::optional<Seconds>{}, std::optional<Seconds>{Seconds(1.0)});
    const Trace trace = tests::make_trace({.seconds = 20.0, .noise_nm = 0.3, .seed = 9});
    const Spectrum spectrum = torque_spectrum(trace.view(), {.segment = segment});
    double area = 0.0;
    for (const double density : spectrum.psd_nm2_hz) area += density * spectrum.bin_width.value();
    CHECK_THAT(area, WithinRel(0.09, 0.06));
    // The floor as amplitude: sqrt(2 S * 1.5 bins) with S = 2 sigma^2 / rate.
    const double expected = std::sqrt(2.0 * (2.0 * 0.09 / 1000.0) * 1.5 * spectrum.bin_width.value());
    double mean = 0.0;
    for (const double floor : spectrum.floor_nm)
        mean += floor / static_cast<double>(spectrum.floor_nm.size());
    CHECK_THAT(mean, WithinRel(expected, 0.06));
}

TEST_CASE("the standard error of a frequency is the scatter it claims") {
    double square = 0.0, claimed = 0.0;
    constexpr int runs = 200;
    for (int run = 0; run < runs; ++run) {
        const Trace trace = tests::make_trace({.rate_hz = 200.0,
                                               .seconds = 4.0,
                                               .tones = {{31.37, 0.3, 0.1 * run}},
                                               .noise_nm = 0.3,
                                               .seed = static_cast<std::uint32_t>(100 + run)});
        const Spectrum spectrum = torque_spectrum(trace.view(), {});
        REQUIRE_FALSE(spectrum.peaks.empty());
        square += std::pow(spectrum.peaks.front().hz - 31.37, 2) / runs;
        claimed += std::pow(spectrum.peaks.front().hz_stderr, 2) / runs;
    }
    CHECK_THAT(std::sqrt(square), WithinRel(std::sqrt(claimed), 0.2));
}

TEST_CASE("a jittered clock neither moves a line nor makes one") {
    const Trace trace = tests::make_trace({.rate_hz = 250.0,
                                           .seconds = 8.0,
                                           .tones = {{40.0, 1.0, 0.0}},
                                           .noise_nm = 0.02,
                                           .jitter_steps = 0.2});
    const Spectrum spectrum = torque_spectrum(trace.view(), {});
    REQUIRE(spectrum.peaks.size() == 1);
    CHECK_THAT(spectrum.peaks[0].hz, WithinAbs(40.0, 1e-3));
    CHECK_THAT(spectrum.peaks[0].amplitude_nm, WithinRel(1.0, 0.01));
}

TEST_CASE("the side lobes of a strong line are no lines, a weak line beside it is") {
    const Trace trace = tests::make_trace(
        {.seconds = 4.0, .tones = {{50.1, 10.0, 0.0}, {60.0, 0.05, 1.0}}, .noise_nm = 0.001});
    const Spectrum spectrum = torque_spectrum(trace.view(), {});
    REQUIRE(spectrum.peaks.size() == 2);
    CHECK_THAT(spectrum.peaks[1].hz, WithinAbs(60.0, 0.02));
}

TEST_CASE("noise shows a line in at most one log of a hundred") {
    constexpr int runs = 600;
    int alarms = 0;
    for (int run = 0; run < runs; ++run) {
        const double colour = run % 3 == 0   ? 0.0
                              : run % 3 == 1 ? 0.9
                                             : 0.99;  // white, and two first-order colours
        Trace trace = tests::make_trace({.rate_hz = 500.0,
                                         .seconds = 2.0,
                                         .noise_nm = 1.0,
                                         .seed = static_cast<std::uint32_t>(1000 + run)});
        for (std::size_t k = 1; k < trace.size(); ++k)
            trace.torque_nm[k] += colour * (trace.torque_nm[k - 1] - 10.0);
        alarms += torque_spectrum(trace.view(), {}).peaks.empty() ? 0 : 1;
    }
    // Expected at most 6; 12 is four standard deviations of a binomial above 4.
    INFO(alarms << " of " << runs);
    CHECK(alarms <= 12);
}

TEST_CASE("too few samples are refused with the number needed") {
    const Trace trace = tests::make_trace({.seconds = 0.05});
    CHECK_THROWS_WITH(torque_spectrum(trace.view(), {}),
                      Catch::Contains("at least 64 samples, there are 50"));
}
