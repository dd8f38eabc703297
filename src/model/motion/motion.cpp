// SPDX-License-Identifier: MIT
#include "ripplenotch/model/motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/motion/local_motion.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Standstill: speeds within so many standard deviations of their noise, for so many smoothing windows. A
// joint that moves faster than the last of these is not at standstill, however noisy the log.
constexpr double rest_deviations = 4.5, rest_windows = 3.0, max_at_rest_deg_s = 0.5;

// Position and speed show the same motion when they differ by no more than this multiple of the difference
// expected from noise; estimated from the size that a fifth of the differences exceed, which kinks and gaps
// do not change.
constexpr double max_disagreement = 1.5, quantile = 0.8, deviations_at_quantile = 1.2816;
// A position cannot be trusted more than this relative to a speed, or rounding would count.
constexpr double min_noise_steps = 1e-3;

void check(const TraceView& log) {
    if (log.size() < LocalFit::fewest_samples) {
        raise<DataError>("the log has {} rows; a motion is measured from at least {}", log.size(),
                         LocalFit::fewest_samples);
    }
    if (!std::isfinite(log.time_s.front())) raise<DataError>("the log has no time; give its --sample-rate");
    for (std::size_t k = 1; k < log.size(); ++k) {
        if (log.time_s[k] > log.time_s[k - 1]) continue;
        raise<DataError>("time goes from {} to {} s after row {}; a motion needs times that increase",
                         shortest(log.time_s[k - 1]), shortest(log.time_s[k]), k);
    }
}

std::vector<double> integrated(const TraceView& log) {
    std::vector<double> position_deg(log.size(), 0.0);
    for (std::size_t k = 1; k < log.size(); ++k) {
        position_deg[k] = position_deg[k - 1] + 0.5 * (log.time_s[k] - log.time_s[k - 1]) *
                                                    (log.velocity_deg_s[k] + log.velocity_deg_s[k - 1]);
    }
    return position_deg;
}

// The window of each sample in turn.
class Windows {
  public:
    Windows(const TraceView& log, Seconds smoothing)
        : time_s_(log.time_s),
          // A millionth of a sample wider, so that rounding of the times does not decide which samples are
          // in.
          half_s_(0.5 * smoothing.value() + 1e-6 / log.sample_rate.value()) {}

    SampleWindow about(std::size_t k) {
        while (time_s_[k] - time_s_[first_] > half_s_) ++first_;
        while (end_ < time_s_.size() && time_s_[end_] - time_s_[k] <= half_s_) ++end_;
        if (end_ - first_ >= LocalFit::fewest_samples) return {first_, end_};
        constexpr std::size_t fewest = LocalFit::fewest_samples;
        const std::size_t first = std::min(k - std::min(k, fewest / 2), time_s_.size() - fewest);
        return {first, first + fewest};
    }

  private:
    std::span<const double> time_s_;
    double half_s_;
    std::size_t first_ = 0, end_ = 0;
};

// The smallest step of a signal, which is that of its encoder or of its decimals where it has one.
double resolution(std::span<const double> values) {
    double least = 0.0;
    for (std::size_t k = 1; k < values.size(); ++k) {
        const double step = std::abs(values[k] - values[k - 1]);
        if (step > 0.0 && (least == 0.0 || step < least)) least = step;
    }
    return least;
}

/// True where the position moves by no more than two of its steps, whatever the velocity says.
bool stands(const TraceView& log) {
    if (!log.has_position()) return false;
    const auto [low, high] = std::minmax_element(log.position_deg.begin(), log.position_deg.end());
    return *high - *low <= 2.0 * resolution(log.position_deg);
}

bool tell_the_same(const TraceView& log, Seconds smoothing, MotionNoise noise) {
    LocalFit by_velocity(log, {noise.velocity_deg_s, 0.0});
    // A velocity of next to no weight.
    LocalFit by_position(log, {1e6 * noise.velocity_deg_s, noise.position_deg});
    Windows windows(log, smoothing);
    std::vector<double> differences;
    for (std::size_t k = 0; k < log.size(); ++k) {
        const SampleWindow window = windows.about(k);
        if (k % std::max<std::size_t>(1, (window.end - window.first) / 4) != 0) continue;
        const double off =
            by_velocity.at(k, window).velocity_deg_s - by_position.at(k, window).velocity_deg_s;
        const double usual =
            portable::hypot(by_velocity.velocity_error(k, window), by_position.velocity_error(k, window));
        differences.push_back(std::abs(off) / usual);
    }
    const auto place = static_cast<std::ptrdiff_t>(quantile * static_cast<double>(differences.size() - 1));
    std::nth_element(differences.begin(), differences.begin() + place, differences.end());
    return differences[static_cast<std::size_t>(place)] <= max_disagreement * deviations_at_quantile;
}

// How far each signal is to be trusted. A position is of use where it has less noise than the speed's
// integral and shows the same motion: neither delayed nor from the other side of the gear.
MotionNoise noise_of(const TraceView& log, Seconds smoothing) {
    const double velocity_deg_s = sample_noise(log.velocity_deg_s);
    const MotionNoise alone{velocity_deg_s > 0.0 ? velocity_deg_s : 1.0, 0.0};
    if (!log.has_position() || velocity_deg_s == 0.0) return alone;
    const double position_deg =
        std::max({sample_noise(log.position_deg), resolution(log.position_deg) / std::sqrt(12.0),
                  min_noise_steps * velocity_deg_s / log.sample_rate.value()});
    const MotionNoise both{velocity_deg_s, position_deg};
    return tell_the_same(log, smoothing, both) ? both : alone;
}

// Ratio of the velocity's noise to the estimate from its fourth differences: coloured noise.
double slower_noise(const TraceView& log, const Motion& motion, MotionNoise noise) {
    double squares = 0.0;
    for (std::size_t k = 0; k < log.size(); ++k) {
        const double off = log.velocity_deg_s[k] - motion.velocity_deg_s[k];
        squares += off * off;
    }
    return std::sqrt(squares / static_cast<double>(log.size())) / noise.velocity_deg_s;
}

// Speeds up to these cannot be distinguished from zero. `error_deg_s`: rms error of each due to noise.
std::vector<double> still_speeds(const TraceView& log, Seconds smoothing, const Motion& motion,
                                 std::vector<double> error_deg_s, MotionNoise noise) {
    const bool both = noise.position_deg > 0.0;
    const double scale = rest_deviations * (both ? 1.0 : slower_noise(log, motion, noise));
    // A step of the encoder within the window, wherever it falls, looks like a speed of up to twice that.
    const double window_s =
        std::max(smoothing.value(), static_cast<double>(LocalFit::fewest_samples) / log.sample_rate.value());
    const double step_deg_s = both ? 2.0 * resolution(log.position_deg) / window_s : 0.0;
    for (double& error : error_deg_s)
        error = std::min(std::max(scale * error, step_deg_s), max_at_rest_deg_s);
    return error_deg_s;
}

// Speeds that cannot be distinguished from zero for long enough are standstill: there the joint has neither
// speed nor acceleration, and noise must not look like a motion back and forth.
void hold_rests(const TraceView& log, Seconds smoothing, const std::vector<double>& still_deg_s,
                Motion& motion) {
    for (std::size_t first = 0; first < log.size();) {
        std::size_t end = first;
        while (end < log.size() && std::abs(motion.velocity_deg_s[end]) <= still_deg_s[end]) ++end;
        if (end > first && log.time_s[end - 1] - log.time_s[first] >= rest_windows * smoothing.value()) {
            const auto from = static_cast<std::ptrdiff_t>(first),
                       count = static_cast<std::ptrdiff_t>(end - first);
            std::fill_n(motion.velocity_deg_s.begin() + from, count, 0.0);
            std::fill_n(motion.acceleration_deg_s2.begin() + from, count, 0.0);
        }
        first = std::max(end, first + 1);
    }
}

}  // namespace

Motion motion_along(const TraceView& log, Seconds smoothing) {
    check(log);
    Motion motion{.sample_rate = log.sample_rate,
                  .time_s = {log.time_s.begin(), log.time_s.end()},
                  .position_deg = {log.position_deg.begin(), log.position_deg.end()},
                  .velocity_deg_s = std::vector<double>(log.size()),
                  .acceleration_deg_s2 = std::vector<double>(log.size())};
    if (!log.has_position()) motion.position_deg = integrated(log);
    if (stands(log)) return motion;
    const MotionNoise noise = noise_of(log, smoothing);
    LocalFit fit(log, noise);
    Windows windows(log, smoothing);
    std::vector<double> error_deg_s(log.size());
    for (std::size_t k = 0; k < log.size(); ++k) {
        const SampleWindow window = windows.about(k);
        const LocalMotion here = fit.at(k, window);
        motion.velocity_deg_s[k] = here.velocity_deg_s;
        motion.acceleration_deg_s2[k] = here.acceleration_deg_s2;
        error_deg_s[k] = fit.velocity_error(k, window);
    }
    hold_rests(log, smoothing, still_speeds(log, smoothing, motion, std::move(error_deg_s), noise), motion);
    return motion;
}

}  // namespace ripplenotch
