// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/frequency_response.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/traces.hpp"
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

constexpr double rate_hz = 1000.0;

std::vector<double> noise(std::size_t rows, double sigma, std::uint32_t seed) {
    tests::Noise next(seed);
    std::vector<double> values(rows);
    for (double& value : values) value = sigma * next();
    return values;
}

std::vector<double> sum(std::vector<double> a, const std::vector<double>& b) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
    return a;
}

struct Pair {
    std::vector<double> in, out;
    std::vector<double> time_s = {};
    std::vector<std::size_t> run_starts = {};

    FrequencyResponse response(const ResponseOptions& options = {}) {
        if (time_s.empty())
            for (std::size_t k = 0; k < in.size(); ++k) time_s.push_back(static_cast<double>(k) / rate_hz);
        return frequency_response({Hertz(rate_hz), time_s, in, out, run_starts}, options);
    }
};

// A resonance at 30 Hz with Q 1.
constexpr Biquad resonance{0.00746, 0.01492, 0.00746, -1.7933, 0.82314};

std::vector<double> filtered(const Biquad& filter, const std::vector<double>& in) {
    BiquadState state;
    std::vector<double> out;
    for (const double x : in) out.push_back(step(filter, state, x));
    return out;
}

PredictedResponse truth(const Biquad& filter, const FrequencyResponse& response) {
    PredictedResponse predicted{"truth", "", {}};
    for (const double hz : response.hz)
        predicted.at.push_back(ripplenotch::response(filter, Hertz(hz), SampledAt(Hertz(rate_hz))));
    return predicted;
}

}  // namespace

TEST_CASE("a signal that is the other times a number has that gain, no phase and coherence 1") {
    const auto estimator = GENERATE(ResponseEstimator::h1, ResponseEstimator::h2);
    const std::vector<double> in = noise(8000, 1.0, 1);
    std::vector<double> out = in;
    for (double& value : out) value *= -0.37;
    const FrequencyResponse response = Pair{in, out}.response({.segment = 0.5_s, .estimator = estimator});
    REQUIRE(response.segments == 31);
    REQUIRE(response.ranges.size() == 1);
    CHECK(response.determined_bins() == response.hz.size() - 4);  // 0 to 4 Hz hold the trend, 500 Hz is real
    for (std::size_t k = 3; k + 1 < response.hz.size(); ++k) {
        CHECK_THAT(response.coherence[k], WithinAbs(1.0, 1e-12));
        CHECK_THAT(response.gain[k], WithinRel(0.37, 1e-9));
        CHECK_THAT(std::abs(response.phase_deg[k]), WithinAbs(180.0, 1e-6));
        CHECK(response.gain_high[k] - response.gain_low[k] < 1e-6);
    }
}

TEST_CASE("the response of a filter is within the 95 % region at 95 % of the frequencies") {
    const auto estimator = GENERATE(ResponseEstimator::h1, ResponseEstimator::h2);
    Agreement all;
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        const std::vector<double> in = noise(20'000, 1.0, seed), out = filtered(resonance, in),
                                  more = noise(20'000, 0.05, 100 + seed);
        Pair pair{in, sum(out, more)};
        if (estimator == ResponseEstimator::h2) pair = {sum(in, noise(20'000, 0.3, 200 + seed)), out};
        const FrequencyResponse response = pair.response({.segment = 1.0_s, .estimator = estimator});
        const Agreement one = agreement(response, truth(resonance, response));
        all.bins += one.bins;
        all.within += one.within;
    }
    REQUIRE(all.bins > 1000);
    CHECK_THAT(static_cast<double>(all.within) / static_cast<double>(all.bins), WithinAbs(0.95, 0.012));
}

TEST_CASE("noise of the input lowers H1 by the coherence and leaves H2, noise of the output the other way") {
    const std::vector<double> signal = noise(200'000, 1.0, 7), more = noise(200'000, 1.0, 8);
    const auto mean_gain = [](const FrequencyResponse& response) {
        double total = 0.0;
        for (std::size_t k = 10; k < 200; ++k) total += response.gain[k] / 190.0;
        return total;
    };
    Pair of_in{sum(signal, more), signal}, of_out{signal, sum(signal, more)};
    const ResponseOptions h1{.segment = 0.5_s}, h2{.segment = 0.5_s, .estimator = ResponseEstimator::h2};
    CHECK_THAT(mean_gain(of_in.response(h1)), WithinRel(0.5, 0.02));
    CHECK_THAT(mean_gain(of_in.response(h2)), WithinRel(1.0, 0.02));
    CHECK_THAT(mean_gain(of_out.response(h1)), WithinRel(1.0, 0.02));
    CHECK_THAT(mean_gain(of_out.response(h2)), WithinRel(2.0, 0.02));
}

TEST_CASE(
    "the coherence of independent signals is below its limit at 95 % of the frequencies, 1/n in the mean") {
    const double segment_s = GENERATE(2.0, 0.5, 0.1);
    std::size_t below = 0, bins = 0, logs_determined = 0;
    double total = 0.0, inverse = 0.0;
    constexpr std::size_t logs = 60;
    for (std::uint32_t seed = 1; seed <= logs; ++seed) {
        Pair pair{noise(8000, 1.0, seed), noise(8000, 1.0, 1000 + seed)};
        const FrequencyResponse response = pair.response({.segment = Seconds(segment_s)});
        for (std::size_t k = 3; k + 1 < response.hz.size(); ++k) {
            ++bins;
            below += response.coherence[k] <= response.coherence_limit ? 1 : 0;
            total += response.coherence[k];
        }
        inverse = 1.0 / response.independent_segments;
        logs_determined += response.ranges.empty() ? 0 : 1;
    }
    const auto count = static_cast<double>(bins);
    CHECK_THAT(static_cast<double>(below) / count, WithinAbs(0.95, 0.012));
    CHECK_THAT(total / count, WithinRel(inverse, 0.05));
    CHECK(logs_determined <= 8);  // 3 are expected, more than 8 have a chance of 0.4 %
}

TEST_CASE("a delay is the slope of the phase, and phase delay where the phase is known from below") {
    constexpr std::size_t samples = 7;
    const std::vector<double> in = noise(40'000, 1.0, 3);
    std::vector<double> late(in.size(), 0.0);
    std::copy(in.begin(), in.end() - samples, late.begin() + samples);
    const FrequencyResponse response =
        Pair{in, sum(late, noise(in.size(), 0.2, 4))}.response({.segment = 1.0_s});
    const std::vector<ResponseRow> rows = third_octaves(response);
    REQUIRE(rows.size() > 10);
    std::size_t within = 0;
    for (const ResponseRow& row : rows) {
        REQUIRE(row.group_delay);
        REQUIRE(row.phase_delay);
        const double off = std::abs(row.group_delay->delay.value() - 0.007);
        within += off <= row.group_delay->error.value() ? 1 : 0;
        CHECK(off <= 3.0 * row.group_delay->error.value());
        CHECK_THAT(row.phase_delay->value(),
                   WithinAbs(0.007, 1.5 * response.phase_error_deg[row.bin] / 360.0 / response.hz[row.bin]));
    }
    CHECK(within + 2 >= rows.size());
}

TEST_CASE("a line alone determines the response at its frequency and nowhere else") {
    std::vector<double> in, out;
    tests::Noise next(5);
    for (std::size_t k = 0; k < 20'000; ++k) {
        const double at = full_turn * 50.3 * static_cast<double>(k) / rate_hz;
        in.push_back(std::sin(at));
        out.push_back(0.5 * std::sin(at - 1.0) + 1e-3 * next());
    }
    const FrequencyResponse response = Pair{in, out}.response({.segment = 1.0_s});
    CHECK(response.determined_bins() == 1);
    CHECK_THAT(response.gain[50], WithinRel(0.5, 0.01));
    CHECK_THAT(response.phase_deg[50], WithinAbs(-57.3, 0.5));
}

TEST_CASE("no segment reaches across a gap") {
    const std::vector<double> in = noise(10'000, 1.0, 11);
    std::vector<double> out = in;
    // Behind the gap the output belongs to another time.
    Pair pair{in, out, {}, {4900}};
    for (std::size_t k = 0; k < in.size(); ++k)
        pair.time_s.push_back(static_cast<double>(k) / rate_hz + (k < 4900 ? 0.0 : 2.0));
    for (std::size_t k = 4900; k < in.size(); ++k) pair.in[k] = pair.out[k] += 50.0;
    const FrequencyResponse response = pair.response({.segment = 0.5_s});
    CHECK(response.segments == 18 + 19);  // of 19.6 and 20.4 halves
    CHECK_THAT(response.coherence[40], WithinAbs(1.0, 1e-12));
}

TEST_CASE("an uneven clock leaves gain and coherence as they are") {
    const Trace trace = tests::make_trace({.seconds = 8.0, .noise_nm = 1.0, .jitter_steps = 0.2, .seed = 2});
    std::vector<double> out = trace.torque_nm;
    for (double& value : out) value *= 3.0;
    const FrequencyResponse response =
        frequency_response({trace.sample_rate, trace.time_s, trace.torque_nm, out}, {.segment = 0.5_s});
    for (std::size_t k = 3; k < 200; ++k) {
        CHECK_THAT(response.gain[k], WithinRel(3.0, 1e-6));
        CHECK_THAT(response.coherence[k], WithinAbs(1.0, 1e-9));
    }
}

TEST_CASE("a response from too few segments is refused") {
    const std::vector<double> in = noise(1000, 1.0, 1);
    CHECK_THROWS_AS((Pair{in, in}.response({.segment = 0.5_s})), DataError);
    CHECK_THROWS_AS((Pair{in, in}.response({.resolution = 1_Hz})), DataError);
    CHECK_THROWS_AS((Pair{in, in}.response({.segment = 0.01_s})), DataError);
    CHECK(Pair{in, in}.response({.resolution = 15_Hz}).segments == 19);
}
