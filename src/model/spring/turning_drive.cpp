// SPDX-License-Identifier: MIT
#include "model/spring/turning_drive.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Times are told to a few bits; steps that differ by less than this part of the usual one are one step.
constexpr double same_step = 1e-9;

void find_steps(const Motion& motion, TurningDrive& drive) {
    const double usual_s = 1.0 / motion.sample_rate.value();
    std::unordered_map<long long, std::size_t> known;
    drive.steps_s.push_back(usual_s);
    drive.step.assign(motion.size(), 0);
    for (std::size_t k = 1; k < motion.size(); ++k) {
        const double step_s = motion.time_s[k] - motion.time_s[k - 1];
        const double beside = (step_s / usual_s - 1.0) / same_step;
        if (!(step_s > 0.0) || std::abs(beside) < 0.5) continue;
        constexpr double most = 9e18;  // what a whole number holds: longer steps are one, which all dies in
        const auto [found, is_new] =
            known.try_emplace(std::llround(std::min(beside, most)), drive.steps_s.size());
        if (is_new) drive.steps_s.push_back(step_s);
        drive.step[k] = found->second;
    }
}

TurningDrive found_drive(const Motion& motion, double cycles_per_deg) {
    TurningDrive drive;
    const std::size_t samples = motion.size();
    drive.hz.resize(samples);
    drive.cosine.resize(samples);
    drive.sine.resize(samples);
    std::vector<double> angle_deg(samples);
    for (std::size_t k = 0; k < samples; ++k) {
        const std::size_t before = k - std::min<std::size_t>(k, 1);
        const double deg_s = 0.5 * (motion.velocity_deg_s[before] + motion.velocity_deg_s[k]);
        drive.hz[k] = cycles_per_deg * deg_s;
        angle_deg[k] = -360.0 * cycles_per_deg * deg_s * (motion.time_s[k] - motion.time_s[before]);
    }
    portable::cos_degrees(angle_deg, drive.cosine);
    portable::sin_degrees(angle_deg, drive.sine);
    find_steps(motion, drive);
    return drive;
}

}  // namespace

std::shared_ptr<const TurningDrive> turning_drive(const Motion& motion, double cycles_per_deg) {
    struct Asked {
        std::vector<double> time_s, velocity_deg_s;
        double rate_hz = 0.0, cycles_per_deg = 0.0;
        std::shared_ptr<const TurningDrive> drive;
    };
    thread_local Asked last;
    if (last.drive == nullptr || last.cycles_per_deg != cycles_per_deg ||
        last.rate_hz != motion.sample_rate.value() || last.velocity_deg_s != motion.velocity_deg_s ||
        last.time_s != motion.time_s)
        last = {motion.time_s, motion.velocity_deg_s, motion.sample_rate.value(), cycles_per_deg,
                std::make_shared<const TurningDrive>(found_drive(motion, cycles_per_deg))};
    return last.drive;
}

}  // namespace ripplenotch
