// SPDX-License-Identifier: MIT
#include "diagnose/plan/fourier_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

// The acceleration at both ends is 0 where the sums of k s_k over odd and over even k are.
void begin_gently(std::vector<double>& speeds) {
    for (const std::size_t first : {std::size_t{0}, std::size_t{1}}) {
        double sum = 0.0, weights = 0.0;
        for (std::size_t k = first; k < speeds.size(); k += 2) {
            const double waves = static_cast<double>(k + 1);
            sum += waves * speeds[k];
            weights += waves * waves;
        }
        for (std::size_t k = first; k < speeds.size(); k += 2)
            speeds[k] -= sum * static_cast<double>(k + 1) / weights;
    }
}

std::string fourier_words(const std::vector<double>& speeds, double duration_s) {
    std::string words = "fourier,speeds=";
    for (std::size_t k = 0; k < speeds.size(); ++k)
        words += fmt::format("{}{}deg/s", k == 0 ? "" : ":", shortest(speeds[k]));
    return words + fmt::format(",duration={}s", shortest(duration_s));
}

double largest_size(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

}  // namespace

FourierMotion drawn(Noise& noise) {
    FourierMotion motion;
    for (std::size_t k = 0; k < planned_waves; ++k) motion.speeds_deg_s.push_back(noise.normal());
    motion.place = noise.uniform();
    return motion;
}

FourierMotion moved(const FourierMotion& motion, double step, Noise& noise) {
    FourierMotion other = motion;
    const double size = largest_size(motion.speeds_deg_s);
    for (double& speed : other.speeds_deg_s) speed += step * size * noise.normal();
    other.place = std::clamp(motion.place + step * noise.normal(), 0.0, 1.0);
    return other;
}

std::vector<std::string> within(const FourierMotion& motion, const MotionLimits& limits, Seconds duration) {
    constexpr double within_limits = 0.999, sampled_hz = 200.0;
    const double moves_s = duration.value() - 2.0 * planned_rest_s;
    std::vector<double> speeds = motion.speeds_deg_s;
    begin_gently(speeds);
    const Motion raw = make_motion(fourier_words(speeds, moves_s), Hertz(sampled_hz));
    const auto [low, high] = std::minmax_element(raw.position_deg.begin(), raw.position_deg.end());
    const double room_deg = limits.highest_deg - limits.lowest_deg;
    const double scale =
        within_limits * std::min({limits.speed_deg_s / largest_size(raw.velocity_deg_s),
                                  limits.acceleration_deg_s2 / largest_size(raw.acceleration_deg_s2),
                                  room_deg / (*high - *low)});
    for (double& speed : speeds) speed = to_digits(scale * speed, 6);
    const double free_deg = room_deg - scale * (*high - *low);
    const double from_deg = to_digits(limits.lowest_deg + motion.place * free_deg - scale * *low, 6);
    return {fmt::format("rest,duration={}s,from={}deg", shortest(planned_rest_s), shortest(from_deg)),
            fourier_words(speeds, moves_s), fmt::format("rest,duration={}s", shortest(planned_rest_s))};
}

}  // namespace ripplenotch
