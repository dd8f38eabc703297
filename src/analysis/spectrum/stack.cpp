// SPDX-License-Identifier: MIT
#include "analysis/spectrum/stack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "analysis/spectrum/fourier.hpp"
#include "core/functions/many_numbers.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/analysis/stack.hpp"
#include "ripplenotch/analysis/steady.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

/// A clock counts as even when no sample is off it by more than this share of a step: then the plain
/// transform is the same sum.
constexpr double even_share = 1e-3;
constexpr double most_steps = 3.0;       // longest interval of one sample, next to a gap
constexpr std::size_t most_ahead = 8;    // pieces; those of usual lengths stay in the processor's cache
constexpr std::size_t side_by_side = 8;  // sums, so that an addition need not wait for the one before

using Sums = std::array<double, side_by_side>;

double total(const Sums& sums) { return std::accumulate(sums.begin(), sums.end(), 0.0); }

/// Angle whose cosine the window contains; position and length in the same unit.
double hann_angle(double place, double length) { return 2.0 * std::numbers::pi * place / length; }

double hann(double place, double length) { return 0.5 + 0.5 * portable::cos(hann_angle(place, length)); }

void remove_line(std::span<const double> t, std::vector<double>& x) {
    const auto n = static_cast<double>(x.size());
    const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
    const double t_mean = std::accumulate(t.begin(), t.end(), 0.0) / n;
    double tt = 0.0, tx = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        tt += (t[k] - t_mean) * (t[k] - t_mean);
        tx += (t[k] - t_mean) * (x[k] - mean);
    }
    const double slope = tt > 0.0 ? tx / tt : 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] -= mean + slope * (t[k] - t_mean);
}

}  // namespace

EvenPart look_at_even(std::span<const double> time, std::span<const double> values, double step,
                      std::size_t from) {
    const std::size_t n = time.size();
    const double begin = n > from ? time[0] : 0.0;
    const double middle = 0.5 * (static_cast<double>(n + from) - 1.0);
    Sums worst{}, sums{}, tilts{};
    const auto look = [&](std::size_t k, std::size_t i) {
        const auto at = static_cast<double>(k);
        const double off = std::abs(time[k] - begin - at * step);
        worst[i] = worst[i] < off ? off : worst[i];
        sums[i] += values[k];
        tilts[i] += (at - middle) * values[k];
    };
    std::size_t k = from;
    for (; k + side_by_side <= n; k += side_by_side)
        for (std::size_t i = 0; i < side_by_side; ++i) look(k + i, i);
    for (std::size_t i = 0; k + i < n; ++i) look(k + i, i);
    return {*std::max_element(worst.begin(), worst.end()), total(sums), total(tilts), n - from};
}

EvenPart together(const EvenPart& early, const EvenPart& late) {
    const auto before = static_cast<double>(early.count), behind = static_cast<double>(late.count);
    // Each part's middle lies half the other part away from the middle of both.
    return {std::max(early.worst, late.worst), early.sum + late.sum,
            early.tilt - 0.5 * behind * early.sum + late.tilt + 0.5 * before * late.sum,
            early.count + late.count};
}

EvenLine even_line(const EvenPart& values) {
    const auto count = static_cast<double>(values.count);
    const double squares = count * (count * count - 1.0) / 12.0;
    return {values.sum / count, squares > 0.0 ? values.tilt / squares : 0.0};
}

void subtract_line_and_window(std::span<const double> values, const EvenLine& line,
                              std::span<const double> window, std::span<double> to) {
    const double middle = 0.5 * (static_cast<double>(values.size()) - 1.0);
    for (std::size_t k = 0; k < values.size(); ++k)
        to[k] = (values[k] - ((static_cast<double>(k) - middle) * line.slope + line.mean)) * window[k];
}

PieceMaker::PieceMaker(std::size_t length, Hertz rate)
    : length_(length),
      hop_(std::max<std::size_t>(1, length / 2)),
      rate_(rate.value()),
      step_s_(1.0 / rate.value()),
      transform_(length) {
    const double middle = 0.5 * (static_cast<double>(length) - 1.0);
    even_time_s_.resize(length);
    even_window_.resize(length);
    for (std::size_t k = 0; k < length; ++k) {
        const double place = static_cast<double>(k) - middle;
        even_time_s_[k] = place * step_s_;
        even_window_[k] = hann_angle(place, static_cast<double>(length));
    }
    portable::cos(even_window_, even_window_);
    for (double& weight : even_window_) {
        weight = 0.5 + 0.5 * weight;
        even_sum_ += weight;
        even_square_sum_ += weight * weight;
    }
}

const Piece& PieceMaker::make(std::span<const double> time_s, std::span<const double> torque_nm) {
    const EvenPart both = look_at(time_s, torque_nm);
    piece_.middle_s = 0.5 * (time_s.front() + time_s.back());
    worst_s_ = std::max(worst_s_, both.worst);
    piece_.even = both.worst <= even_share * step_s_;
    if (piece_.even) {
        make_even(torque_nm, even_line(both));
    } else {
        late_.reset();
        make_uneven(time_s, torque_nm);
    }
    return piece_;
}

// Samples are read from memory much faster in one long go than between transforms.
void PieceMaker::look_ahead(std::span<const double> time_s, std::span<const double> torque_nm) {
    const std::size_t pieces = std::min(most_ahead, (time_s.size() - length_) / hop_ + 1);
    ahead_.resize(pieces);
    for (std::size_t k = 0; k < pieces; ++k) {
        ahead_[pieces - 1 - k] = look_at_even(time_s.subspan(k * hop_, length_),
                                              torque_nm.subspan(k * hop_, length_), step_s_, length_ / 2);
    }
}

EvenPart PieceMaker::look_at(std::span<const double> time_s, std::span<const double> torque_nm) {
    const std::size_t half = length_ / 2;
    // The result for an even piece is reused; its own beginning may be as far off as that, no more.
    const bool seen = late_ && late_->count == half;
    const EvenPart early = seen ? *late_ : look_at_even(time_s.first(half), torque_nm.first(half), step_s_);
    late_ = ahead_.back();
    ahead_.pop_back();
    return together(early, *late_);
}

void PieceMaker::make_even(std::span<const double> torque_nm, const EvenLine& line) {
    subtract_line_and_window(torque_nm, line, even_window_, transform_.in());
    piece_.time_s = even_time_s_;
    piece_.value = transform_.in();
    piece_.window_sum = even_sum_;
    piece_.window_square_sum = even_square_sum_;
}

void PieceMaker::make_uneven(std::span<const double> time_s, std::span<const double> torque_nm) {
    const std::size_t n = torque_nm.size();
    const double length_s = static_cast<double>(n) * step_s_;
    time_s_.resize(n);
    value_.assign(torque_nm.begin(), torque_nm.end());
    for (std::size_t k = 0; k < n; ++k) time_s_[k] = time_s[k] - piece_.middle_s;
    remove_line(time_s_, value_);
    piece_.window_sum = piece_.window_square_sum = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
        // Each sample stands for the time around it. Were all alike, a clock that stumbles in a pattern would
        // make lines of that pattern out of the slow motion, a hundred times stronger than any ripple.
        const double before = time_s_[k > 0 ? k - 1 : k], after = time_s_[std::min(k + 1, n - 1)];
        const double share = std::clamp(0.5 * (after - before) / step_s_, 0.0, most_steps);
        const double window = share * hann(time_s_[k], length_s);
        value_[k] *= window;
        piece_.window_sum += window;
        piece_.window_square_sum += window * window;
    }
    piece_.time_s = time_s_;
    piece_.value = value_;
}

bool PieceMaker::even_at(Hertz rate) const {
    // A grid with other steps is off by so much more at the end of a piece.
    const double step = 1.0 / rate.value(), drift = std::abs(step - step_s_) * static_cast<double>(length_);
    return (worst_s_ + drift) * (1.0 + 1e-9) <= even_share * std::min(step, step_s_);
}

std::span<const std::complex<double>> PieceMaker::sums() {
    if (piece_.even) return transform_.run();
    uneven_sums_ = nonuniform_fourier(piece_.time_s, piece_.value, rate_ / static_cast<double>(length_),
                                      length_ / 2 + 1);
    return uneven_sums_;
}

void PieceMaker::add_power(double scale, std::span<double> power) {
    const auto of_piece = sums();
    for (std::size_t k = 0; k < of_piece.size(); ++k)
        power[k] +=
            scale * (of_piece[k].real() * of_piece[k].real() + of_piece[k].imag() * of_piece[k].imag());
}

namespace {

constexpr std::size_t most_parts = 4;  // chosen, not derived: each holds five sums a bin
constexpr double overlap_correlation =
    1.06;  // half-overlapping Hann pieces count a little less than independent ones

constexpr double smeared_cells = 20.0;  // chosen, not derived
// Chosen, not derived: multiple of the sample rate at the highest speed.
constexpr double folds_searched = 2.5;
constexpr double used_cycles = 3.0;         // in a sweep: half a cycle beyond what the trend follows
constexpr double fewest_sweep_cells = 6.0;  // cells in a sweep's spectrum: a line's main lobe and four more

struct Reach {
    std::size_t first = 0, end = 0;  // bins
};

/// The speeds of all sweeps: lower and upper quartile of the slowest and of the quickest.
struct Speeds {
    double slow_deg_s = 1e300, quick_deg_s = 0.0;
};

/// The order at which the sample rate stands at the sweep's highest speed, and short of it: the motion, far
/// stronger than any line, folds to there.
double clear_of_motion(const Sweep& sweep) {
    return 0.8 * 360.0 * sweep.rate_hz / std::max(sweep.fast_deg_s, 1e-9);
}

/// Highest order that a sweep shows. At one speed, lines above half the sample rate fold onto others exactly.
/// When the speed changes so much, within sweeps or from one to another, that a folded line smears over many
/// resolutions, the sum over the measured angle gathers a line at its own order alone, whatever the sample
/// rate.
double highest_order(const Sweep& sweep, const Speeds& speeds) {
    const double per_turn = sweep.rate_hz * 360.0;
    const double smear =
        per_turn / std::max(speeds.slow_deg_s, 1e-9) - per_turn / std::max(speeds.quick_deg_s, 1e-9);
    const bool smears = smear > smeared_cells * hann_cell / sweep.length_turns;
    return smears ? folds_searched * per_turn / std::max(speeds.quick_deg_s, 1e-9)
                  : 0.5 * per_turn / std::max(sweep.slow_deg_s, 1e-9);
}

struct StackGrid {
    Axis axis = Axis::angle;
    double spacing = 0.0;
    std::size_t bins = 0;
    Speeds speeds;
};

Reach reach_of(const Sweep& sweep, const StackGrid& grid, const StackRule& rule) {
    const double length = length_of(sweep, grid.axis);
    if (!(length > 0.0)) return {};
    // Below the lowest line that is looked for, down to the trend: its noise on that side. Next to half the
    // sample rate a tone and its image are one, and noise is real: it scatters twice as much.
    const double lowest = used_cycles / length;
    const double highest = grid.axis == Axis::angle
                               ? std::min(rule.highest_order, highest_order(sweep, grid.speeds))
                               : 0.5 * sweep.rate_hz - hann_cell / length;
    const auto end = static_cast<std::size_t>(highest / grid.spacing) + 1;
    return {static_cast<std::size_t>(std::ceil(lowest / grid.spacing)), std::min(end, grid.bins)};
}

/// stack_sweeps in parts of the sweeps. The parts are the same on any number of threads, so the bytes are.
class Stacking {
  public:
    /// The sweeps and the rule must outlive it.
    Stacking(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule);

    [[nodiscard]] std::size_t parts() const { return parts_.size(); }
    /// To be called for each part once, in any order.
    void run(std::size_t part);
    /// When all parts ran; the last call.
    [[nodiscard]] Stack stack();

  private:
    struct Part {
        std::size_t first = 0, end = 0;  ///< sweeps
        /// By bin: sums over the sweeps, as Stack has their means.
        std::vector<double> ratio, amplitude, floor, weight, square;
        std::size_t low = 0, high = 0;  ///< bins that a sweep reaches
    };
    void add(std::size_t sweep, Part& part);

    std::span<const Sweep> sweeps_;
    const StackRule& rule_;
    Stack stack_;
    std::size_t bins_ = 0;
    double slow_deg_s_ = 1e300, quick_deg_s_ = 0.0;  ///< quartiles of the slowest and the quickest sweep
    std::vector<Part> parts_;
};

Stacking::Stacking(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule)
    : sweeps_(sweeps), rule_(rule) {
    stack_.axis = axis;
    double longest = 0.0, weights = 0.0, mean_length = 0.0, half_rate = 0.0;
    for (const Sweep& sweep : sweeps) {
        const double length = length_of(sweep, axis);
        const double weight = length > 0.0 ? sweep.effective_samples() : 0.0;
        longest = std::max(longest, length);
        weights += weight;
        mean_length += weight * length;
        half_rate = std::max(half_rate, 0.5 * sweep.rate_hz);
        stack_.sweep_weights.push_back(weight);
        if (sweep.rest()) continue;
        slow_deg_s_ = std::min(slow_deg_s_, sweep.slow_deg_s);
        quick_deg_s_ = std::max(quick_deg_s_, sweep.quick_deg_s);
    }
    if (!(longest > 0.0)) {
        stack_.sweep_weights.clear();
        return;
    }
    mean_length /= weights;
    stack_.spacing = 0.5 / longest;
    stack_.resolution = hann_cell / mean_length;
    stack_.tries_factor = longest / mean_length;
    stack_.lowest =
        std::max(axis == Axis::angle ? rule.lowest_order : rule.lowest_hz, rule.fewest_cycles / mean_length);
    // Half a cycle lower: the maximum of a line there is seen a little off its place.
    stack_.searched =
        static_cast<std::size_t>(std::ceil((stack_.lowest - 0.5 / mean_length) / stack_.spacing));
    const double highest = axis == Axis::angle ? rule.highest_order : half_rate;
    bins_ = static_cast<std::size_t>(highest / stack_.spacing) + 1;
    stack_.floors.resize(sweeps.size());
    const std::size_t parts = std::min(most_parts, sweeps.size());
    for (std::size_t part = 0; part < parts; ++part)
        parts_.push_back({.first = sweeps.size() * part / parts,
                          .end = sweeps.size() * (part + 1) / parts,
                          .ratio = {},
                          .amplitude = {},
                          .floor = {},
                          .weight = {},
                          .square = {},
                          .low = bins_});
}

void Stacking::run(std::size_t number) {
    Part& part = parts_[number];
    for (auto* sums : {&part.ratio, &part.amplitude, &part.floor, &part.weight, &part.square})
        sums->assign(bins_, 0.0);
    for (std::size_t sweep = part.first; sweep < part.end; ++sweep) add(sweep, part);
}

void Stacking::add(std::size_t number, Part& part) {
    const Sweep& sweep = sweeps_[number];
    Reach reach = reach_of(sweep, {stack_.axis, stack_.spacing, bins_, {slow_deg_s_, quick_deg_s_}}, rule_);
    auto& floors = stack_.floors[number];
    floors.assign(bins_, 0.0F);
    const double cell = hann_cell / (length_of(sweep, stack_.axis) * stack_.spacing);
    const auto too_few = [&] {
        return static_cast<double>(reach.end) < static_cast<double>(reach.first) + fewest_sweep_cells * cell;
    };
    if (too_few()) return;
    const auto sums = nonuniform_fourier(places(sweep, stack_.axis), sweep.value, stack_.spacing, reach.end);
    std::vector<double> power(reach.end);
    for (std::size_t k = 0; k < reach.end; ++k) power[k] = std::norm(sums[k]);
    std::vector<double> floor = noise_floor({power, 1.0, cell, reach.first, {}});
    const auto clear = static_cast<std::size_t>(clear_of_motion(sweep) / stack_.spacing) + 1;
    if (stack_.axis == Axis::angle && reach.end > clear) {
        // The residual of the motion after the trend folds to around the sample rate, smeared over the cells
        // that the sweep's own speeds span there: unseen where it is weak.
        const std::size_t slow = std::min(reach.end, reach.first + static_cast<std::size_t>(2.0 * cell));
        const double motion =
            *std::max_element(power.begin(), power.begin() + static_cast<std::ptrdiff_t>(slow));
        const double per_turn = 360.0 * sweep.rate_hz;
        const double smeared =
            (per_turn / std::max(sweep.slow_deg_s, 1e-9) - per_turn / std::max(sweep.quick_deg_s, 1e-9)) *
            sweep.length_turns / hann_cell;
        constexpr double most_of_noise = 8.0;  // the largest of a few cells of noise, over their mean
        if (motion > std::max(most_of_noise, 0.5 * smeared) * floor[reach.end / 2]) {
            reach.end = std::min(reach.end, clear);
            if (too_few()) return;
            power.resize(reach.end);
            floor = noise_floor({power, 1.0, cell, reach.first, {}});
        }
    }
    const double weight = stack_.sweep_weights[number];
    const double to_amplitude = 4.0 / (sweep.weight_sum * sweep.weight_sum);
    for (std::size_t k = reach.first; k < reach.end; ++k) {
        floors[k] = static_cast<float>(floor[k]);
        part.ratio[k] += weight * power[k] / floor[k];
        part.amplitude[k] += weight * power[k] * to_amplitude;
        part.floor[k] += weight * floor[k] * to_amplitude;
        part.weight[k] += weight;
        part.square[k] += weight * weight;
    }
    part.low = std::min(part.low, reach.first);
    part.high = std::max(part.high, reach.end);
}

Stack Stacking::stack() {
    if (parts_.empty()) return std::move(stack_);
    Part all = std::move(parts_.front());
    for (std::size_t i = 1; i < parts_.size(); ++i) {
        const Part& part = parts_[i];
        for (std::size_t k = part.low; k < part.high; ++k) {
            all.ratio[k] += part.ratio[k];
            all.amplitude[k] += part.amplitude[k];
            all.floor[k] += part.floor[k];
            all.weight[k] += part.weight[k];
            all.square[k] += part.square[k];
        }
        all.low = std::min(all.low, part.low);
        all.high = std::max(all.high, part.high);
    }
    stack_.first = std::min(all.low, bins_);
    const std::size_t end = std::min(std::max(all.low, all.high), bins_);
    for (auto* means : {&stack_.ratio, &stack_.averages, &stack_.amplitude_nm, &stack_.floor_nm})
        means->resize(end);
    for (std::size_t k = stack_.first; k < end; ++k) {
        // Bins that no sweep reaches (between sweeps of very different speed) read as noise.
        const double weight = all.weight[k];
        const bool used = weight > 0.0;
        stack_.ratio[k] = used ? all.ratio[k] / weight : 1.0;
        stack_.averages[k] =
            used ? std::max(1.0, weight * weight / all.square[k] / overlap_correlation) : 1.0;
        stack_.amplitude_nm[k] = used ? std::sqrt(all.amplitude[k] / weight) : 0.0;
        stack_.floor_nm[k] = used ? std::sqrt(all.floor[k] / weight) : 0.0;
    }
    return std::move(stack_);
}

}  // namespace

std::span<const double> places(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.turns : sweep.time_s;
}

double length_of(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.length_turns : sweep.duration_s;
}

PowerSpectrum Stack::tested() const {
    return {ratio, 1.0, resolution / spacing, first, averages, searched, removed};
}

void Stack::mark_removed(double place) {
    // Half width of a Hann line, beyond which hardly any noise is removed.
    constexpr double half_width_cycles = 1.5;
    const double reach = half_width_cycles / hann_cell * resolution;
    removed.resize(ratio.size(), 0);
    const auto last = static_cast<std::size_t>((place + reach) / spacing);
    for (auto k = static_cast<std::size_t>(std::ceil(std::max(0.0, place - reach) / spacing));
         k <= last && k < removed.size(); ++k)
        removed[k] = 1;
}

std::vector<SpectralHump> Stack::humps(const HumpRule& rule) const {
    std::vector<SpectralHump> humps;
    if (ratio.size() <= first) return humps;
    // Not over the running floor, which a hump as wide as its window would raise to its own height.
    std::vector<double> power(ratio.size());
    for (std::size_t k = 0; k < power.size(); ++k) power[k] = ratio[k] * floor_nm[k] * floor_nm[k];
    PowerSpectrum spectrum = tested();
    spectrum.power = power;
    for (const SignificantHump& found : significant_humps(spectrum, rule.false_alarm / tries_factor)) {
        if (static_cast<double>(found.first) * spacing < rule.lowest) continue;
        SpectralHump hump;
        double square = 0.0;
        std::size_t highest = found.first;
        for (std::size_t k = found.first; k < found.end; ++k) {
            square += 0.5 * (power[k] - found.floor) * spacing / resolution;
            if (amplitude_nm[k] > amplitude_nm[highest]) highest = k;
        }
        hump.from_hz = static_cast<double>(found.first) * spacing;
        hump.to_hz = static_cast<double>(found.end - 1) * spacing;
        hump.peak_hz = static_cast<double>(highest) * spacing;
        hump.peak_nm = amplitude_nm[highest];
        hump.rms_nm = std::sqrt(std::max(square, 0.0));
        hump.floor_nm = std::sqrt(found.floor);
        hump.false_alarm = std::min(1.0, found.false_alarm * tries_factor);
        humps.push_back(hump);
    }
    std::stable_sort(humps.begin(), humps.end(),
                     [](const SpectralHump& a, const SpectralHump& b) { return a.rms_nm > b.rms_nm; });
    return humps;
}

Stack stack_sweeps(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule) {
    Stacking stacking(sweeps, axis, rule);
    on_two_cores(stacking.parts(), [&](std::size_t part) { stacking.run(part); });
    return stacking.stack();
}

}  // namespace ripplenotch
