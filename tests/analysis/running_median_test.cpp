// SPDX-License-Identifier: MIT
#include "analysis/spectrum/spectrum.hpp"

#include <algorithm>

#include "analysis/traces.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

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
