// SPDX-License-Identifier: MIT
// Spectra of whole logs, of pieces, and over speed.
#include <algorithm>

#include "analysis/order_signals.hpp"
#include "analysis/traces.hpp"
#include "ripplenotch/analysis/order_map.hpp"
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

TEST_CASE("lines in many pieces of noise have their place and, without bias, their size") {
    // Half a bin off and on a bin; the noise is a third of the line in a piece.
    const double hz = GENERATE(40.0, 40.3, 40.5);
    double place = 0.0, square = 0.0, size = 0.0;
    constexpr int runs = 100;
    for (int run = 0; run < runs; ++run) {
        const Trace trace = tests::make_trace({.rate_hz = 500.0,
                                               .seconds = 8.0,
                                               .tones = {{hz, 0.1, 0.3 * run}},
                                               .noise_nm = 0.3,
                                               .seed = static_cast<std::uint32_t>(run)});
        const Spectrum spectrum = torque_spectrum(trace.view(), {.segment = Seconds(1.0)});
        REQUIRE_FALSE(spectrum.peaks.empty());
        const SpectralPeak& peak = spectrum.peaks.front();
        place += (peak.hz - hz) / peak.hz_stderr / runs;
        square += std::pow((peak.hz - hz) / peak.hz_stderr, 2) / runs;
        size += peak.amplitude_nm / runs;
    }
    CHECK_THAT(place, WithinAbs(0.0, 0.4));
    CHECK(std::sqrt(square) > 0.5);
    CHECK(std::sqrt(square) < 1.2);
    CHECK_THAT(size, WithinRel(0.1, 0.03));
}

TEST_CASE("a spectrum has the same bits however many samples are handed over at once") {
    Trace trace = tests::make_trace({.seconds = 3.0, .tones = {{40.0, 1.0, 0.0}}, .noise_nm = 0.1});
    trace.time_s[1700] += 4e-4;  // pieces that hold it are uneven
    const SpectrumOptions options{.segment = Seconds(0.333)};
    const Spectrum whole = torque_spectrum(trace.view(), options);
    const std::size_t hop = GENERATE(1U, 7U, 400U);
    SpectrumStream stream(333, trace.sample_rate);
    for (std::size_t k = 0; k < trace.size(); k += hop) {
        const std::size_t count = std::min(hop, trace.size() - k);
        stream.add(std::span(trace.time_s).subspan(k, count), std::span(trace.torque_nm).subspan(k, count));
    }
    const Spectrum found = stream.spectrum(options.false_alarm);
    CHECK(found.psd_nm2_hz == whole.psd_nm2_hz);
    REQUIRE(found.peaks.size() == whole.peaks.size());
    CHECK(found.peaks.front().phase_deg == whole.peaks.front().phase_deg);
}

TEST_CASE(
    "a stack of sweeps has an order at its bin, and the floor of the noise below half the sample rate") {
    auto signal = tests::shaft(tests::straight(0.2, 0.4, 40000), 1000.0);
    tests::add_line(signal, {80.0, 0.5, 0.4});
    tests::add_noise(signal, 0.1, 3);
    const TraceView log = signal.view();
    const std::vector<Sweep> sweeps = cut_sweeps({&log, 1}, {}).pieces;
    const Stack stack = stack_sweeps(sweeps);
    const auto bin = static_cast<std::size_t>(std::lround(80.0 / stack.spacing));
    CHECK(stack.amplitude_nm[bin] == Approx(0.5).epsilon(0.1));  // between bins it is lower
    CHECK(static_cast<double>(stack.averages.size()) * stack.spacing < 1.02 * 500.0 / 0.2);
    double noise = 0.0;
    for (const Sweep& sweep : sweeps)
        noise += 0.1 * std::sqrt(4.0 / sweep.effective_samples()) / static_cast<double>(sweeps.size());
    CHECK(stack.floor_nm[2 * bin] == Approx(noise).epsilon(0.3));
    CHECK(stack_sweeps({}).averages.empty());
}

namespace {

/// Nearest bin of the axis.
double amplitude_at(const SpeedMap& map, std::size_t row, double where) {
    return map.amplitude_nm[row][static_cast<std::size_t>(std::lround(where / map.spacing))];
}

}  // namespace

TEST_CASE("in an order map of a run-up each order stays in its column with its amplitude") {
    const auto signal = tests::run_up();
    const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s,
                                   {.axis = Axis::angle, .resolution = 0.075, .highest = 7.5});
    CHECK_THAT(map.resolution, WithinRel(0.075, 1e-6));
    REQUIRE(map.speed_deg_s.size() > 5);
    CHECK(std::is_sorted(map.speed_deg_s.begin(), map.speed_deg_s.end()));
    for (std::size_t row = 0; row < map.speed_deg_s.size(); ++row) {
        for (std::size_t i = 0; i < 4; ++i) {
            // Orders fall on bins (spacing 0.025); half a percent is leakage between lines 20 cells apart and
            // samples of unequal weight.
            CHECK_THAT(amplitude_at(map, row, tests::run_up_orders[i]),
                       WithinRel(tests::run_up_amplitudes[i], 0.005));
        }
        CHECK(amplitude_at(map, row, 2.5) < 0.01);
    }
}

TEST_CASE("the highest order that a map shows by default is the alias-free one at the highest speed") {
    const auto signal = tests::run_up();
    const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s, {});
    // 300 Hz over 40 turns a second; the fastest window lies a little below that speed.
    CHECK_THAT(map.axis.back(), WithinAbs(7.5, 0.6));
    CHECK(map.axis.back() >= 7.4);
}

TEST_CASE("a Campbell diagram puts an order on a slope and a tone on a level") {
    auto signal = tests::shaft(tests::straight(20.0, 60.0, 40000), 1000.0);
    tests::add_line(signal, {1.0, 0.8, 0.3});
    for (std::size_t k = 0; k < signal.time_s.size(); ++k) {
        signal.torque_nm[k] += 12.0 + 0.5 * std::cos(2.0 * std::numbers::pi * 150.0 * signal.time_s[k]);
    }
    const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s,
                                   {.axis = Axis::time, .resolution = 3.0, .highest = std::nullopt});
    CHECK_THAT(map.resolution, WithinRel(3.0, 0.01));
    for (std::size_t row = 0; row < map.speed_deg_s.size(); ++row) {
        CHECK_THAT(amplitude_at(map, row, 150.0), WithinRel(0.5, 0.01));
        const auto& values = map.amplitude_nm[row];
        const auto limit = values.begin() + static_cast<std::ptrdiff_t>(100.0 / map.spacing);
        const double peak =
            map.spacing * static_cast<double>(std::max_element(values.begin() + 5, limit) - values.begin());
        // A speed's range is two turns a second wide at most, and so is the ridge.
        CHECK_THAT(peak, WithinAbs(map.speed_deg_s[row] / 360.0, map.speed_step_deg_s / 720.0 + map.spacing));
    }
    CHECK_THAT(map.axis.back(), WithinAbs(500.0, map.spacing));
}

TEST_CASE("a log at one speed is a map of one row, without a division by zero") {
    auto signal = tests::shaft(tests::straight(25.0, 25.0, 5000), 1000.0);
    tests::add_line(signal, {1.0, 0.8, 0.3});
    for (const Axis axis : {Axis::angle, Axis::time}) {
        const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s, {.axis = axis});
        REQUIRE(map.speed_deg_s.size() == 1);
        CHECK_THAT(map.speed_deg_s[0], WithinRel(9000.0, 1e-9));
        for (const double value : map.amplitude_nm[0]) CHECK(std::isfinite(value));
        const auto& row = map.amplitude_nm[0];
        const auto highest = std::max_element(row.begin(), row.end());
        const double line = axis == Axis::angle ? 1.0 : 25.0;
        CHECK_THAT(map.axis[static_cast<std::size_t>(highest - row.begin())], WithinAbs(line, map.spacing));
        // A line between two bins of a Hann window is seen by up to 1.4 dB too low.
        CHECK(*highest < 0.81);
        CHECK(*highest > 0.67);
    }
    const auto rest = tests::shaft(tests::straight(0.0, 0.0, 5000), 1000.0);
    CHECK_THROWS_AS(speed_map(rest.view(), rest.turns, rest.speed_deg_s, {}), DataError);
}

TEST_CASE("a resolution that no run can give is not pretended") {
    const auto signal = tests::run_up();  // 125 turns
    const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s,
                                   {.axis = Axis::angle, .resolution = 0.001, .highest = 7.5});
    CHECK_THAT(map.resolution, WithinRel(1.5 / 125.0, 1e-6));
    CHECK(map.speed_deg_s.size() == 1);
}
