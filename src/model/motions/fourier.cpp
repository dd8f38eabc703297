// SPDX-License-Identifier: MIT
#include <numbers>
#include <vector>

#include "model/motions.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr Key keys[] = {
    {.name = "speeds",
     .kind = KeyKind::list,
     .dimension = Dimension::speed,
     .required = true,
     .at_least = -largest_speed_deg_s,
     .at_most = largest_speed_deg_s,
     .help = "sizes of the half-waves that the speed is made of, the slowest first, parted by a colon"},
    duration_key,
    from_key,
};

MotionPiece make(const Settings& settings, const std::optional<MotionState>& before) {
    const std::vector<double> speeds = settings.list("speeds");
    constexpr std::size_t most_waves = 100;  // chosen, not derived: bounds the time
    if (speeds.size() > most_waves)
        raise<UsageError>("motion fourier: speeds has {} entries, at most {} are taken", speeds.size(),
                          most_waves);
    const double from_deg = start_position_deg("fourier", settings, before);
    const double duration_s = settings.number("duration");
    return {Seconds(duration_s), [=](Seconds elapsed) {
                MotionState state{.position_deg = from_deg};
                for (std::size_t k = 0; k < speeds.size(); ++k) {
                    const double half_turns = static_cast<double>(k + 1);
                    const double angle_deg = 180.0 * half_turns * elapsed.value() / duration_s;
                    const double rad_s = std::numbers::pi * half_turns / duration_s;
                    const double cosine = portable::cos_degrees(angle_deg);
                    state.position_deg += speeds[k] / rad_s * (1.0 - cosine);
                    state.velocity_deg_s += speeds[k] * portable::sin_degrees(angle_deg);
                    state.acceleration_deg_s2 += speeds[k] * rad_s * cosine;
                }
                return state;
            }};
}

}  // namespace

const MotionKind motions::fourier{
    .name = "fourier",
    .summary = "from rest to rest by any sum of half-waves of the speed",
    .equation =
        "q(t) = from + sum over k = 1 ... of s_k * T / (pi * k) * (1 - cos(180deg * k * t / T)), T = "
        "duration",
    .source =
        "Swevers et al., IEEE Transactions on Robotics and Automation 13, 1997, for exciting motions of such "
        "sums",
    .keys = keys,
    .make = make,
};

}  // namespace ripplenotch
