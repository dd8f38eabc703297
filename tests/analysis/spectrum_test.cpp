// SPDX-License-Identifier: MIT
// Spectra of whole logs, of pieces, and over speed.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include "analysis/kernels/spreading_kernel.hpp"
#include "analysis/order_signals.hpp"
#include "analysis/spectrum/running_median.hpp"
#include "analysis/traces.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;
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

// The test of a spectral line against its noise, and the running median behind it.

TEST_CASE("the median of one exponential lies at ln 2 of its mean, that of many nearly at the mean") {
    CHECK_THAT(median_over_mean(1.0), WithinRel(std::log(2.0), 2e-3));
    CHECK_THAT(median_over_mean(100.0), WithinRel(1.0 - 1.0 / 300.0, 1e-4));
}

TEST_CASE("with a floor known exactly, one average exceeds r times it with chance exp(-r)") {
    for (const double ratio : {1.0, 5.0, 12.0})
        CHECK_THAT(exceedance({.ratio = ratio, .averages = 1.0, .cells = 1e7}),
                   WithinRel(std::exp(-ratio), 1e-3));
    // Two averages: (1 + 2 r) exp(-2 r).
    CHECK_THAT(exceedance({.ratio = 4.0, .averages = 2.0, .cells = 1e7}),
               WithinRel(9.0 * std::exp(-8.0), 1e-3));
}

TEST_CASE("a floor known from few cells makes high ratios likelier, by (1 + r/k)^-k") {
    const double k = 20.0;
    CHECK_THAT(exceedance({.ratio = 10.0, .averages = 1.0, .cells = 20.0}),
               WithinRel(std::pow(1.0 + 10.0 / k, -k), 1e-9));
}

TEST_CASE("the noise floor is the mean power of the noise and is not raised by a line") {
    tests::Noise noise(11);
    std::vector<double> power(4000);
    double mean = 0.0;
    for (double& p : power) {
        const double a = noise(), b = noise();
        p = 0.5 * (a * a + b * b) * 3.0;
        mean += p / 4000.0;
    }
    power[2000] = 1e6;
    const auto floor = noise_floor({power, 1.0, 1.0, 0});
    double average = 0.0;
    for (const double f : floor) average += f / 4000.0;
    CHECK_THAT(average, WithinRel(mean, 0.05));
    CHECK(floor[2000] < 2.0 * mean);
    const auto peaks = significant_peaks({power, 1.0, 1.0, 0}, floor, 0.01);
    REQUIRE(peaks.size() == 1);
    CHECK(peaks[0].bin == 2000);
}

TEST_CASE("a broad hump is no line") {
    tests::Noise noise(13);
    std::vector<double> power(2000);
    for (std::size_t k = 0; k < power.size(); ++k) {
        const double a = noise(), b = noise();
        const double u = (static_cast<double>(k) - 1000.0) / 30.0;
        power[k] = 0.5 * (a * a + b * b) * (1.0 + 100.0 * std::exp(-u * u));
    }
    const PowerSpectrum spectrum{power, 1.0, 1.0, 0};
    CHECK(significant_peaks(spectrum, noise_floor(spectrum), 0.01).empty());
}

namespace {

// Noise of so many averages around 1, a value a cell.
std::vector<double> flat_noise(std::size_t bins, int averages, unsigned seed) {
    tests::Noise noise(seed);
    std::vector<double> power(bins, 0.0);
    for (double& p : power) {
        for (int i = 0; i < averages; ++i) {
            const double a = noise(), b = noise();
            p += 0.5 * (a * a + b * b) / averages;
        }
    }
    return power;
}

}  // namespace

TEST_CASE("noise makes a line in one spectrum of a hundred at most, whatever its averages and its low end") {
    std::size_t lines = 0;
    for (const int averages : {1, 3, 10}) {
        for (unsigned seed = 0; seed < 200; ++seed) {
            std::vector<double> power = flat_noise(300, averages, 1000 + seed);
            // As steep as noise behind a resonance.
            for (std::size_t k = 1; k < power.size(); ++k)
                power[k] *= 1.0 + 1e4 * std::pow(3.0 / static_cast<double>(k), 4);
            const PowerSpectrum spectrum{power, static_cast<double>(averages), 1.0, 3, 8};
            lines += significant_peaks(spectrum, noise_floor(spectrum), 0.01).size();
        }
    }
    CHECK(lines <= 12);  // 1 % of 600 logs, and as much again
}

TEST_CASE("the ratio that is exceeded with a chance has that chance") {
    for (const double chance : {0.1, 1e-3, 1e-6})
        CHECK_THAT(exceedance({exceeded(chance, {.averages = 3.0, .cells = 6.0}), 3.0, 6.0}),
                   WithinRel(chance, 1e-6));
}

TEST_CASE("a running median is the median of each window, whatever way the window goes") {
    tests::Noise noise(5);
    std::vector<double> signal(3000);
    for (double& value : signal) value = std::round(20.0 * noise()) / 20.0;  // many equal values
    RunningMedian running(signal);
    std::mt19937 engine(7);
    std::size_t first = 0, count = 121;
    for (int step = 0; step < 2000; ++step) {
        // Forward by a little, with windows that grow and shrink; at times somewhere else entirely.
        first += engine() % 9;
        count = std::clamp<std::size_t>(count + engine() % 5 - engine() % 5, 1, 200);
        if (first + count > signal.size() || engine() % 50 == 0) first = engine() % (signal.size() - count);
        std::vector<double> window(signal.begin() + static_cast<std::ptrdiff_t>(first),
                                   signal.begin() + static_cast<std::ptrdiff_t>(first + count));
        std::sort(window.begin(), window.end());
        REQUIRE(running.at(first, count) == window[count / 2]);
    }
}

// Fourier sums against direct ones, and their kernels on every width of vectors.

namespace {

std::complex<double> direct_sum(const std::vector<double>& where, const std::vector<double>& value,
                                double frequency) {
    std::complex<double> sum;
    for (std::size_t j = 0; j < where.size(); ++j) {
        sum += value[j] * std::polar(1.0, -2.0 * std::numbers::pi * frequency * where[j]);
    }
    return sum;
}

}  // namespace

TEST_CASE("the real transform equals its defining sum at every length, prime lengths included") {
    const std::size_t n = GENERATE(1U, 2U, 3U, 16U, 97U, 120U);
    tests::Noise noise(3);
    std::vector<double> x(n), index(n);
    for (std::size_t k = 0; k < n; ++k) {
        x[k] = noise();
        index[k] = static_cast<double>(k);
    }
    const auto sums = real_fourier(x);
    REQUIRE(sums.size() == n / 2 + 1);
    for (std::size_t k = 0; k < sums.size(); ++k) {
        const auto expected = direct_sum(index, x, static_cast<double>(k) / static_cast<double>(n));
        CHECK_THAT(std::abs(sums[k] - expected), WithinAbs(0.0, 1e-12 * static_cast<double>(n)));
    }
}

TEST_CASE("a fast length is the next one without large prime factors") {
    CHECK(fast_length(0) == 1);
    CHECK(fast_length(11) == 12);
    CHECK(fast_length(97) == 98);
    CHECK(fast_length(1021) == 1024);
}

TEST_CASE("the spreading kernel's polynomials are the kernel, and nothing lies beyond its points") {
    const SpreadingKernel polynomials;
    SpreadingKernel::Row row;
    for (const double offset : {0.0, 1e-9, 0.13, 0.5, 0.77, 1.0}) {
        polynomials.at(offset, row);
        for (std::size_t i = 0; i < row.size(); ++i) {
            const double x = (static_cast<double>(i) + offset) * 2.0 / SpreadingKernel::width - 1.0;
            const bool inside = i < SpreadingKernel::width;
            const double kernel = inside ? SpreadingKernel::value(std::clamp(x, -1.0, 1.0)) : 0.0;
            const bool end = i == 0 || i + 1 == SpreadingKernel::width;
            CHECK_THAT(row[i], WithinAbs(kernel, end ? 1e-10 : 1e-14));
        }
    }
}

TEST_CASE("the spreading kernel's transform is its integral") {
    for (const double phase : {0.0, 1.0, 7.85}) {
        double sum = 0.0;
        constexpr int steps = 20000;
        for (int k = 0; k < steps; ++k) {
            const double x = (2.0 * k + 1.0) / steps - 1.0;
            sum += SpreadingKernel::value(x) * std::cos(phase * x) * 2.0 / steps;
        }
        CHECK_THAT(SpreadingKernel::transform(phase), WithinAbs(sum, 1e-8));
    }
}

TEST_CASE("the non-uniform transform equals the direct sum to 1e-9 of the sum of magnitudes") {
    tests::Noise noise(5);
    const std::size_t count = GENERATE(1U, 7U, 300U);
    std::vector<double> where, value;
    double magnitude = 0.0;
    for (int j = 0; j < 400; ++j) {
        where.push_back(3.0 * noise());  // unsorted, negative, crowded
        value.push_back(noise());
        magnitude += std::abs(value.back());
    }
    const double spacing = 0.37;
    const auto sums = nonuniform_fourier(where, value, spacing, count);
    REQUIRE(sums.size() == count);
    for (std::size_t k = 0; k < count; ++k) {
        const auto expected = direct_sum(where, value, spacing * static_cast<double>(k));
        CHECK_THAT(std::abs(sums[k] - expected), WithinAbs(0.0, 1e-9 * magnitude));
    }
}

TEST_CASE("the derivatives of a Fourier sum are those of its centred form") {
    const std::vector<double> where{0.0, 0.4, 1.1, 2.0}, value{1.0, -2.0, 0.5, 1.5};
    const double f = 0.8, h = 1e-5;
    const FourierPoint at = fourier_point(where, value, f);
    CHECK_THAT(std::abs(at.value - direct_sum(where, value, f)), WithinAbs(0.0, 1e-12));
    // |S|^2 does not depend on the origin of `where`: its slope is 2 Re(conj(S) S').
    const double slope =
        (std::norm(direct_sum(where, value, f + h)) - std::norm(direct_sum(where, value, f - h))) / (2 * h);
    CHECK_THAT(2.0 * std::real(std::conj(at.value) * at.first), WithinAbs(slope, 1e-6));
}

TEST_CASE("a Fourier sum over an even grid is the direct sum at every length, its derivatives too") {
    const std::size_t n = GENERATE(1U, 2U, 7U, 8U, 9U, 255U, 256U, 257U, 1031U);
    const double frequency = GENERATE(0.0, 0.37, 41.3, 499.0);
    tests::Noise noise(7);
    std::vector<double> where, value, centred;
    for (std::size_t k = 0; k < n; ++k) {
        where.push_back(0.25 + 0.001 * static_cast<double>(k));
        value.push_back(noise());
    }
    const double middle = 0.5 * (where.front() + where.back());
    for (const double at : where) centred.push_back(at - middle);
    const FourierPoint found = fourier_point(where, value, frequency);
    const std::complex<double> back = std::polar(1.0, -2.0 * std::numbers::pi * frequency * middle);
    const auto moment = [&](int power) {
        std::vector<double> weighted = value;
        for (std::size_t k = 0; k < n; ++k) weighted[k] *= std::pow(centred[k], power);
        return direct_sum(centred, weighted, frequency) * back *
               std::pow(std::complex<double>(0.0, -2.0 * std::numbers::pi), power);
    };
    const double rounding = 1e-12 * static_cast<double>(n);
    CHECK_THAT(std::abs(found.value - moment(0)), WithinAbs(0.0, rounding));
    CHECK_THAT(std::abs(found.first - moment(1)), WithinAbs(0.0, 10.0 * rounding));
    CHECK_THAT(std::abs(found.second - moment(2)), WithinAbs(0.0, 50.0 * rounding));
}

namespace {

/// Numbers of a kernel's results, one after another.
using Results = std::vector<double>;

/// `work` appends what a kernel makes.
template <class Work>
void check_widths(const char* name, std::size_t length, Work work) {
    std::vector<Results> made;
    for (const bool wide : widths()) {
        const Width here(wide);
        made.emplace_back();
        work(made.back());
    }
    INFO(name << " of " << length);
    CHECK_FALSE(made.front().empty());
    CHECK(made.front().size() == made.back().size());
    CHECK(std::memcmp(made.front().data(), made.back().data(), made.front().size() * sizeof(double)) == 0);
}

}  // namespace

TEST_CASE("the spreading kernel gives the same bits on every width of vectors, wherever a sample lies") {
    std::mt19937_64 random(18);
    std::uniform_real_distribution<double> offset(0.0, 1.0);
    const SpreadingKernel kernel;
    for (int trial = 0; trial < 2000; ++trial) {
        const double at = offset(random);
        check_widths("spreading", SpreadingKernel::width, [&](Results& into) {
            SpreadingKernel::Row row;
            kernel.at(at, row);
            into.assign(row.begin(), row.end());
        });
    }
}
