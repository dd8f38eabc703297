// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/steady.hpp"

#include <array>
#include <numbers>

#include "analysis/traces.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

enum class Colour { white, weak, strong, stronger, pink, heavy_tails, bursts, spikes };

std::vector<double> noise_of(Colour colour, std::size_t count, std::uint32_t seed) {
    tests::Noise normal(seed);
    std::mt19937 uniform(seed + 1);
    const double memory = colour == Colour::weak       ? 0.5
                          : colour == Colour::strong   ? 0.9
                          : colour == Colour::stronger ? 0.98
                                                       : 0.0;
    std::vector<double> values(count);
    std::array<double, 6> slow{};
    double last = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        const double white = normal();
        last = memory * last + white;
        values[k] = last;
        if (colour == Colour::pink) {
            // A sum of slow and quick ones, a factor of four apart: 1/f within a decibel.
            double share = 0.5, sum = 0.0;
            for (double& one : slow) {
                one += share * (normal() - one);
                sum += one / std::sqrt(share);
                share *= 0.25;
            }
            values[k] = sum;
        }
        // Student's t of three degrees of freedom.
        if (colour == Colour::heavy_tails) {
            const double a = normal(), b = normal(), c = normal();
            values[k] = white / std::sqrt((a * a + b * b + c * c) / 3.0);
        }
        if (colour == Colour::bursts) values[k] = white * (k % count < count / 6 ? 1.0 : 0.05);
        if (colour == Colour::spikes && uniform() % count < 3) values[k] = 100.0 * white;
    }
    return values;
}

Trace trace_of(std::vector<double> torque, double rate) {
    Trace trace;
    trace.sample_rate = Hertz(rate);
    for (std::size_t k = 0; k < torque.size(); ++k) {
        trace.time_s.push_back(static_cast<double>(k) / rate);
        trace.velocity_deg_s.push_back(10.0);
    }
    trace.torque_nm = std::move(torque);
    return trace;
}

/// White noise of `floor_nm` with `rms_nm` of noise added that a resonance lets through.
Trace resonating(double hz, double width_hz, double rms_nm, double floor_nm, double seconds,
                 std::uint32_t seed) {
    constexpr double rate = 1000.0;
    tests::Noise noise(seed);
    const double pole = std::exp(-std::numbers::pi * width_hz / rate);
    const double turn = 2.0 * pole * std::cos(2.0 * std::numbers::pi * hz / rate), back = -pole * pole;
    std::vector<double> torque(static_cast<std::size_t>(seconds * rate));
    double last = 0.0, before = 0.0, square = 0.0;
    for (double& value : torque) {
        value = turn * last + back * before + noise();
        before = last;
        last = value;
        square += value * value / static_cast<double>(torque.size());
    }
    for (double& value : torque) value = value * rms_nm / std::sqrt(square) + floor_nm * noise();
    return trace_of(std::move(torque), rate);
}

}  // namespace

TEST_CASE("noise of any colour shows a line or a hump in two spectra of a hundred at most") {
    const Colour colour = GENERATE(Colour::white, Colour::weak, Colour::strong, Colour::stronger,
                                   Colour::pink, Colour::heavy_tails, Colour::bursts, Colour::spikes);
    const bool in_pieces = GENERATE(false, true);
    constexpr int runs = 100;
    int lines = 0, humps = 0;
    for (int run = 0; run < runs; ++run) {
        const Trace trace = trace_of(noise_of(colour, 4096, static_cast<std::uint32_t>(50 + run)), 500.0);
        SpectrumOptions options;
        if (in_pieces) options.segment = Seconds(1.0);
        const Spectrum spectrum = torque_spectrum(trace.view(), options);
        lines += spectrum.peaks.empty() ? 0 : 1;
        humps += spectrum.humps.empty() ? 0 : 1;
    }
    INFO("colour " << static_cast<int>(colour) << ": lines in " << lines << ", humps in " << humps);
    CHECK(humps <= 2);
    // One loud piece among quiet ones is one average, and the line test counts all of them.
    if (colour != Colour::bursts || !in_pieces) CHECK(lines <= 4);
}

TEST_CASE("a resonance is a hump, with its band and the torque in it, and no line") {
    const double hz = GENERATE(30.0, 60.0, 300.0);
    int found = 0;
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
        const Trace trace = resonating(hz, 2.0, 0.5, 0.2, 20.0, seed);
        const Spectrum spectrum = torque_spectrum(trace.view(), {});
        CHECK(spectrum.peaks.empty());
        if (spectrum.humps.size() != 1) continue;
        ++found;
        const SpectralHump& hump = spectrum.humps.front();
        CHECK(hump.from_hz < hz);
        CHECK(hump.to_hz > hz);
        CHECK_THAT(hump.peak_hz, WithinAbs(hz, 4.0));
        // The band ends where its power is twice the noise's; a tenth of the torque lies beyond.
        CHECK_THAT(hump.rms_nm, WithinRel(0.5, 0.15));
        // A sine's power is half its amplitude's square, and a Hann window spreads it over 1.5 bins.
        double square = 0.0, highest = 0.0;
        for (std::size_t k = 0; k < spectrum.hz.size(); ++k) {
            if (spectrum.hz[k] < hump.from_hz - 1e-9 || spectrum.hz[k] > hump.to_hz + 1e-9) continue;
            const double amplitude = spectrum.amplitude_nm[k];
            square += (amplitude * amplitude - hump.floor_nm * hump.floor_nm) / (2.0 * 1.5);
            highest = std::max(highest, amplitude);
        }
        CHECK_THAT(hump.rms_nm, WithinRel(std::sqrt(square), 1e-6));
        CHECK_THAT(hump.peak_nm, WithinRel(highest, 1e-9));
    }
    CHECK(found == 5);
}

TEST_CASE("a strong line is a line and no hump, however far its skirt rises above the noise") {
    const Trace trace = tests::make_trace(
        {.seconds = 8.0, .tones = {{61.37, GENERATE(0.1, 1.0, 30.0), 0.4}}, .noise_nm = 0.01});
    const Spectrum spectrum = torque_spectrum(trace.view(), {});
    CHECK(spectrum.peaks.size() == 1);
    CHECK(spectrum.humps.empty());
}

TEST_CASE("a clock that stumbles in a pattern makes no lines of that pattern out of slow torque") {
    // Every fiftieth step is half as long again, as where a message comes late: true times, truly stated.
    constexpr std::size_t count = 20000;
    tests::Noise noise(3);
    Trace trace;
    double t = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        trace.time_s.push_back(t);
        trace.velocity_deg_s.push_back(50.0);
        trace.torque_nm.push_back(20.0 * std::sin(2.0 * std::numbers::pi * 0.3 * t) + 0.05 * noise());
        t += k % 50 < 25 ? 0.0011 : 0.0009;
        if (k % 50 == 49) t += 0.0005;
    }
    trace.sample_rate = Hertz(static_cast<double>(count - 1) / trace.time_s.back());
    const Spectrum spectrum = torque_spectrum(trace.view(), {});
    const auto above = [](double hz) { return hz > 5.0 && hz < 100.0; };
    for (const SpectralPeak& peak : spectrum.peaks) CHECK_FALSE((above(peak.hz) && peak.amplitude_nm > 0.02));
    for (const SpectralHump& hump : spectrum.humps) CHECK_FALSE((above(hump.from_hz) && hump.rms_nm > 0.02));
}
