// SPDX-License-Identifier: MIT
// usage: bench_ripplenotch [--rounds N] [WORD...]    benchmarks whose name contains a WORD; all when
// none is given
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>

#include "benchmark.hpp"

namespace ripplenotch::bench {
namespace {

std::vector<const Benchmark*>& registry() {
    static std::vector<const Benchmark*> list;
    return list;
}

volatile double kept = 0.0;

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Request {
    std::size_t rounds = 5;
    std::vector<std::string> words;

    Request(int count, char** arguments) {
        for (int i = 1; i < count; ++i) {
            const std::string word = arguments[i];
            if (word == "--rounds" && i + 1 < count)
                rounds = std::max(1UL, std::strtoul(arguments[++i], nullptr, 10));
            else
                words.push_back(word);
        }
    }
    [[nodiscard]] bool wants(const Benchmark& benchmark) const {
        return words.empty() || std::any_of(words.begin(), words.end(), [&](const std::string& word) {
                   return benchmark.name.find(word) != std::string::npos;
               });
    }
};

struct Measured {
    const Benchmark* benchmark;
    Benchmark::Pass pass;
    std::vector<double> seconds;

    [[nodiscard]] double median() const { return seconds[seconds.size() / 2]; }
    [[nodiscard]] double million_a_second() const { return 1e-6 * benchmark->work / median(); }
};

/// One pass of each that is not counted, then rounds in which each has one pass: a slow spell of the machine
/// meets all.
std::vector<Measured> run(const Request& request) {
    std::vector<Measured> all;
    for (const Benchmark* benchmark : all_benchmarks()) {
        if (request.wants(*benchmark)) all.push_back({benchmark, benchmark->prepare(), {}});
    }
    for (std::size_t round = 0; round <= request.rounds; ++round) {
        for (Measured& one : all) {
            const double began = processor_seconds();
            one.pass();
            if (round > 0) one.seconds.push_back(processor_seconds() - began);
        }
    }
    for (Measured& one : all) std::sort(one.seconds.begin(), one.seconds.end());
    return all;
}

void print(const std::vector<Measured>& all) {
    for (const Measured& one : all)
        fmt::print("{:52} {:10.3f} ms  {:8.3f} ns each  {:9.1f} million a second\n", one.benchmark->name,
                   1e3 * one.median(), 1e9 * one.median() / one.benchmark->work, one.million_a_second());
}

}  // namespace

Benchmark::Benchmark(std::string its_name, double its_work, std::function<Pass()> its_prepare)
    : name(std::move(its_name)), work(its_work), prepare(std::move(its_prepare)) {
    registry().push_back(this);
}

std::vector<const Benchmark*> all_benchmarks() {
    std::vector<const Benchmark*> list = registry();
    std::sort(list.begin(), list.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
    return list;
}

void keep(double value) { kept = value; }

}  // namespace ripplenotch::bench

int main(int count, char** arguments) {
    using namespace ripplenotch::bench;
    print(run(Request(count, arguments)));
    return EXIT_SUCCESS;
}
