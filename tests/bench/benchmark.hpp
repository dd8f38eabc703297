// SPDX-License-Identifier: MIT
#pragma once
// Benchmarks of the library's own parts. A file of benchmarks defines constants of type Benchmark; main.cpp
// runs them.
//
// Not Catch2's BENCHMARK: it reports the mean wall time of one call. Here the machine is shared, so what
// counts is processor time, the median of rounds that take all benchmarks in turn, and a rate that
// scripts/bench-peers can read.

#include <functional>
#include <string>
#include <vector>

namespace ripplenotch::bench {

struct Benchmark {
    using Pass = std::function<void()>;

    /// `name` says what is done once a pass, `work` how often: samples, numbers. `prepare` makes the input,
    /// outside the time measured, and returns the pass.
    Benchmark(std::string name, double work, std::function<Pass()> prepare);

    std::string name;
    double work;
    std::function<Pass()> prepare;
};

/// Those defined anywhere in the program, by name.
[[nodiscard]] std::vector<const Benchmark*> all_benchmarks();

/// Keeps a result from being left out by the compiler.
void keep(double value);

/// A joint's log: speed through all bands of a table up to 166 deg/s, ripple at orders 1 and 2 of a gear of
/// 40, noise. 2000 samples a second; time as decimal text reads, k / 2000.
struct BenchLog {
    explicit BenchLog(std::size_t samples);
    std::vector<double> time_s, velocity_deg_s, torque_nm;
};

}  // namespace ripplenotch::bench
