// SPDX-License-Identifier: MIT
// consumer LOG: reads a log and designs a notch.
#include <cstdio>
#include <exception>

#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/log/log.hpp"

int main(int argc, char** argv) {
    try {
        const ripplenotch::Log log = ripplenotch::read_log(argc > 1 ? argv[1] : "-", {});
        const ripplenotch::Hertz rate = log.recording.clock.nominal_rate;
        const auto notch = ripplenotch::design_notch({ripplenotch::Hertz(25.0), 0.25}, rate);
        std::printf("%.0f Hz, %.6f\n", rate.value(), notch.b0);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
