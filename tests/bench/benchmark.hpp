// SPDX-License-Identifier: MIT
#pragma once
// Benchmarks of the library's own parts. A file of benchmarks defines constants of type Benchmark; main.cpp
// runs them.
//
// Not Catch2's BENCHMARK: it reports the mean wall time of one call. Here the machine is shared, so what
// counts is processor time, the median of rounds that take all benchmarks in turn.

#include <cstddef>
#include <cstdint>
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

/// Samples of a joint, 2000 a second: speed through all bands of a table up to 166 deg/s, ripple at orders 1
/// and 2 of a gear of 40, noise from a linear congruential generator. Joints differ in where their motion
/// begins.
class BenchSignal {
  public:
    struct Sample {
        double time_s, velocity_deg_s, torque_nm;
    };
    explicit BenchSignal(std::size_t joint = 0) : joint_(static_cast<double>(joint)), seed_(joint + 1) {}
    Sample next();

  private:
    double joint_, motor_ = 0.0;
    std::uint64_t seed_, count_ = 0;
};

/// The first samples of a joint's signal.
struct BenchLog {
    explicit BenchLog(std::size_t samples);
    std::vector<double> time_s, velocity_deg_s, torque_nm;
};

}  // namespace ripplenotch::bench
