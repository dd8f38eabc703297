// SPDX-License-Identifier: MIT
#include "diagnose/engine/recorded_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/functions/many_numbers.hpp"
#include "core/rows/row_facts.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/engine/gram.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {
namespace {

// Below this share of the rms speed for longer than this the joint is at standstill, where friction takes any
// value.
constexpr double standstill_speed_share = 0.01, standstill_s = 0.15;
constexpr std::size_t fewest_slots = 200;
constexpr double longest_gap = 2000.0;  // slots that a gap in the log takes at most: they hold nothing
// Travel in units of the noise of the position below which a joint stands still.
constexpr double least_travel = 30.0;

// rms speed and travel of robots' joints, within a factor of two to four.
constexpr double usual_speed_deg_s = 80.0, usual_travel_deg = 400.0;

double coarse_scale(double ratio) {
    return portable::pow(4.0,
                         std::max(0.0, std::nearbyint(0.5 * portable::log10(ratio) / portable::log10(2.0))));
}

// Sum of squares of third differences.
double roughness(std::span<const double> values) {
    double sum = 0.0;
    for (std::size_t k = 3; k < values.size(); ++k) {
        const double third = values[k] - 3.0 * values[k - 1] + 3.0 * values[k - 2] - values[k - 3];
        sum += third * third;
    }
    return sum;
}

double deviation_from_slots(std::span<const double> time_s, double rate_hz) {
    double sum = 0.0, squares = 0.0;
    for (const double t : time_s) {
        const double place = (t - time_s.front()) * rate_hz, off = place - std::nearbyint(place);
        sum += off;
        squares += off * off;
    }
    const double count = static_cast<double>(time_s.size());
    return squares / count - (sum / count) * (sum / count);
}

void place_rows(Clock& clock, std::span<const double> time_s) {
    double highest = 0.0;
    const double first = std::nearbyint((time_s.front() - clock.start_s) / clock.step_s);
    for (std::size_t row = 0; row < time_s.size(); ++row) {
        highest = std::max(highest, std::nearbyint((time_s[row] - clock.start_s) / clock.step_s) - first);
        clock.slot_of[row] = static_cast<std::size_t>(highest);
    }
    clock.slots = clock.slot_of.back() + 1;
}

// The line of time against slot, by least squares.
void fit_clock(Clock& clock, std::span<const double> time_s) {
    const double count = static_cast<double>(time_s.size());
    double mean_slot = 0.0, mean_s = 0.0, product = 0.0, square = 0.0;
    for (std::size_t row = 0; row < time_s.size(); ++row) {
        mean_slot += static_cast<double>(clock.slot_of[row]) / count;
        mean_s += time_s[row] / count;
    }
    for (std::size_t row = 0; row < time_s.size(); ++row) {
        const double slot = static_cast<double>(clock.slot_of[row]) - mean_slot;
        product += slot * (time_s[row] - mean_s);
        square += slot * slot;
    }
    clock.step_s = product / square;
    clock.start_s = mean_s - clock.step_s * mean_slot;
}

// Runs of samples for which `is` holds: act(first, end).
template <class Is, class Act>
void each_run(std::size_t count, Is is, Act act) {
    for (std::size_t k = 0; k < count; ++k) {
        if (!is(k)) continue;
        const std::size_t first = k;
        while (k < count && is(k)) ++k;
        act(first, k);
    }
}

}  // namespace

Clock regular_clock(std::span<const double> time_s) {
    const double usual_hz = 1.0 / usual_step_s(time_s);
    double best_hz = static_cast<double>(time_s.size() - 1) / (time_s.back() - time_s.front());
    double best = deviation_from_slots(time_s, best_hz);
    for (const double unit : {1.0, 10.0, 100.0}) {
        const double hz = unit * std::nearbyint(usual_hz / unit);
        if (hz <= 0.0) continue;
        const double off = deviation_from_slots(time_s, hz);
        if (off < best) best = off, best_hz = hz;
    }
    Clock clock;
    clock.step_s = 1.0 / best_hz;
    clock.start_s = time_s.front();
    clock.slot_of.resize(time_s.size());
    place_rows(clock, time_s);
    for (int pass = 0; pass < 3; ++pass) {
        fit_clock(clock, time_s);
        place_rows(clock, time_s);
    }
    return clock;
}

SmoothedSignal smooth_signal(std::span<const double> values, std::size_t window, double step_s) {
    const std::size_t count = values.size(), half = window / 2;
    double s0 = 0.0, s2 = 0.0, s4 = 0.0, s6 = 0.0;
    for (std::size_t i = 0; i < window; ++i) {
        const double x = static_cast<double>(i) - static_cast<double>(half), x2 = x * x;
        s0 += 1.0, s2 += x2, s4 += x2 * x2, s6 += x2 * x2 * x2;
    }
    const double even = s0 * s4 - s2 * s2, odd = s2 * s6 - s4 * s4;
    // Weights of the samples for the four coefficients of the cubic.
    std::array<std::vector<double>, 4> weights;
    for (std::size_t i = 0; i < window; ++i) {
        const double x = static_cast<double>(i) - static_cast<double>(half), x2 = x * x;
        weights[0].push_back((s4 - s2 * x2) / even);
        weights[1].push_back((s6 * x - s4 * x2 * x) / odd);
        weights[2].push_back((s0 * x2 - s2) / even);
        weights[3].push_back((s2 * x2 * x - s4 * x) / odd);
    }
    SmoothedSignal found;
    found.value.resize(count);
    found.slope_per_s.resize(count);
    found.curvature_per_s2.resize(count);
    const auto coefficients = [&](std::size_t centre) {
        std::array<double, 4> c{};
        // Differences from the middle keep their digits where a position is large.
        std::vector<double> local(window);
        for (std::size_t i = 0; i < window; ++i) local[i] = values[centre - half + i] - values[centre];
        for (std::size_t n = 0; n < 4; ++n) c[n] = dot(weights[n].data(), local.data(), window);
        c[0] += values[centre];
        return c;
    };
    const auto set = [&](std::size_t k, const std::array<double, 4>& c, double x) {
        found.value[k] = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
        found.slope_per_s[k] = (c[1] + x * (2.0 * c[2] + x * 3.0 * c[3])) / step_s;
        found.curvature_per_s2[k] = (2.0 * c[2] + 6.0 * x * c[3]) / (step_s * step_s);
    };
    for (std::size_t k = half; k + half < count; ++k) set(k, coefficients(k), 0.0);
    const auto first = coefficients(half), last = coefficients(count - 1 - half);
    for (std::size_t i = 1; i <= half; ++i) {
        set(half - i, first, -static_cast<double>(i));
        set(count - 1 - half + i, last, static_cast<double>(i));
    }
    return found;
}

std::vector<double> friction_loop(std::span<const double> position_deg, double width_deg) {
    std::vector<double> state(position_deg.size());
    for (std::size_t k = 1; k < state.size(); ++k)
        state[k] = -std::min(std::abs(position_deg[k] - position_deg[k - 1]) / width_deg, 700.0);
    portable::exp(state, state);
    double now = 0.0;
    for (std::size_t k = 0; k < state.size(); ++k) {
        const double step = k > 0 ? position_deg[k] - position_deg[k - 1] : 0.0;
        const double direction = step > 0.0 ? 1.0 : -1.0;
        if (step != 0.0) now = direction + (now - direction) * state[k];
        state[k] = now;
    }
    return state;
}

std::vector<double> gradient(std::span<const double> values, double step_s) {
    std::vector<double> slope(values.size());
    const std::size_t last = values.size() - 1;
    for (std::size_t k = 1; k < last; ++k) slope[k] = (values[k + 1] - values[k - 1]) / (2.0 * step_s);
    slope[0] = (values[1] - values[0]) / step_s;
    slope[last] = (values[last] - values[last - 1]) / step_s;
    return slope;
}

double rms_where(std::span<const double> values, std::span<const unsigned char> use) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (use[k] == 0) continue;
        sum += values[k] * values[k];
        count += 1.0;
    }
    return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

RecordedMotion::RecordedMotion(const TraceView& log, const std::optional<Simulation>& simulation)
    : log_(log) {
    if (log.size() < fewest_slots)
        raise<DataError>("a diagnosis needs at least {} samples, the log has {}", fewest_slots, log.size());
    const double usual_s = usual_step_s(log.time_s);
    double removed_s = 0.0;
    for (std::size_t row = 0; row < log.size(); ++row) {
        const double gap = row > 0 ? (log.time_s[row] - log.time_s[row - 1]) / usual_s : 0.0;
        if (gap > longest_gap) removed_s += usual_s * std::floor(gap - longest_gap);
        row_s_.push_back(log.time_s[row] - removed_s);
        removed_s_.push_back(removed_s);
    }
    clock_ = regular_clock(row_s_);
    std::vector<double> slot_s(clock_.slots), row_s(log.size());
    for (std::size_t k = 0; k < slot_s.size(); ++k) slot_s[k] = clock_.step_s * static_cast<double>(k);
    for (std::size_t row = 0; row < row_s.size(); ++row) row_s[row] = row_s_[row] - clock_.start_s;
    std::vector<double> position_deg(log.position_deg.begin(), log.position_deg.end());
    if (position_deg.empty()) {
        is_position_integrated_ = true;
        position_deg.assign(log.size(), 0.0);
        for (std::size_t row = 1; row < log.size(); ++row)
            position_deg[row] =
                position_deg[row - 1] + 0.5 * (log.velocity_deg_s[row] + log.velocity_deg_s[row - 1]) *
                                            (row_s_[row] - row_s_[row - 1]);
    }
    // The stamps may jitter more than the sampling does: the reading with the smoother positions counts.
    raw_position_deg_ = interpolate(row_s, position_deg, slot_s);
    for (std::size_t row = 0; row < row_s.size(); ++row)
        row_s[row] = clock_.step_s * static_cast<double>(clock_.slot_of[row]);
    const std::vector<double> by_slot = interpolate(row_s, position_deg, slot_s);
    counts_rows_ = roughness(by_slot) < roughness(raw_position_deg_);
    if (counts_rows_) raw_position_deg_ = by_slot;
    row_of_.resize(clock_.slots);
    recorded_.resize(clock_.slots);
    std::size_t row = 0;
    for (std::size_t k = 0; k < clock_.slots; ++k) {
        const auto off = [&](std::size_t of) { return std::abs(row_s_[of] - clock_.start_s - slot_s[k]); };
        while (row + 1 < log.size() && off(row + 1) <= off(row)) ++row;
        row_of_[k] = row;
        recorded_[k] = off(row) <= 0.75 * clock_.step_s ? 1 : 0;
    }
    if (simulation) {
        simulated_nm_ = on_clock(simulation->torque_nm);
        if (!simulation->velocity_deg_s.empty())
            simulated_velocity_deg_s_ = on_clock(simulation->velocity_deg_s);
        if (!simulation->position_deg.empty()) simulated_position_deg_ = on_clock(simulation->position_deg);
    }
    motion_.sample_rate = Hertz(1.0 / clock_.step_s);
    for (std::size_t k = 0; k < slot_s.size(); ++k) slot_s[k] += removed_s_[row_of_[k]];
    motion_.time_s = std::move(slot_s);
    mark_spoiled_rows(std::vector<unsigned char>(log.size(), 1));
}

std::vector<double> RecordedMotion::on_clock(std::span<const double> per_row) const {
    std::vector<double> places(log_.size()), slots(clock_.slots);
    for (std::size_t k = 0; k < slots.size(); ++k) slots[k] = static_cast<double>(k);
    for (std::size_t row = 0; row < places.size(); ++row)
        places[row] = counts_rows_ ? static_cast<double>(clock_.slot_of[row])
                                   : (row_s_[row] - clock_.start_s) / clock_.step_s;
    return interpolate(places, per_row, slots);
}

void RecordedMotion::mark_spoiled_rows(std::span<const unsigned char> is_good_row) {
    std::vector<double> places, torque, slots(clock_.slots);
    for (std::size_t k = 0; k < slots.size(); ++k) {
        slots[k] = static_cast<double>(k);
        if (is_good_row[row_of_[k]] == 0) recorded_[k] = 0;
    }
    for (std::size_t row = 0; row < log_.size(); ++row) {
        if (is_good_row[row] == 0) continue;
        places.push_back(counts_rows_ ? static_cast<double>(clock_.slot_of[row])
                                      : (row_s_[row] - clock_.start_s) / clock_.step_s);
        torque.push_back(log_.torque_nm[row]);
    }
    if (torque.empty()) raise<DataError>("no sample of the torque is that of the joint");
    torque_nm_ = interpolate(places, torque, slots);
}

void RecordedMotion::remove_velocity_bias(double bias_deg_s) {
    removed_bias_deg_s_ = bias_deg_s;
    for (std::size_t k = 0; k < size(); ++k)
        raw_position_deg_[k] -= bias_deg_s * (motion_.time_s[k] - motion_.time_s.front());
}

void RecordedMotion::set_others(std::span<const std::vector<double>> per_row_deg_s) {
    motion_.others_deg_s.clear();
    for (const auto& one : per_row_deg_s)
        motion_.others_deg_s.push_back(one.empty() ? std::vector<double>{} : on_clock(one));
}

void RecordedMotion::exclude(std::size_t first, std::size_t count) {
    std::fill_n(recorded_.begin() + static_cast<std::ptrdiff_t>(first), count, 0);
}

void RecordedMotion::smooth(double window_s) {
    const auto samples = static_cast<std::size_t>(window_s / clock_.step_s);
    const std::size_t window = std::max<std::size_t>(5, samples / 2 * 2 + 1);
    window_s_ = static_cast<double>(window) * clock_.step_s;
    SmoothedSignal smoothed = smooth_signal(raw_position_deg_, window, clock_.step_s);
    motion_.position_deg = std::move(smoothed.value);
    motion_.velocity_deg_s = std::move(smoothed.slope_per_s);
    motion_.acceleration_deg_s2 = std::move(smoothed.curvature_per_s2);
    refuse_standstill();
    if (!simulated_nm_.empty()) move_simulation();
    mark_usable(window);
    if (usable_count() < fewest_slots)
        raise<DataError>(
            "a diagnosis needs at least {} samples in motion, whose torque is that of the joint; "
            "the log has {}",
            fewest_slots, usable_count());
}

void RecordedMotion::refuse_standstill() const {
    double squares = 0.0;
    for (std::size_t k = 0; k < size(); ++k) {
        const double off = raw_position_deg_[k] - motion_.position_deg[k];
        squares += off * off;
    }
    const double noise_deg = std::sqrt(squares / static_cast<double>(size()));
    // The integral of a noise travels far.
    double speed = 0.0, noise = 0.0;
    const std::vector<double> raw_deg_s = gradient(raw_position_deg_, clock_.step_s);
    for (std::size_t k = 0; k < size() && is_position_integrated_; ++k) {
        const double off = raw_deg_s[k] - motion_.velocity_deg_s[k];
        speed += motion_.velocity_deg_s[k] * motion_.velocity_deg_s[k];
        noise += off * off;
    }
    if (!(travel_deg() > least_travel * noise_deg) || speed < noise)
        raise<DataError>("the joint stands still in this log: a diagnosis needs motion");
}

void RecordedMotion::mark_usable(std::size_t window) {
    usable_ = recorded_;
    const std::size_t count = usable_.size();
    // No motion is known near the ends of a gap.
    each_run(
        count, [&](std::size_t k) { return recorded_[k] == 0; },
        [&](std::size_t first, std::size_t end) {
            if (end - first <= 3) return;
            const std::size_t from = first - std::min(first, window), to = std::min(count, end + window);
            std::fill(usable_.begin() + static_cast<std::ptrdiff_t>(from),
                      usable_.begin() + static_cast<std::ptrdiff_t>(to), 0);
        });
    const auto& velocity = motion_.velocity_deg_s;
    const double rms_deg_s =
        std::sqrt(dot(velocity.data(), velocity.data(), count) / static_cast<double>(count));
    each_run(
        count, [&](std::size_t k) { return std::abs(velocity[k]) < standstill_speed_share * rms_deg_s; },
        [&](std::size_t first, std::size_t end) {
            if (static_cast<double>(end - first) * clock_.step_s <= standstill_s) return;
            std::fill(usable_.begin() + static_cast<std::ptrdiff_t>(first),
                      usable_.begin() + static_cast<std::ptrdiff_t>(end), 0);
        });
    const std::size_t margin = std::min(std::max<std::size_t>(window, 40), count / 4);
    std::fill_n(usable_.begin(), margin, 0);
    std::fill_n(usable_.rbegin(), margin, 0);
}

// The simulation ran along the command and the joint did not: its torque is regressed on its own motion, and
// the difference of this regression between both motions is added.
void RecordedMotion::move_simulation() {
    motion_.known_nm = simulated_nm_;
    if (simulated_velocity_deg_s_.empty() && simulated_position_deg_.empty()) return;
    constexpr std::size_t window = 9;
    std::vector<double> position, velocity, acceleration;
    if (simulated_position_deg_.empty()) {
        SmoothedSignal own = smooth_signal(simulated_velocity_deg_s_, window, clock_.step_s);
        velocity = std::move(own.value);
        acceleration = std::move(own.slope_per_s);
        double place = motion_.position_deg.front(), mean_gap = 0.0;
        for (std::size_t k = 0; k < size(); ++k) {
            place += velocity[k] * clock_.step_s;
            position.push_back(place);
            mean_gap += (motion_.position_deg[k] - place) / static_cast<double>(size());
        }
        for (double& value : position) value += mean_gap;
    } else {
        SmoothedSignal own = smooth_signal(simulated_position_deg_, window, clock_.step_s);
        position = std::move(own.value);
        velocity = std::move(own.slope_per_s);
        acceleration = std::move(own.curvature_per_s2);
    }
    const auto columns = [](const std::vector<double>& position_deg,
                            const std::vector<double>& velocity_deg_s,
                            const std::vector<double>& acceleration_deg_s2) {
        std::vector<std::vector<double>> made = {
            acceleration_deg_s2, velocity_deg_s, friction_loop(position_deg, 0.05),
            friction_loop(position_deg, 0.3), std::vector<double>(position_deg.size(), 1.0)};
        made.resize(7, std::vector<double>(position_deg.size()));
        portable::cos_degrees(position_deg, made[5]);
        portable::sin_degrees(position_deg, made[6]);
        return made;
    };
    const auto along_own = columns(position, velocity, acceleration);
    const auto along_measured =
        columns(motion_.position_deg, motion_.velocity_deg_s, motion_.acceleration_deg_s2);
    std::vector<unsigned char> use(size(), 1);
    std::fill_n(use.begin(), window, 0);
    std::fill_n(use.rbegin(), window, 0);
    const std::vector<double> factors = regress(along_own, simulated_nm_, use);
    for (std::size_t c = 0; c < factors.size(); ++c) {
        add_scaled(factors[c], along_measured[c].data(), motion_.known_nm.data(), size());
        add_scaled(-factors[c], along_own[c].data(), motion_.known_nm.data(), size());
    }
}

std::size_t RecordedMotion::usable_count() const {
    return static_cast<std::size_t>(std::count(usable_.begin(), usable_.end(), 1));
}

double RecordedMotion::travel_deg() const {
    const auto [low, high] = std::minmax_element(motion_.position_deg.begin(), motion_.position_deg.end());
    return *high - *low;
}

double RecordedMotion::speed_scale() const {
    const auto& velocity = motion_.velocity_deg_s;
    return coarse_scale(
        std::sqrt(dot(velocity.data(), velocity.data(), size()) / static_cast<double>(size())) /
        usual_speed_deg_s);
}

double RecordedMotion::angle_scale() const { return coarse_scale(travel_deg() / usual_travel_deg); }

double RecordedMotion::fastest_deg_s() const {
    double fastest = 0.0;
    for (const double v : motion_.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    return fastest;
}

}  // namespace ripplenotch::engine
