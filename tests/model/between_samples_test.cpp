// SPDX-License-Identifier: MIT
#include "model/spring/mass_on_spring.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "support/catch.hpp"

using namespace ripplenotch;
using std::numbers::pi;

namespace {

// cos(2 pi f k), f in cycles per sample.
std::vector<double> wave(double frequency, std::size_t count = 400) {
    std::vector<double> values(count);
    for (std::size_t k = 0; k < count; ++k)
        values[k] = std::cos(2.0 * pi * frequency * static_cast<double>(k));
    return values;
}

// Largest difference from size * cos(2 pi f k + phase) away from both ends.
double error(const std::vector<double>& values, double frequency, std::complex<double> response) {
    double most = 0.0;
    for (std::size_t k = 200; k + 20 < values.size(); ++k) {
        const auto turned = response * std::polar(1.0, 2.0 * pi * frequency * static_cast<double>(k));
        most = std::max(most, std::abs(values[k] - turned.real()));
    }
    return most;
}

}  // namespace

TEST_CASE("a shift by a part of a sample is exact to the error that its header states") {
    for (const double delay : {0.5, 3.25, -0.5, -7.8, 12.5}) {
        for (const auto& [frequency, bound] :
             {std::pair(0.01, 1e-12), {0.1, 1e-7}, {0.2, 5e-5}, {0.3, 1e-2}}) {
            CAPTURE(delay, frequency);
            auto values = wave(frequency);
            shift_samples(values, delay);
            CHECK(error(values, frequency, std::polar(1.0, -2.0 * pi * frequency * delay)) < bound);
        }
    }
}

TEST_CASE("a shift by whole samples moves samples, and the ends stay") {
    std::vector<double> values = {1.0, 2.0, 4.0, 8.0};
    shift_samples(values, 2.0);
    CHECK(values == std::vector<double>{1.0, 1.0, 1.0, 2.0});
    values = {1.0, 2.0, 4.0, 8.0};
    shift_samples(values, -1.0);
    CHECK(values == std::vector<double>{2.0, 4.0, 8.0, 8.0});
    values.clear();
    shift_samples(values, 1.5);
    CHECK(values.empty());
}

TEST_CASE("a lag answers as 1 / (1 + i w tau) says, without half a sample too much or too little") {
    for (const double tau : {0.05, 0.5, 1.0, 3.0, 8.0, 50.0}) {
        for (const auto& [frequency, bound] : {std::pair(0.002, 1e-9), {0.02, 1e-7}, {0.1, 5e-4}}) {
            CAPTURE(tau, frequency);
            auto values = wave(frequency, 1400);
            first_order_lag(values, tau);
            // What the start leaves decays within tau; beyond 20 tau it is below 1e-8.
            values.erase(values.begin(), values.begin() + 1000);
            const std::complex<double> response = 1.0 / std::complex(1.0, 2.0 * pi * frequency * tau);
            const auto turn = std::polar(1.0, 2.0 * pi * frequency * 1000.0);
            CHECK(error(values, frequency, response * turn) < bound);
        }
    }
}

TEST_CASE("a lag starts settled, and a step reaches 1 - 1/e of its way after the time constant") {
    std::vector<double> values(400, 3.0);
    first_order_lag(values, 20.0);
    for (const double value : values) CHECK(value == Approx(3.0).epsilon(1e-14));
    // A ramp lags by tau, whatever tau.
    for (const double tau : {0.3, 4.0, 20.0}) {
        std::vector<double> ramp(1000);
        for (std::size_t k = 0; k < ramp.size(); ++k) ramp[k] = static_cast<double>(k);
        first_order_lag(ramp, tau);
        CHECK(ramp[900] == Approx(900.0 - tau).epsilon(1e-12));
    }
    // The step happens half-way between the samples 99 and 100.
    std::vector<double> step(400, 0.0);
    for (std::size_t k = 100; k < step.size(); ++k) step[k] = 1.0;
    first_order_lag(step, 20.0);
    for (const std::size_t k : {110U, 120U, 160U})
        CHECK(step[k] == Approx(1.0 - std::exp(-(static_cast<double>(k) - 99.5) / 20.0)).margin(1e-3));
}
