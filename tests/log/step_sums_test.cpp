// SPDX-License-Identifier: MIT
#include "log/clock/clock_check.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

TEST_CASE("steps are summed up as a plain loop does, the same bits on every width of vectors", "[log]") {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> step(0.0005, 0.0015);
    for (std::size_t count = 2; count < 80; ++count) {
        std::vector<double> time_s = {100.0};
        while (time_s.size() < count) time_s.push_back(time_s.back() + step(random));
        // Four sums side by side, the last few steps behind them.
        double sums[4] = {}, shortest = 1.0, longest = 0.0, rest = 0.0;
        const std::size_t steps = count - 1, even = steps - steps % 4;
        for (std::size_t k = 0; k < steps; ++k) {
            const double now = time_s[k + 1] - time_s[k];
            if (k < even) sums[k % 4] += (now - 0.001) * (now - 0.001);
            shortest = std::min(shortest, now);
            longest = std::max(longest, now);
        }
        rest = (sums[0] + sums[1]) + (sums[2] + sums[3]);
        for (std::size_t k = even; k < steps; ++k) {
            const double off = time_s[k + 1] - time_s[k] - 0.001;
            rest += off * off;
        }
        for (const bool wide : widths()) {
            const Width here(wide);
            const StepSums found = sum_up_steps(time_s, 0.001);
            CHECK(found.squares == rest);
            CHECK(found.shortest_s == shortest);
            CHECK(found.longest_s == longest);
        }
    }
}
