// SPDX-License-Identifier: MIT
#include "log/step_watch.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

using namespace ripplenotch;

namespace {

std::vector<double> times(std::size_t count, std::uint64_t seed, double repeats = 0.0) {
    std::mt19937_64 random(seed);
    std::lognormal_distribution<double> step(-7.0, 0.5);
    std::uniform_real_distribution<double> chance;
    std::vector<double> all;
    double time = 100.0;
    for (std::size_t i = 0; i < count; ++i) {
        all.push_back(time);
        if (chance(random) >= repeats) time += step(random);
    }
    return all;
}

double rate_of(const StepWatch& watch) { return watch.sample_rate().value(); }

}  // namespace

TEST_CASE("the step of a rank is found exactly, from parts of any size") {
    const std::vector<double> time = times(3001, 5, 0.2);
    std::vector<double> steps;
    for (std::size_t i = 1; i < time.size(); ++i) {
        if (time[i] > time[i - 1]) steps.push_back(time[i] - time[i - 1]);
    }
    std::sort(steps.begin(), steps.end());
    const std::size_t rank = GENERATE(0U, 1U, 700U, 1200U, 2000U), part = GENERATE(1U, 7U, 5000U);
    StepOfRank found(rank);
    int passes = 0;
    do {
        for (std::size_t i = 0; i < time.size(); i += part)
            found.take(std::span(time).subspan(i, std::min<std::size_t>(part, time.size() - i)));
        ++passes;
    } while (found.next_digit());
    CHECK(found.value() == steps[rank]);
    CHECK(passes == 4);
}

TEST_CASE("a clock is settled only when the median of all steps makes the same gaps") {
    std::vector<double> even;
    for (int i = 0; i < 1000; ++i) even.push_back(0.001 * i);
    StepWatch good(10.0);
    good.take(even);
    CHECK(good.settled());
    CHECK(rate_of(good) == Approx(1000.0));

    // The first rows are ten times as fast as the rest.
    StepWatch fast(10.0);
    fast.take(std::vector<double>{0.0, 0.0001, 0.0002});
    for (double time : even) fast.take(std::vector<double>{1.0 + time});
    CHECK_FALSE(fast.settled());
    CHECK(fast.usual_rank() == 501);

    // A step that the guess and the median could see differently.
    std::vector<double> edge = even;
    for (std::size_t i = 500; i < edge.size(); ++i) edge[i] += 0.0091;
    StepWatch close(10.0);
    close.take(edge);
    CHECK_FALSE(close.settled());
    StepWatch exact(10.0, 0.001);
    exact.take(edge);
    CHECK(exact.troubles().gaps == 1);
}

TEST_CASE("a clock that never advances is settled, and has no rate") {
    StepWatch watch(10.0);
    watch.take(std::vector<double>(50, 3.0));
    CHECK(watch.settled());
    CHECK(rate_of(watch) == 0.0);
    CHECK(watch.troubles().repeated_times == 49);
    CHECK(watch.troubles().gaps == 0);
}
