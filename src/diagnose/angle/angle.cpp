// SPDX-License-Identifier: MIT
#include "diagnose/angle/angle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/vectors/dot.hpp"
#include "diagnose/case/case.hpp"
#include "diagnose/case/known_torque.hpp"
#include "diagnose/case/lines.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/search.hpp"
#include "model/fit/weighing.hpp"
#include "model/motion/local_motion.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

namespace {

/// The iterations of the estimate, each from the result of the one before.
constexpr int walk_steps = 3;

Motion moved_by_walk(Motion motion, double by_deg) {
    for (double& position : motion.position_deg) position += by_deg;
    return motion;
}

std::vector<double> left_of_stated(const Case& looked_at, const Model& stated, const Motion& motion) {
    std::vector<double> left = predict_nm(stated, motion);
    for (std::size_t k = 0; k < left.size(); ++k)
        left[k] = looked_at.use[k] != 0 ? looked_at.torque_nm[k] - left[k] : 0.0;
    return left;
}

// Less its moving average over some tenths of a second: slow or constant torque carries no information on a
// ripple's phase, and effects that are not named yet are mostly slow.
std::vector<double> quick_part(const std::vector<double>& values, double rate_hz, double window_s) {
    const auto half = static_cast<std::size_t>(0.5 * window_s * rate_hz) + 1;
    std::vector<double> sum{0.0}, quick(values.size());
    for (const double value : values) sum.push_back(sum.back() + value);
    for (std::size_t k = 0; k < values.size(); ++k) {
        const std::size_t first = k - std::min(k, half), end = std::min(k + half + 1, values.size());
        quick[k] = values[k] - (sum[end] - sum[first]) / static_cast<double>(end - first);
    }
    return quick;
}

/// Changes of the position, their standard deviations, and the torque due to each.
struct Walk {
    std::vector<std::vector<double>> position_deg, torque_nm;
    std::vector<double> deviation;
};

// The sines of the Karhunen-Loeve expansion of a random walk, as in motion_errors().
std::vector<double> sine_of(const std::vector<double>& time_s, std::size_t mode) {
    const double quarter_turns = (static_cast<double>(mode) - 0.5) * std::numbers::pi;
    const double duration_s = time_s.back() - time_s.front();
    std::vector<double> sine;
    for (const double time : time_s)
        sine.push_back(portable::sin(quarter_turns * (time - time_s.front()) / duration_s));
    return sine;
}

// Sensor noise in the quick part is independent from sample to sample. The rest is coherent over the window:
// an effect without a name, a lag for one, turns the ripple's phase with the speed, and must not pass for a
// random-walk error.
double quick_noise_of(const Case& looked_at, const std::vector<double>& quick, double window_s) {
    const double white_nm = sample_noise(looked_at.torque_nm);
    const double square = dot(quick.data(), quick.data(), quick.size()) /
                          static_cast<double>(std::max<std::size_t>(looked_at.used(), 1));
    const double coherent = window_s * looked_at.motion.sample_rate.value();
    return std::sqrt(square + coherent * std::max(square - white_nm * white_nm, 0.0));
}

// At which another log is tried: a cosine is met within an eighth of its period, from where a slope leads to
// its top.
std::size_t places_a_turn(const StatedRipple& ripple) {
    constexpr double places_a_period = 8.0;
    double highest = 1.0;
    for (const double order : ripple.orders) highest = std::max(highest, order);
    return static_cast<std::size_t>(std::ceil(places_a_period * highest));
}

double grid_deg(const Model& stated) {
    const StatedRipple ripple = stated_ripple(stated);
    return 360.0 / ripple.ratio.value() / static_cast<double>(places_a_turn(ripple));
}

Walk walk_of(const Case& looked_at, const Model& stated, WalkOf of) {
    Walk walk;
    const auto& time_s = looked_at.motion.time_s;
    if (of == WalkOf::other_log) {
        walk.position_deg.emplace_back(time_s.size(), 1.0);
        walk.deviation.push_back(grid_deg(stated));
    }
    const double usual_deg = looked_at.walk_deg * std::sqrt(time_s.back() - time_s.front());
    for (std::size_t mode = 1; usual_deg > 0.0 && mode <= limits::recording::walk_modes; ++mode) {
        walk.position_deg.push_back(sine_of(time_s, mode));
        walk.deviation.push_back(usual_deg * std::numbers::sqrt2 /
                                 ((static_cast<double>(mode) - 0.5) * std::numbers::pi));
    }
    // How the torque changes with the position: so little that it is a slope, and far above rounding.
    constexpr double shift_deg = 1e-4;
    const auto up = predict_nm(stated, moved_by_walk(looked_at.motion, shift_deg));
    const auto down = predict_nm(stated, moved_by_walk(looked_at.motion, -shift_deg));
    for (const auto& position : walk.position_deg) {
        std::vector<double> torque(position.size(), 0.0);
        for (std::size_t k = 0; k < torque.size(); ++k) {
            if (looked_at.use[k] != 0) torque[k] = (up[k] - down[k]) / (2.0 * shift_deg) * position[k];
        }
        walk.torque_nm.push_back(std::move(torque));
    }
    return walk;
}

// Derivatives of the torque with respect to the values that are fitted together with the random walk.
void add_walk_slopes(Walk& walk, const Case& looked_at, const Model& open, const Model& stated) {
    const Prediction prediction(stated, looked_at.motion);
    const Coordinates coordinates(open, &stated);
    std::vector<double> point;
    for (const Coordinate& coordinate : coordinates.list()) point.push_back(coordinate.start);
    for (std::size_t c = 0; c < point.size(); ++c) {
        std::vector<double> slope = slope_nm(prediction, coordinates, point, c);
        for (std::size_t k = 0; k < slope.size(); ++k) slope[k] = looked_at.use[k] != 0 ? slope[k] : 0.0;
        walk.torque_nm.push_back(std::move(slope));
        walk.deviation.push_back(any_size);
    }
}

// `window_s`: squares of the quick part; 0: of everything.
double squares_left(const Case& looked_at, const Model& stated, double by_deg, double window_s) {
    auto left = left_of_stated(looked_at, stated, moved_by_walk(looked_at.motion, by_deg));
    if (window_s > 0.0) left = quick_part(left, looked_at.motion.sample_rate.value(), window_s);
    return dot(left.data(), left.data(), left.size());
}

bool goes_with_output(const Model& stated) {
    return std::any_of(stated.terms.begin(), stated.terms.end(),
                       [](const Term& term) { return needs_position(*term.effect); });
}

// The first of the best among `count` positions, a step apart. By the quick part, or with 0 by everything.
double best_place(const Case& other, const Model& stated, double step_deg, std::size_t count,
                  double window_s) {
    double best = 0.0, least = squares_left(other, stated, 0.0, window_s);
    for (std::size_t i = 1; i < count; ++i) {
        const double place = step_deg * static_cast<double>(i);
        const double squares = squares_left(other, stated, place, window_s);
        if (squares >= least) continue;
        least = squares;
        best = place;
    }
    return best;
}

// One iteration: moves the position of a case by the random-walk error estimated from the torque, together
// with the values that `open` leaves out and `stated` has: by the sines of motion_errors(), drawn to their
// usual sizes, and for another log by a constant. A case without a random walk is moved by the constant
// alone, the log itself not at all.
void step_of_walk(Case& looked_at, const Model& open, const Model& stated, WalkOf of) {
    Walk walk = walk_of(looked_at, stated, of);
    if (walk.position_deg.empty()) return;
    if (of == WalkOf::log) add_walk_slopes(walk, looked_at, open, stated);
    const double rate_hz = looked_at.motion.sample_rate.value();
    for (auto& torque : walk.torque_nm)
        torque = quick_part(torque, rate_hz, limits::recording::angle_window_s);
    const auto left = quick_part(left_of_stated(looked_at, stated, looked_at.motion), rate_hz,
                                 limits::recording::angle_window_s);
    const auto sizes = Ridge(walk.torque_nm, walk.deviation,
                             quick_noise_of(looked_at, left, limits::recording::angle_window_s))
                           .solve(left);
    std::vector<double> change(looked_at.size(), 0.0);
    for (std::size_t i = 0; i < walk.position_deg.size(); ++i)
        add_scaled(sizes[i], walk.position_deg[i].data(), change.data(), change.size());
    add_scaled(1.0, change.data(), looked_at.motion.position_deg.data(), change.size());
}

}  // namespace

void take_out_walk(Case& looked_at, const Model& open, const Model& stated, WalkOf of) {
    for (int step = 0; step < walk_steps; ++step) step_of_walk(looked_at, open, stated, of);
}

void put_in_place(Case& other, const Model& stated) {
    const StatedRipple ripple = stated_ripple(stated);
    if (ripple.orders.empty() && !goes_with_output(stated)) return;
    const double turn_deg = 360.0 / ripple.ratio.value();
    const auto settle = [&](double place_deg) {
        other.motion = moved_by_walk(std::move(other.motion), place_deg);
        take_out_walk(other, stated, stated, WalkOf::other_log);
    };
    settle(best_place(other, stated, grid_deg(stated), places_a_turn(ripple),
                      limits::recording::angle_window_s));
    if (!goes_with_output(stated)) return;
    const auto turns = static_cast<std::size_t>(std::max(1.0, std::round(ripple.ratio.value())));
    settle(best_place(other, stated, turn_deg, turns, 0.0));
}

bool tells_position(const Motion& motion) {
    double forth = 0.0, back = 0.0;
    for (std::size_t k = 1; k < motion.size(); ++k) {
        const double by = motion.position_deg[k] - motion.position_deg[k - 1];
        (by > 0.0 ? forth : back) += std::abs(by);
    }
    const auto [low, high] = std::minmax_element(motion.position_deg.begin(), motion.position_deg.end());
    return std::min(forth, back) > limits::recording::least_turned_deg &&
           *high - *low >= limits::recording::least_span_deg;
}

namespace {

struct Moved {
    double mean_deg = 0.0, rms_deg = 0.0;  ///< rms: about the mean
};

Moved moved_by(const std::vector<double>& before, const std::vector<double>& after) {
    Moved moved;
    double squares = 0.0;
    const auto n = static_cast<double>(before.size());
    for (std::size_t k = 0; k < before.size(); ++k) {
        const double by = after[k] - before[k];
        moved.mean_deg += by / n;
        squares += by * by / n;
    }
    moved.rms_deg = std::sqrt(std::max(squares - moved.mean_deg * moved.mean_deg, 0.0));
    return moved;
}

}  // namespace

void straighten(Case& whole, const Model& model) {
    for (int step = 0; step < walk_steps; ++step) {
        Work free(limits::search::most_evaluations);
        ModelBench rough(whole, {1.0, 1.0, {}}, free);
        const Candidate fitted = baseline(rough, model);
        step_of_walk(whole, fitted.open, fitted.stated, WalkOf::log);
    }
}

bool straightened_by(Case& whole, const Candidate& found, double floor_nm) {
    std::vector<double> change = predict_nm(found.stated, whole.motion);
    take_out_walk(whole, found.open, found.stated, WalkOf::log);
    const std::vector<double> now = predict_nm(found.stated, whole.motion);
    for (std::size_t k = 0; k < now.size(); ++k) change[k] -= now[k];
    return rms(change) > material_sigma(whole) * floor_nm;
}

AngleBefore::AngleBefore(const Case& log, bool has_position) {
    if (!has_position) log_ = log.motion.position_deg;
}

std::optional<AngleAccount> AngleBefore::account(const Case& log, const Case* other) const {
    if (log_.empty() && other_.empty()) return std::nullopt;
    AngleAccount account;
    if (!log_.empty()) account.walk_deg = moved_by(log_, log.motion.position_deg).rms_deg;
    if (!other_.empty() && other->motion.position_deg != other_)
        account.validation_start_deg = other->motion.position_deg.front();
    return account;
}

}  // namespace ripplenotch
