// SPDX-License-Identifier: MIT
#include "diagnose/case/case.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <string>

#include "diagnose/limits.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/detection.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/motions.hpp"

namespace ripplenotch {

namespace {

template <class Value>
std::vector<Value> picked(const std::vector<Value>& values, const std::vector<std::size_t>& rows) {
    std::vector<Value> some;
    some.reserve(rows.size());
    for (const std::size_t row : rows) some.push_back(values[row]);
    return some;
}

std::vector<std::size_t> every_nth_row(const Case& whole, std::size_t step) {
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < whole.size(); k += step) rows.push_back(k);
    return rows;
}

Case rows_of(const Case& whole, const std::vector<std::size_t>& rows, Hertz sample_rate) {
    const Motion& motion = whole.motion;
    Case some;
    some.motion = {sample_rate, picked(motion.time_s, rows), picked(motion.position_deg, rows),
                   picked(motion.velocity_deg_s, rows), picked(motion.acceleration_deg_s2, rows)};
    if (!motion.known_nm.empty()) some.motion.known_nm = picked(motion.known_nm, rows);
    for (const Nuisance& column : whole.uncertain)
        some.uncertain.push_back({picked(column.torque_nm, rows), column.usual_size});
    some.torque_nm = picked(whole.torque_nm, rows);
    some.row = picked(whole.row, rows);
    some.rough_deg_s2 = picked(whole.rough_deg_s2, rows);
    some.blunted_deg_s2 = picked(whole.blunted_deg_s2, rows);
    some.expected_delay = whole.expected_delay;
    some.walk_deg = whole.walk_deg;
    some.step_nm = whole.step_nm;
    some.moving_deg_s = whole.moving_deg_s;
    for (const std::size_t row : rows) {
        some.use.push_back(whole.use[row]);
        some.valid.push_back(whole.valid[row]);
        some.edge.push_back(whole.edge[row]);
    }
    some.from = {0};
    return some;
}

// Samples near the begin or end of a standstill (motion_along holds the speed at 0 there), some time to both
// sides.
std::vector<unsigned char> edges_of(const Motion& motion, double edge_s) {
    const auto reach = static_cast<std::size_t>(edge_s * motion.sample_rate.value()) + 1;
    const std::size_t n = motion.size();
    std::vector<unsigned char> edge(n, 0);
    for (std::size_t k = 1; k < n; ++k) {
        if ((motion.velocity_deg_s[k] == 0.0) == (motion.velocity_deg_s[k - 1] == 0.0)) continue;
        for (std::size_t i = k - std::min(k, reach); i < std::min(k + reach, n); ++i) edge[i] = 1;
    }
    return edge;
}

// Where the acceleration jumps, smoothing makes a slope of it, and the torque of the joint's inertia is not
// known there: such samples do not count.
void leave_out_kinks(Case& whole, Seconds smoothing) {
    std::vector<double> sizes;
    double most = 0.0;
    for (std::size_t k = 0; k < whole.size(); ++k) {
        sizes.push_back(std::abs(whole.blunted_deg_s2[k]));
        most = std::max(most, std::abs(whole.motion.acceleration_deg_s2[k]));
    }
    std::vector<double> sorted = sizes;
    const double kink = std::max(limits::recording::kink_deviations * 1.4826 * median_in(sorted),
                                 limits::recording::kink_part * most);
    const auto reach = static_cast<std::size_t>(0.5 * smoothing.value() * whole.motion.sample_rate.value());
    for (std::size_t k = 0; k < whole.size(); ++k) {
        if (sizes[k] <= kink) continue;
        for (std::size_t i = k - std::min(k, reach); i < std::min(k + reach + 1, whole.size()); ++i)
            whole.use[i] = 0;
    }
}

// A hundredth of the fastest speed of a slow joint is motion; of a fast one the limit stays, however fast.
double slowest_moving(const Motion& motion) {
    double fastest = 0.0;
    for (const double speed : motion.velocity_deg_s) fastest = std::max(fastest, std::abs(speed));
    return fastest > 0.0
               ? std::min(limits::recording::moving_most_deg_s, limits::recording::moving_part * fastest)
               : limits::recording::moving_most_deg_s;
}

}  // namespace

std::size_t Case::used() const {
    return static_cast<std::size_t>(
        std::count_if(use.begin(), use.end(), [](unsigned char u) { return u != 0; }));
}

Case whole_case(const TraceView& log, Seconds smoothing) {
    if (log.size() < fewest_samples_diagnosed)
        raise<DataError>("the log has {} rows; a diagnosis needs at least {}", log.size(),
                         fewest_samples_diagnosed);
    Case whole;
    whole.motion = motion_along(log, smoothing);
    const Motion smoother = motion_along(log, 3.0 * smoothing), sharper = motion_along(log, 0.5 * smoothing);
    whole.torque_nm.assign(log.torque_nm.begin(), log.torque_nm.end());
    whole.rough_deg_s2 = whole.motion.acceleration_deg_s2;
    whole.blunted_deg_s2 = sharper.acceleration_deg_s2;
    for (std::size_t k = 0; k < log.size(); ++k) {
        whole.rough_deg_s2[k] -= smoother.acceleration_deg_s2[k];
        whole.blunted_deg_s2[k] -= whole.motion.acceleration_deg_s2[k];
    }
    for (const double torque : log.torque_nm) whole.use.push_back(std::isfinite(torque) ? 1 : 0);
    for (double& torque : whole.torque_nm) torque = std::isfinite(torque) ? torque : 0.0;
    whole.from = {0};
    whole.row.resize(log.size());
    std::iota(whole.row.begin(), whole.row.end(), std::size_t{0});
    whole.moving_deg_s = slowest_moving(whole.motion);
    whole.edge = edges_of(whole.motion, limits::recording::edge_s);
    leave_out_kinks(whole, smoothing);
    whole.valid = whole.use;
    if (!log.has_position()) {
        double squares = 0.0;
        for (std::size_t k = 0; k < log.size(); ++k) {
            const double off = log.velocity_deg_s[k] - whole.motion.velocity_deg_s[k];
            squares += off * off;
        }
        whole.walk_deg = std::sqrt(squares / static_cast<double>(log.size()) / log.sample_rate.value());
    }
    return whole;
}

Case excerpt(const Case& whole) {
    const std::size_t stretch_samples = limits::recording::stretch_samples;
    if (whole.size() <= limits::recording::search_samples + stretch_samples) return whole;
    const std::size_t stretches = limits::recording::search_samples / stretch_samples;
    std::vector<std::size_t> rows, from;
    for (std::size_t s = 0; s < stretches; ++s) {
        const std::size_t begin = s * (whole.size() - stretch_samples) / (stretches - 1);
        from.push_back(rows.size());
        for (std::size_t k = 0; k < stretch_samples; ++k) rows.push_back(begin + k);
    }
    Case some = rows_of(whole, rows, whole.motion.sample_rate);
    some.from = from;
    for (const std::size_t begin : from)
        std::fill_n(some.use.begin() + static_cast<std::ptrdiff_t>(begin),
                    begin > 0 ? limits::recording::settling_samples : 0, 0);
    return some;
}

Case sketch(const Case& whole, std::size_t count) {
    const std::size_t step = std::max<std::size_t>(1, (whole.size() + count - 1) / count);
    return rows_of(whole, every_nth_row(whole, step),
                   Hertz(whole.motion.sample_rate.value() / static_cast<double>(step)));
}

namespace {

// Blocks of so many rows, of which the first and the last few do not count.
Case blocks_of(const Case& whole, std::size_t count, std::size_t length, std::size_t begin_rows) {
    const std::size_t all = whole.size();
    if (all <= count + length) return rows_of(whole, every_nth_row(whole, 1), whole.motion.sample_rate);
    const std::size_t number = count / length;
    std::vector<std::size_t> rows;
    for (std::size_t b = 0; b < number; ++b) {
        const std::size_t begin = b * (all - length) / (number - 1);
        for (std::size_t k = begin; k < begin + length; ++k) rows.push_back(k);
    }
    Case some = rows_of(whole, rows, whole.motion.sample_rate);
    // At the ends of a stretch a delay refers to samples of another one.
    for (std::size_t k = 0; k < some.size(); ++k) {
        const std::size_t within = k % length;
        if (within < begin_rows || within + limits::recording::block_end > length) some.use[k] = 0;
    }
    return some;
}

}  // namespace

Case blocks(const Case& whole, std::size_t count) {
    return blocks_of(whole, count, limits::recording::block_samples, limits::recording::block_begin);
}

Case long_blocks(const Case& whole, std::size_t count) {
    return blocks_of(whole, count, limits::recording::ringing_samples, limits::recording::ringing_begin);
}

bool carries_errors(const Term& term) {
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (term.effect->parameters[p].unit == "s" && term.values[p].value_or(0.0) < 0.0) return false;
    }
    return side_of(term) == Side::sensor;
}

std::vector<Nuisance> acceleration_errors(const Case& looked_at, const Model& model) {
    Model sensors{model.gear_ratio, {}};
    std::ranges::copy_if(model.terms, std::back_inserter(sensors.terms), carries_errors);
    return {{sensed_nm(sensors, looked_at.motion, looked_at.rough_deg_s2), 0.0},
            {sensed_nm(sensors, looked_at.motion, looked_at.blunted_deg_s2), 0.0}};
}

std::vector<Nuisance> uncertain_torques(const Case& looked_at, const Model& model) {
    std::vector<Nuisance> columns;
    for (const Nuisance& column : looked_at.uncertain)
        columns.push_back({sensed_nm(model, looked_at.motion, column.torque_nm), column.usual_size});
    return columns;
}

std::vector<Nuisance> walk_errors(const Case& looked_at, const Model& model) {
    std::vector<Nuisance> errors;
    if (looked_at.walk_deg == 0.0) return errors;
    // How the torque changes with the position: so little that it is a slope, and far above rounding.
    constexpr double shift_deg = 1e-4;
    Motion ahead = looked_at.motion, behind = looked_at.motion;
    for (double& position : ahead.position_deg) position += shift_deg;
    for (double& position : behind.position_deg) position -= shift_deg;
    const auto up = predict_nm(model, ahead), down = predict_nm(model, behind);
    // A random walk is a sum of sines of a quarter, three quarters, ... of a cycle with independent sizes
    // (Karhunen and Loeve).
    const auto& time_s = looked_at.motion.time_s;
    const double duration_s = time_s.back() - time_s.front();
    for (std::size_t mode = 1; mode <= limits::recording::walk_modes; ++mode) {
        const double quarter_turns = (static_cast<double>(mode) - 0.5) * std::numbers::pi;
        Nuisance walk{std::vector<double>(time_s.size()),
                      looked_at.walk_deg * std::sqrt(duration_s) * std::numbers::sqrt2 / quarter_turns};
        for (std::size_t k = 0; k < time_s.size(); ++k) {
            walk.torque_nm[k] = (up[k] - down[k]) / (2.0 * shift_deg) *
                                portable::sin(quarter_turns * (time_s[k] - time_s.front()) / duration_s);
        }
        errors.push_back(std::move(walk));
    }
    return errors;
}

std::vector<Nuisance> motion_errors(const Case& looked_at, const Model& model) {
    std::vector<Nuisance> errors = acceleration_errors(looked_at, model);
    for (Nuisance& column : uncertain_torques(looked_at, model)) errors.push_back(std::move(column));
    for (Nuisance& walk : walk_errors(looked_at, model)) errors.push_back(std::move(walk));
    return errors;
}

namespace {

// Step of a quantized log that was rounded once more, from the distances of neighbouring values: these differ
// from multiples of it by no more than the second rounding step. 0 when not so.
double rounded_step(const std::vector<double>& distances, double usual) {
    double shortest = usual, longest = usual, range = 0.0, steps = 0.0;
    for (const double distance : distances) {
        if (distance < 1.5 * usual) {  // one step, not two
            shortest = std::min(shortest, distance);
            longest = std::max(longest, distance);
        }
        range += distance;
        steps += std::round(distance / usual);
    }
    const double rounded_to = longest - shortest, step = range / steps;
    double value = 0.0, place = 0.0;
    // Coarser, it would leave no steps to be seen; chosen, not derived.
    bool in_place = rounded_to < 0.5 * usual;
    for (const double distance : distances) {
        value += distance;
        place += std::round(distance / step) * step;
        in_place = in_place && std::abs(value - place) <= rounded_to + 1e-9 * range;
    }
    return in_place ? step : 0.0;
}

// of the samples: a log with more distinct values than that is as good as continuous.
constexpr double most_distinct_part = 0.25;
// of the distance: rounding in a file leaves crumbs: distances this near to whole steps are whole steps.
constexpr double off_step_part = 0.02;
// %: so many distances have to be whole steps: rare levels leave multiples, other causes leave any distance.
constexpr std::size_t fitting_percent = 90;
// Step of a log that holds few distinct values at equal distances; 0 when it is as good as continuous.
double step_of(const std::vector<double>& torque_nm, double noise_nm) {
    std::vector<double> values = torque_nm;
    std::sort(values.begin(), values.end());
    std::vector<double> distances;
    const double range = values.back() - values.front();
    for (std::size_t k = 1; k < values.size(); ++k) {
        const double distance = values[k] - values[k - 1];
        if (distance > 1e-9 * range) distances.push_back(distance);
    }
    if (distances.empty() ||
        static_cast<double>(distances.size()) > most_distinct_part * static_cast<double>(values.size()))
        return 0.0;
    // The smallest that is common: rarer levels cause multiples of it, rounding causes tiny differences.
    const double step = median_of(distances);
    std::size_t fitting = 0;
    for (const double distance : distances) {
        const double steps = distance / step;
        if (std::abs(steps - std::round(steps)) < off_step_part * std::max(steps, 1.0) && steps > 0.5)
            ++fitting;
    }
    if (fitting >= distances.size() * fitting_percent / 100) return step;
    // Finer than the noise, such steps cannot be distinguished from values that happen to lie so.
    const double rounded = rounded_step(distances, step);
    return rounded >= step_of_noise * noise_nm ? rounded : 0.0;
}

double noise_of(const std::vector<double>& torque_nm) {
    // Second differences take motion and slow torque away; 6 is the sum of the squares of 1, -2, 1.
    std::vector<double> off;
    for (std::size_t k = 1; k + 1 < torque_nm.size(); ++k)
        off.push_back(std::abs(torque_nm[k - 1] - 2.0 * torque_nm[k] + torque_nm[k + 1]));
    return 1.4826 * median_of(off) / std::sqrt(6.0);
}

// Effects that can be detected in a log, in the order of their detectors.
std::vector<const Effect*> detectable() {
    std::vector<const Effect*> effects;
    for (const Effect* effect : catalogue()) {
        if (effect->detect != nullptr) effects.push_back(effect);
    }
    std::stable_sort(effects.begin(), effects.end(),
                     [](const Effect* a, const Effect* b) { return a->detect_turn < b->detect_turn; });
    return effects;
}

Fault fault_of(const Effect& effect, const DetectedFault& found, const Motion& motion) {
    Fault fault{{&effect, {}}, found.spoiled.size(), {}, found.words};
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        fault.term.values.emplace_back(std::clamp(found.values.at(p), parameter.lower, parameter.upper));
    }
    // Samples next to each other are one stretch, however their times are rounded.
    const double gap_s = 1.5 / motion.sample_rate.value();
    for (const std::size_t k : found.spoiled) {
        if (!fault.time_s.empty() && motion.time_s[k] - fault.time_s.back().to <= gap_s) {
            fault.time_s.back().to = motion.time_s[k];
        } else {
            fault.time_s.push_back({motion.time_s[k], motion.time_s[k]});
        }
    }
    return fault;
}

}  // namespace

std::vector<Fault> find_faults(Case& looked_at) {
    const double noise_nm = noise_of(looked_at.torque_nm);
    const LoggedTorque log{looked_at.motion,
                           looked_at.torque_nm,
                           looked_at.use,
                           looked_at.moving_deg_s,
                           step_of(looked_at.torque_nm, noise_nm),
                           noise_nm};
    std::vector<Fault> faults;
    for (const Effect* effect : detectable()) {
        const auto found = effect->detect(log);
        if (!found) continue;
        faults.push_back(fault_of(*effect, *found, looked_at.motion));
        for (const std::size_t k : found->spoiled) looked_at.use[k] = looked_at.valid[k] = 0;
        looked_at.step_nm = std::max(looked_at.step_nm, found->bends_nm);
    }
    return faults;
}

namespace {

using Bins = std::vector<double>;

// Mean square of the torque in each bin of a quantity; nothing is known of bins with few samples.
Bins power_by(const std::vector<double>& quantity, const std::vector<double>& torque_nm, double low,
              double high) {
    Bins power(limits::place::bins, 0.0), count(limits::place::bins, 0.0);
    const auto bins = static_cast<double>(limits::place::bins);
    for (std::size_t k = 0; k < quantity.size(); ++k) {
        const auto b = std::min(static_cast<std::size_t>((quantity[k] - low) / (high - low) * bins),
                                limits::place::bins - 1);
        power[b] += torque_nm[k] * torque_nm[k];
        count[b] += 1.0;
    }
    for (std::size_t b = 0; b < limits::place::bins; ++b)
        power[b] = count[b] > limits::place::fewest_in_bin ? power[b] / count[b] : 0.0;
    return power;
}

// Where along a quantity the rms of the torque is at least half of its largest; empty when that is nowhere in
// particular, or the quantity hardly changes.
std::vector<Span> spans_along(const std::vector<double>& quantity, const std::vector<double>& torque_nm,
                              double least_range) {
    const auto [low, high] = std::minmax_element(quantity.begin(), quantity.end());
    std::vector<Span> spans;
    if (!(*high - *low > least_range)) return spans;
    const Bins power = power_by(quantity, torque_nm, *low, *high);
    const double most = *std::max_element(power.begin(), power.end());
    const double bins = static_cast<double>(limits::place::bins), width = (*high - *low) / bins;
    std::size_t taken = 0;
    for (std::size_t b = 0; b < limits::place::bins; ++b) {
        if (power[b] < limits::place::large_power * most || most == 0.0) continue;
        ++taken;
        const double from = *low + static_cast<double>(b) * width;
        if (b > 0 && power[b - 1] >= limits::place::large_power * most)
            spans.back().to = from + width;
        else
            spans.push_back({from, from + width});
    }
    if (static_cast<double>(taken) > limits::place::most_bins * bins) spans.clear();
    return spans;
}

Direction direction_of(const Case& c, const std::vector<double>& torque_nm) {
    const std::vector<double>& velocity_deg_s = c.motion.velocity_deg_s;
    double moving[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}, rest = 0.0, rests = 0.0;
    for (std::size_t k = 0; k < velocity_deg_s.size(); ++k) {
        const double v = velocity_deg_s[k], power = torque_nm[k] * torque_nm[k];
        if (std::abs(v) < c.moving_deg_s) {
            rest += power;
            rests += 1.0;
        } else {
            moving[v > 0.0] += power;
            count[v > 0.0] += 1.0;
        }
    }
    const double up = count[1] > 0.0 ? moving[1] / count[1] : 0.0,
                 down = count[0] > 0.0 ? moving[0] / count[0] : 0.0;
    const double still = rests > 0.0 ? rest / rests : 0.0;
    if (still >= limits::place::large_power * std::max(up, down)) return Direction::at_rest_too;
    if (up > limits::place::one_way_power * down) return Direction::positive;
    return down > limits::place::one_way_power * up ? Direction::negative : Direction::both;
}

}  // namespace

Place place_of(const Case& c, const std::vector<double>& torque_nm, const Term& term) {
    Place place;
    place.time_s = spans_along(c.motion.time_s, torque_nm, 0.0);
    place.speed_deg_s =
        spans_along(c.motion.velocity_deg_s, torque_nm, limits::place::least_speeds * c.moving_deg_s);
    place.position_deg = spans_along(c.motion.position_deg, torque_nm, limits::place::least_travel_deg);
    place.direction = direction_of(c, torque_nm);
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (!term.values[p]) continue;
        if (term.effect->ripple_order == p && *term.values[p] > 0.0) place.order.push_back(*term.values[p]);
        if (term.effect->parameters[p].name == "frequency_hz") place.hz.push_back(*term.values[p]);
    }
    return place;
}

namespace {

Model joint_with(const Effect& effect, bool with) {
    Model model{GearRatio(100.0), {}};
    model.terms.push_back(parse_term("ripple,order=1,amplitude_nm=1,phase_deg=0"));
    if (!with) return model;
    model.terms.push_back({&effect, {}});
    for (const Parameter& parameter : effect.parameters) {
        const bool nothing_yet = parameter.linear && parameter.start == parameter.neutral;
        model.terms.back().values.emplace_back(nothing_yet ? parameter.neutral + 1.0 : parameter.start);
    }
    return model;
}

}  // namespace

bool needs_position(const Effect& effect) {
    // Another ratio or a bias shows in how the phase goes on, not in where it begins.
    if (effect.side == Side::converter || effect.side == Side::motion) return false;
    const Motion here = make_motion("poly6,from=0deg,to=200deg,duration=2s", Hertz(200.0));
    Motion there = here;
    const double turn_deg = 360.0 / 100.0;  // 3.6 deg of the motor
    for (double& position : there.position_deg) position += turn_deg;
    const Model with = joint_with(effect, true), without = joint_with(effect, false);
    const auto at_here = predict_nm(with, here), at_there = predict_nm(with, there);
    const auto plain_here = predict_nm(without, here), plain_there = predict_nm(without, there);
    double moved = 0.0, size = 0.0;
    for (std::size_t k = 0; k < here.size(); ++k) {
        const double one = at_here[k] - plain_here[k], other = at_there[k] - plain_there[k];
        moved = std::max(moved, std::abs(one - other));
        size = std::max(size, std::abs(one));
    }
    return moved > 1e-3 * size;
}

}  // namespace ripplenotch
