// SPDX-License-Identifier: MIT
// Spectra against frequency and against angle.
#include <complex>
#include <memory>

#include "benchmark.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/spectrum.hpp"

namespace ripplenotch::bench {
namespace {

constexpr std::size_t samples = 10'000'000, sums = 100'000;
constexpr double rate = 2000.0;

Benchmark::Pass welch() {
    auto log = std::make_shared<BenchLog>(samples);
    return [log] {
        const TraceView trace{Hertz(rate), log->time_s, log->velocity_deg_s, log->torque_nm, {}};
        keep(torque_spectrum(trace, {.segment = Seconds(4096.0 / rate)}).psd_nm2_hz[100]);
    };
}

/// Sums at 8192 orders over samples that lie unevenly along the angle.
Benchmark::Pass order_sums() {
    auto log = std::make_shared<BenchLog>(sums);
    auto turns = std::make_shared<std::vector<double>>();
    double angle = 0.0;
    for (const double speed : log->velocity_deg_s) turns->push_back(angle += (speed + 200.0) / 360.0 / rate);
    return [log, turns] {
        keep(std::abs(nonuniform_fourier(*turns, log->torque_nm, 0.5 / turns->back(), 8192).back()));
    };
}

Benchmark::Pass one_order() {
    auto log = std::make_shared<BenchLog>(sums);
    return [log] { keep(std::abs(fourier_point(log->velocity_deg_s, log->torque_nm, 0.3).value)); };
}

Benchmark::Pass floors() {
    auto power = std::make_shared<std::vector<double>>(BenchLog(sums).torque_nm);
    for (double& value : *power) value *= value;
    return [power] { keep(noise_floor({*power, 1.0, 1.5, 3, {}}).back()); };
}

const Benchmark welch_segments("spectra: Welch and its lines, segments of 4096", samples, welch);
const Benchmark many_orders("spectra: sums over angle, 8192 orders", sums, order_sums);
const Benchmark order("spectra: sum over angle, one order", sums, one_order);
const Benchmark floor_("spectra: noise floor, a bin", sums, floors);

}  // namespace
}  // namespace ripplenotch::bench
