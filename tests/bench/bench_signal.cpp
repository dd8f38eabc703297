// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>

#include "benchmark.hpp"

namespace ripplenotch::bench {

BenchSignal::Sample BenchSignal::next() {
    const double t = static_cast<double>(count_++) / 2000.0, at = t + 10.0 * joint_;
    const double speed = 166.0 * std::sin(0.314 * at) * std::sin(0.17 * at + 1.0);
    motor_ += 40.0 * speed * std::numbers::pi / 180.0 / 2000.0;
    seed_ = seed_ * 16807 % 2147483647;
    const double noise = static_cast<double>(seed_) / 2147483647.0 - 0.5;
    return {t, speed,
            speed / 52.0 + 0.8 * std::sin(motor_) + 0.35 * std::sin(2.0 * motor_ + 1.0) + 0.2 * noise};
}

BenchLog::BenchLog(std::size_t samples) {
    BenchSignal signal;
    for (std::size_t k = 0; k < samples; ++k) {
        const BenchSignal::Sample sample = signal.next();
        time_s.push_back(sample.time_s);
        velocity_deg_s.push_back(sample.velocity_deg_s);
        torque_nm.push_back(sample.torque_nm);
    }
}

}  // namespace ripplenotch::bench
