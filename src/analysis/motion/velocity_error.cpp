// SPDX-License-Identifier: MIT
#include "analysis/motion/velocity_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "analysis/motion/motion_lines.hpp"
#include "core/functions/many_numbers.hpp"
#include "core/matrices/factorisations.hpp"
#include "core/matrices/linear_algebra.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/steady.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double smoothing_s = 0.05;  // as models smooth speeds (measured_motion.hpp)

std::vector<double> integrated_velocity(const TraceView& log) {
    std::vector<double> turns(log.size(), 0.0);
    for (std::size_t k = 1; k < log.size(); ++k) {
        const double step = log.time_s[k] - log.time_s[k - 1];
        turns[k] = turns[k - 1] + 0.5 * (log.velocity_deg_s[k] + log.velocity_deg_s[k - 1]) * step / 360.0;
    }
    return turns;
}

/// Position in turns, jumps of more than half a turn between neighbours taken as wrapping.
std::vector<double> unwrapped_position(const TraceView& log) {
    std::vector<double> turns(log.size());
    double offset = 0.0;
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (k > 0) {
            const double jump = log.position_deg[k] - log.position_deg[k - 1];
            if (std::abs(jump) > 180.0) offset -= std::round(jump / 360.0);
        }
        turns[k] = log.position_deg[k] / 360.0 + offset;
    }
    return turns;
}

}  // namespace

OutputAngle output_angle(const TraceView& log) {
    if (log.has_position()) return {unwrapped_position(log), true};
    return {integrated_velocity(log), false};
}

std::vector<double> smoothed_speed(const TraceView& log) {
    const auto width = static_cast<std::size_t>(smoothing_s * log.sample_rate.value()) | 1U;
    return moving_mean(log.velocity_deg_s, width);
}

std::vector<SampleRun> directed_runs(std::span<const double> speed_deg_s,
                                     std::span<const std::size_t> run_starts, const RunRule& rule) {
    double fastest = 0.0;
    for (const double v : speed_deg_s) fastest = std::max(fastest, std::abs(v));
    const double slowest = std::max(rule.slowest_share * fastest, rule.standstill_deg_s);
    std::vector<SampleRun> runs;
    auto start = run_starts.begin();
    int direction = 0;
    for (std::size_t k = 0; k < speed_deg_s.size(); ++k) {
        const int here = speed_deg_s[k] > slowest ? 1 : speed_deg_s[k] < -slowest ? -1 : 0;
        const bool begins = start != run_starts.end() && *start == k;
        start += begins ? 1 : 0;
        if (here != 0 && (here != direction || begins)) runs.push_back({k, k});
        if (here != 0) runs.back().end = k + 1;
        direction = here;
    }
    return runs;
}

std::vector<SampleRun> whole_runs(std::size_t samples, std::span<const std::size_t> run_starts) {
    std::vector<SampleRun> runs;
    std::size_t first = 0;
    for (const std::size_t start : run_starts) {
        runs.push_back({first, start});
        first = start;
    }
    if (first < samples) runs.push_back({first, samples});
    return runs;
}

namespace {

/// Half-overlapping pieces of equal length in angle that cover the run: of about rule.longest_turns and
/// rule.longest_s where it is longer, by half as much again at most.
std::vector<SampleRun> pieces_of(const SampleRun& run, const TraceView& log, std::span<const double> turns,
                                 const SweepRule& rule) {
    const double start = turns[run.first];
    const double length = std::abs(turns[run.end - 1] - start);
    if (length < rule.shortest_turns) return {};
    const double duration = log.time_s[run.end - 1] - log.time_s[run.first];
    const double longest = std::min(rule.longest_turns, length * rule.longest_s / std::max(duration, 1e-9));
    // No more pieces than samples, however far apart those are.
    const auto count = static_cast<std::size_t>(
        std::clamp(std::floor(2.0 * length / longest) - 1.0, 1.0, static_cast<double>(run.size())));
    if (count == 1) return {run};
    const double hop = length / static_cast<double>(count + 1), width = std::min(2.0 * hop, 1.5 * longest);
    std::vector<SampleRun> pieces;
    std::size_t from = run.first;
    for (std::size_t i = 0; i < count; ++i) {
        const double begin = hop * static_cast<double>(i);
        while (from < run.end && std::abs(turns[from] - start) < begin) ++from;
        std::size_t to = from;
        while (to < run.end && std::abs(turns[to] - start) <= begin + width) ++to;
        pieces.push_back({from, to});
    }
    return pieces;
}

/// Weight by speed, in steps of speed that are narrow compared with its range.
class SpeedShares {
  public:
    SpeedShares(std::span<const double> speed, std::span<const double> weight)
        : speed_(speed), weight_(weight) {
        const auto [least, most] = std::minmax_element(
            speed.begin(), speed.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
        low_ = std::abs(*least);
        const double range = std::abs(*most) - low_;
        steps_per_deg_s_ = range > 0.0 ? static_cast<double>(sums_.size()) / range : 0.0;
        for (std::size_t k = 0; k < speed.size(); ++k) sums_[step_of(speed[k])] += weight[k];
    }

    /// The speed below which lies so much weight.
    [[nodiscard]] double quantile(double share) const {
        std::size_t step = 0;
        double below = 0.0;
        while (step + 1 < sums_.size() && below + sums_[step] < share) below += sums_[step++];
        std::vector<std::pair<double, double>> inside;
        for (std::size_t k = 0; k < speed_.size(); ++k) {
            if (step_of(speed_[k]) == step) inside.emplace_back(std::abs(speed_[k]), weight_[k]);
        }
        auto from = inside.begin(), to = inside.end();
        while (to - from > 1) {
            const auto middle = from + (to - from) / 2;
            std::nth_element(from, middle, to,
                             [](const auto& a, const auto& b) { return a.first < b.first; });
            double slower = 0.0;
            for (auto one = from; one != middle; ++one) slower += one->second;
            const bool beyond = below + slower < share;
            if (beyond) below += slower;
            (beyond ? from : to) = middle;
        }
        return from == inside.end() ? low_ : from->first;
    }

  private:
    [[nodiscard]] std::size_t step_of(double speed) const {
        const auto step = static_cast<std::size_t>((std::abs(speed) - low_) * steps_per_deg_s_);
        return std::min(step, sums_.size() - 1);
    }

    std::span<const double> speed_, weight_;
    double low_ = 0.0, steps_per_deg_s_ = 0.0;
    std::array<double, 512> sums_{};
};

/// Hann window over the sweep's own length, times the angle that each sample stands for.
void weigh_sweep(Sweep& sweep) {
    const bool at_rest = sweep.rest();
    sweep.length_turns = at_rest ? 0.0 : std::abs(sweep.turns.back() - sweep.turns.front());
    sweep.duration_s = sweep.time_s.back() - sweep.time_s.front();
    sweep.weight.resize(sweep.turns.size());
    sweep.weight_sum = sweep.weight_square_sum = 0.0;
    for (std::size_t k = 0; k < sweep.turns.size(); ++k) {
        sweep.weight[k] = 2.0 * std::numbers::pi * std::clamp(sweep.progress(k), 0.0, 1.0);
    }
    portable::cos(sweep.weight, sweep.weight);
    for (std::size_t k = 0; k < sweep.turns.size(); ++k) {
        sweep.weight[k] = (0.5 - 0.5 * sweep.weight[k]) * sweep.share_turns[k];
        sweep.weight_sum += sweep.weight[k];
        sweep.weight_square_sum += sweep.weight[k] * sweep.weight[k];
    }
}

/// Samples of a log that become a piece.
struct Planned {
    std::size_t log = 0;
    SampleRun span;
    bool rest = false;
};

Sweep make_sweep(const TraceView& log, const Planned& plan, std::span<const double> all_turns,
                 std::span<const double> all_speed, const SweepRule& rule) {
    const SampleRun& span = plan.span;
    const std::size_t n = span.end - span.first;
    const double step = 1.0 / log.sample_rate.value();
    const auto turns = all_turns.subspan(span.first, n);
    const auto speed = all_speed.subspan(span.first, n);
    const auto time = log.time_s.subspan(span.first, n);
    Sweep sweep;
    sweep.log = plan.log;
    sweep.first = span.first;
    sweep.rate_hz = log.sample_rate.value();
    sweep.turns.assign(turns.begin(), turns.end());
    sweep.speed_deg_s.assign(speed.begin(), speed.end());
    sweep.time_s.resize(n);
    sweep.share_turns.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        sweep.time_s[k] = time[k] - 0.5 * (time.front() + time.back());
        const double before = k > 0 ? time[k] - time[k - 1] : step;
        const double after = k + 1 < n ? time[k + 1] - time[k] : step;
        const double seconds = std::clamp(0.5 * (before + after), 0.0, 3.0 * step);
        // The smoothed speed gives each sample its share of angle: differences of a held or coarse position
        // would not.
        sweep.share_turns[k] = plan.rest ? seconds : std::abs(speed[k]) * seconds / 360.0;
        sweep.fast_deg_s = std::max(sweep.fast_deg_s, std::abs(speed[k]));
    }
    if (!plan.rest) sweep.length_turns = std::abs(turns.back() - turns.front());
    sweep.measured_nm = log.torque_nm.subspan(span.first, n);
    sweep.trend_terms = static_cast<std::size_t>(std::lround(2.0 * rule.trend_cycles)) + 2;
    weigh_sweep(sweep);
    if (!(sweep.weight_sum > 0.0)) return sweep;
    if (!plan.rest) {
        for (std::size_t k = 0; k < n; ++k) sweep.mean_deg_s += sweep.weight[k] * speed[k] / sweep.weight_sum;
        const SpeedShares shares(speed, sweep.weight);
        sweep.slow_deg_s = shares.quantile(0.25 * sweep.weight_sum);
        sweep.quick_deg_s = shares.quantile(0.75 * sweep.weight_sum);
    }
    fit_out(sweep, {});
    return sweep;
}

/// Takes an offset and a delay off what was summed from a velocity.
void put_right(const TraceView& log, const VelocityError& error, std::vector<double>& turns,
               std::vector<double>& speed) {
    for (std::size_t k = 0; k < turns.size(); ++k) {
        const double since_start = log.time_s[k] - log.time_s.front();
        turns[k] += (error.delay.value() * speed[k] - error.offset.value() * since_start) / 360.0;
        speed[k] -= error.offset.value();
    }
}

/// The standstill between the runs of a log, in pieces of at most rule.longest_s.
std::vector<SampleRun> rests_of(const TraceView& log, std::span<const double> speed, double standstill_deg_s,
                                const SweepRule& rule) {
    // Chosen, not derived: five cycles of the slowest tone that is reported.
    constexpr double shortest_s = 0.5;
    const auto longest = static_cast<std::size_t>(rule.longest_s * log.sample_rate.value());
    std::vector<SampleRun> rests;
    for (const SampleRun& run : whole_runs(log.size(), log.run_starts)) {
        std::size_t first = run.first;
        for (std::size_t k = run.first; k <= run.end; ++k) {
            const bool still = k < run.end && std::abs(speed[k]) <= standstill_deg_s;
            if (still && k - first < longest) continue;
            if (k > first && log.time_s[k - 1] - log.time_s[first] >= shortest_s) rests.push_back({first, k});
            first = still ? k : k + 1;
        }
    }
    return rests;
}

/// Keeps pieces evenly over all of them until their number and their samples fit.
std::vector<Planned> within_budget(std::vector<Planned> all, const SweepRule& rule) {
    std::size_t samples = 0;
    for (const Planned& piece : all) samples += piece.span.end - piece.span.first;
    if (samples <= rule.most_samples && all.size() <= rule.most_pieces) return all;
    const double share = std::min(static_cast<double>(rule.most_samples) / static_cast<double>(samples),
                                  static_cast<double>(rule.most_pieces) / static_cast<double>(all.size()));
    std::vector<Planned> kept;
    double credit = 0.5;
    for (const Planned& piece : all) {
        credit += share;
        if (credit < 1.0) continue;
        credit -= 1.0;
        kept.push_back(piece);
    }
    if (kept.empty()) kept.push_back(all.front());
    return kept;
}

}  // namespace

Sweep part_of(const Sweep& sweep, std::size_t first, std::size_t count) {
    const auto cut = [&](const std::vector<double>& whole) {
        const auto from = whole.begin() + static_cast<std::ptrdiff_t>(first);
        return std::vector<double>(from, from + static_cast<std::ptrdiff_t>(count));
    };
    Sweep part = sweep;
    part.first += first;
    part.measured_nm = sweep.measured_nm.subspan(first, count);
    part.turns = cut(sweep.turns);
    part.time_s = cut(sweep.time_s);
    part.speed_deg_s = cut(sweep.speed_deg_s);
    part.torque_nm = cut(sweep.torque_nm);
    part.share_turns = cut(sweep.share_turns);
    weigh_sweep(part);
    part.value.resize(count);
    for (std::size_t k = 0; k < count; ++k) part.value[k] = part.torque_nm[k] * part.weight[k];
    return part;
}

Sweeps cut_sweeps(std::span<const TraceView> logs, const SweepRule& rule, const VelocityError& error) {
    std::vector<OutputAngle> angles;
    std::vector<std::vector<double>> speeds;
    std::vector<Planned> planned;
    Sweeps sweeps;
    for (std::size_t i = 0; i < logs.size(); ++i) {
        const TraceView& log = logs[i];
        angles.push_back(output_angle(log));
        speeds.push_back(smoothed_speed(log));
        if (!angles.back().absolute) put_right(log, error, angles.back().turns, speeds.back());
        const double still_deg_s = standstill_deg_s(log, speeds.back(), {});
        for (const SampleRun& run :
             directed_runs(speeds.back(), log.run_starts, {rule.slowest_share, still_deg_s})) {
            for (const SampleRun& piece : pieces_of(run, log, angles.back().turns, rule)) {
                if (piece.end - piece.first >= rule.fewest_samples) planned.push_back({i, piece, false});
            }
        }
        for (const SampleRun& rest : rests_of(log, speeds.back(), still_deg_s, rule)) {
            if (rest.end - rest.first >= rule.fewest_samples) planned.push_back({i, rest, true});
        }
        sweeps.absolute_angle = sweeps.absolute_angle && angles.back().absolute;
    }
    const std::size_t all = planned.size();
    planned = within_budget(std::move(planned), rule);
    sweeps.pieces_left_out = all - planned.size();
    sweeps.pieces.resize(planned.size());
    on_two_cores(planned.size(), [&](std::size_t i) {
        const std::size_t log = planned[i].log;
        sweeps.pieces[i] = make_sweep(logs[log], planned[i], angles[log].turns, speeds[log], rule);
    });
    std::erase_if(sweeps.pieces, [](const Sweep& sweep) { return !(sweep.weight_sum > 0.0); });
    return sweeps;
}

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

/// A sweep's torque at one order: demodulated, and averaged over short cells. The three columns are the
/// derivatives of the angle with respect to the order's own position, the offset and the delay, in turns for
/// one unit of each, about their means.
struct DemodulatedSweep {
    std::size_t sweep = 0, order = 0;  ///< which
    double cycles = 0.0;               ///< per turn
    double noise = 0.0;                ///< power of it in the sum
    std::vector<std::complex<double>> value;
    std::vector<double> weight, weight_square, seconds;
    std::array<std::vector<double>, 3> column;
    /// Variance of the angle, in turns^2, from the integrated noise of the velocity.
    double variance_per_s = 0.0;
    double weights = 0.0, weight_squares = 0.0;
};

/// Half of the summed power over noise at some values of the unknowns: one for each order (its position, as a
/// share), the offset in deg/s, the delay in seconds. Includes the prior of the unknowns.
class RipplePower {
  public:
    /// `beforehand`: its errors are how far offset and delay may be from 0.
    RipplePower(std::vector<DemodulatedSweep> all, std::size_t orders, const VelocityError& beforehand)
        : all_(std::move(all)),
          orders_(orders),
          certainty_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(orders) + 2)) {
        const double off = beforehand.offset_error.value(), late = beforehand.delay_error.value();
        certainty_[offset()] = 1.0 / (off * off);
        certainty_[delay()] = 1.0 / (late * late);
    }

    struct At {
        double value = 0.0;
        Eigen::VectorXd slope;
        Eigen::MatrixXd curve;     ///< second derivative of the power, and
        Eigen::MatrixXd expected;  ///< its expectation where the cells are in phase: never indefinite
    };

    [[nodiscard]] Eigen::Index unknowns() const { return static_cast<Eigen::Index>(orders_) + 2; }
    [[nodiscard]] Eigen::Index offset() const { return static_cast<Eigen::Index>(orders_); }
    [[nodiscard]] Eigen::Index delay() const { return static_cast<Eigen::Index>(orders_) + 1; }

    [[nodiscard]] At at(const Eigen::VectorXd& unknown) const {
        At sum{-0.5 * unknown.dot(certainty_.cwiseProduct(unknown)), -certainty_.cwiseProduct(unknown),
               -Eigen::MatrixXd(certainty_.asDiagonal()), Eigen::MatrixXd(certainty_.asDiagonal())};
        for (const DemodulatedSweep& cells : all_) add(cells, unknown, sum);
        return sum;
    }

    /// Covariance of the slope at the maximum: from noise of the torque, and from the common sources of all
    /// orders, noise of the velocity and the prior.
    struct SlopeVariance {
        Eigen::MatrixXd own, common;
    };
    [[nodiscard]] SlopeVariance slope_variance(const Eigen::VectorXd& unknown) const;

    /// How far offset and delay move a cell within its sweep, at most, in cycles of its order.
    [[nodiscard]] double most_cycles(const Eigen::VectorXd& unknown) const;

  private:
    [[nodiscard]] std::array<Eigen::Index, 3> places_of(const DemodulatedSweep& cells) const {
        return {static_cast<Eigen::Index>(cells.order), offset(), delay()};
    }

    void add(const DemodulatedSweep& cells, const Eigen::VectorXd& unknown, At& sum) const;

    std::vector<DemodulatedSweep> all_;
    std::size_t orders_;
    Eigen::VectorXd certainty_;
};

// So many of a sweep turn less than a tenth of a cycle each where the whole is wrong by five cycles.
constexpr std::size_t cells_per_sweep = 48;

void centre(DemodulatedSweep& cells) {
    for (std::vector<double>& column : cells.column) {
        double mean = 0.0;
        for (std::size_t i = 0; i < column.size(); ++i) mean += cells.weight[i] * column[i] / cells.weights;
        for (double& one : column) one -= mean;
    }
}

struct PowerMoments {
    Complex value;
    std::array<Complex, 3> first{};
    std::array<std::array<Complex, 3>, 3> second{};
};

/// The sum and its derivatives by the three unknowns that move it.
PowerMoments power_moments(const DemodulatedSweep& cells, const std::array<double, 3>& moved) {
    PowerMoments sum;
    const double rate = full_turn * cells.cycles;
    for (std::size_t i = 0; i < cells.value.size(); ++i) {
        const double off =
            moved[0] * cells.column[0][i] + moved[1] * cells.column[1][i] + moved[2] * cells.column[2][i];
        const Complex z = cells.value[i] * portable::polar(1.0, -rate * off);
        sum.value += z;
        for (std::size_t a = 0; a < 3; ++a) {
            const Complex by_a = Complex(0.0, -rate * cells.column[a][i]) * z;
            sum.first[a] += by_a;
            for (std::size_t b = 0; b <= a; ++b)
                sum.second[a][b] += Complex(0.0, -rate * cells.column[b][i]) * by_a;
        }
    }
    return sum;
}

/// Sums of weight * column a * column b over the cells.
double spread_of_cells(const DemodulatedSweep& cells, const std::vector<double>& weight, std::size_t a,
                       std::size_t b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < weight.size(); ++i)
        sum += weight[i] * cells.column[a][i] * cells.column[b][i];
    return sum;
}

/// `noise` and `variance_per_s` are left to the caller. Cost O(samples).
DemodulatedSweep demodulated(const TraceView& log, const Sweep& sweep, double cycles_per_turn) {
    const std::size_t n = sweep.turns.size(), count = std::min(n, cells_per_sweep);
    DemodulatedSweep cells;
    cells.cycles = cycles_per_turn;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t first = n * i / count, end = n * (i + 1) / count;
        Complex sum;
        double weight = 0.0, squares = 0.0, turns = 0.0, time = 0.0, speed = 0.0;
        for (std::size_t k = first; k < end; ++k) {
            sum += sweep.value[k] * portable::polar(1.0, -full_turn * cycles_per_turn * sweep.turns[k]);
            weight += sweep.weight[k];
            squares += sweep.weight[k] * sweep.weight[k];
            turns += sweep.turns[k];
            time += sweep.time_s[k];
            speed += log.velocity_deg_s[sweep.first + k];
        }
        const auto samples = static_cast<double>(end - first);
        cells.value.push_back(sum);
        cells.weight.push_back(weight);
        cells.weight_square.push_back(squares);
        cells.weights += weight;
        cells.weight_squares += squares;
        cells.seconds.push_back(samples / sweep.rate_hz);
        cells.column[0].push_back(turns / samples);
        const bool summed = !log.has_position();
        cells.column[1].push_back(summed ? -time / samples / 360.0 : 0.0);
        cells.column[2].push_back(summed ? speed / samples / 360.0 : 0.0);
    }
    centre(cells);
    return cells;
}

void RipplePower::add(const DemodulatedSweep& cells, const VectorXd& unknown, At& sum) const {
    const auto place = places_of(cells);
    const PowerMoments m = power_moments(cells, {unknown[place[0]], unknown[place[1]], unknown[place[2]]});
    const double power = std::norm(m.value) / cells.noise;
    sum.value += 0.5 * power;
    const double rate = full_turn * cells.cycles;
    const double stiff = power / cells.weights * rate * rate;
    for (std::size_t a = 0; a < 3; ++a) {
        sum.slope[place[a]] += std::real(std::conj(m.value) * m.first[a]) / cells.noise;
        for (std::size_t b = 0; b <= a; ++b) {
            const double curve =
                std::real(std::conj(m.first[a]) * m.first[b] + std::conj(m.value) * m.second[a][b]) /
                cells.noise;
            const double expected = stiff * spread_of_cells(cells, cells.weight, a, b);
            sum.curve(place[a], place[b]) += curve;
            sum.expected(place[a], place[b]) += expected;
            if (a == b) continue;
            sum.curve(place[b], place[a]) += curve;
            sum.expected(place[b], place[a]) += expected;
        }
    }
}

double RipplePower::most_cycles(const VectorXd& unknown) const {
    double most = 0.0;
    for (const DemodulatedSweep& cells : all_) {
        for (std::size_t i = 0; i < cells.value.size(); ++i) {
            const double off = unknown[offset()] * cells.column[1][i] + unknown[delay()] * cells.column[2][i];
            most = std::max(most, cells.cycles * std::abs(off));
        }
    }
    return most;
}

RipplePower::SlopeVariance RipplePower::slope_variance(const VectorXd& unknown) const {
    SlopeVariance variance{MatrixXd::Zero(unknowns(), unknowns()), MatrixXd(certainty_.asDiagonal())};
    std::vector<VectorXd> after;  // by cell, how much of the slope one turn of angle from there on makes
    const DemodulatedSweep* before = nullptr;
    const auto settle = [&] {
        if (before == nullptr) return;
        for (std::size_t i = 0; i < after.size(); ++i)
            variance.common += before->variance_per_s * before->seconds[i] * after[i] * after[i].transpose();
        after.clear();
    };
    for (const DemodulatedSweep& cells : all_) {
        // The orders of one sweep follow each other, and share its angle.
        if (before != nullptr && before->sweep != cells.sweep) settle();
        before = &cells;
        after.resize(cells.value.size(), VectorXd::Zero(unknowns()));
        const auto place = places_of(cells);
        const PowerMoments m =
            power_moments(cells, {unknown[place[0]], unknown[place[1]], unknown[place[2]]});
        const double power = std::max(0.0, std::norm(m.value) / cells.noise - 1.0);
        const double rate = full_turn * cells.cycles, stiff = power / cells.weights * rate * rate;
        for (std::size_t a = 0; a < 3; ++a) {
            double tail = 0.0;
            for (std::size_t i = cells.value.size(); i-- > 0;) {
                tail += cells.weight[i] * cells.column[a][i];
                after[i][place[a]] += stiff * tail;
            }
            for (std::size_t b = 0; b < 3; ++b) {
                variance.own(place[a], place[b]) += 0.5 * power * rate * rate *
                                                    spread_of_cells(cells, cells.weight_square, a, b) /
                                                    cells.weight_squares;
            }
        }
    }
    settle();
    return variance;
}

/// Where a velocity in coarse steps turns, it stays at one value while the joint is up to a step away: a
/// parabola that reaches a share h of the step, anything from 0 to 1, has a mean error of 2 h / 3 - 1 / 2.
constexpr double square_off = 1.0 / 27.0 + 1.0 / 36.0;
constexpr std::size_t fewest_alike = 3;  // chosen, not derived: noise alone makes two alike now and then
// Chosen, not derived: share of a step; values have been rounded in other units.
constexpr double same_step = 1e-3;

/// Variance that turning points of a velocity in steps add to its sum in each second, in deg^2/s. Between
/// them the steps average out.
double of_steps(std::span<const double> velocity_deg_s, Hertz rate) {
    double sum = 0.0;
    std::size_t begin = 0;
    for (std::size_t k = 1; k < velocity_deg_s.size(); ++k) {
        if (velocity_deg_s[k] == velocity_deg_s[begin]) continue;
        if (begin > 0 && k - begin >= fewest_alike) {
            const double before = velocity_deg_s[begin - 1] - velocity_deg_s[begin],
                         after = velocity_deg_s[k] - velocity_deg_s[begin];
            const double seconds = static_cast<double>(k - begin) / rate.value();
            if (std::abs(before - after) <= same_step * std::abs(after))
                sum += square_off * after * after * seconds * seconds;
        }
        begin = k;
    }
    return sum / (static_cast<double>(velocity_deg_s.size()) / rate.value());
}

/// Variance that the velocity's noise adds to its sum in each second, in deg^2/s: the noise of means over 25
/// ms, which motion hardly bends, times their length. From third differences of neighbouring means (the
/// squares of 1, 3, 3, 1 are 20 together), by their median, so that a few jerks do not count; plus the error
/// of a velocity in coarse steps where it turns. 0 for a log of fewer than a hundred means.
double summed_noise(const TraceView& log) {
    // Chosen, not derived: long enough for the noise that a filter passes, short enough for motion of some
    // hertz.
    constexpr double mean_over_s = 0.025;
    constexpr std::size_t fewest_means = 100;  // chosen, not derived: their median is within a tenth
    constexpr double normal_median = 0.6745;  // median magnitude of a normal variable, in standard deviations
    const auto samples =
        static_cast<std::size_t>(std::max(1.0, std::round(mean_over_s * log.sample_rate.value())));
    std::vector<double> means;
    for (std::size_t first = 0; first + samples <= log.size(); first += samples) {
        double sum = 0.0;
        for (std::size_t k = first; k < first + samples; ++k) sum += log.velocity_deg_s[k];
        means.push_back(sum / static_cast<double>(samples));
    }
    if (means.size() < fewest_means) return 0.0;
    std::vector<double> bends;
    for (std::size_t i = 3; i < means.size(); ++i)
        bends.push_back(std::abs(means[i] - 3.0 * means[i - 1] + 3.0 * means[i - 2] - means[i - 3]));
    const double deviation = median_in(bends) / normal_median / std::sqrt(20.0);
    return deviation * deviation * static_cast<double>(samples) / log.sample_rate.value() +
           of_steps(log.velocity_deg_s, log.sample_rate);
}

constexpr std::size_t most_orders = 4;  // chosen, not derived: the clearest carry nearly all information
// Chosen, not derived: share of the fastest speed, as of a poor tachometer.
constexpr double offset_share = 0.01;
constexpr double likely_delay_s = 0.02;  // chosen, not derived: the delay of a velocity filter of 8 Hz
constexpr int most_climbing_steps = 40;  // chosen, not derived; four to eight are usual

/// The maximum next to a start, by scored steps that are shortened until the power rises (Levenberg).
VectorXd climbed(const RipplePower& power, VectorXd unknown) {
    RipplePower::At here = power.at(unknown);
    double damping = 1e-3;
    for (int step = 0; step < most_climbing_steps && damping < 1e9; ++step) {
        MatrixXd bent = here.expected;
        bent.diagonal() *= 1.0 + damping;
        const VectorXd move = SymmetricFactors(bent).solve(here.slope);
        RipplePower::At there = power.at(unknown + move);
        if (!(there.value > here.value)) {
            damping *= 8.0;
            continue;
        }
        const bool done = there.value - here.value < 1e-9 * there.value;
        unknown += move;
        here = std::move(there);
        damping = std::max(1e-6, 0.2 * damping);
        if (done) break;
    }
    return unknown;
}

/// From one deviation to either side as well: a line of a high order has more than one maximum in reach.
VectorXd best_of_starts(const RipplePower& power, const VelocityError& beforehand) {
    VectorXd best = climbed(power, VectorXd::Zero(power.unknowns()));
    double most = power.at(best).value;
    for (const auto& [offset, delay] : {std::pair{-1.0, 0.0}, {1.0, 0.0}, {0.0, -1.0}, {0.0, 1.0}}) {
        VectorXd start = VectorXd::Zero(power.unknowns());
        start[power.offset()] = offset * beforehand.offset_error.value();
        start[power.delay()] = delay * beforehand.delay_error.value();
        const VectorXd end = climbed(power, std::move(start));
        const double value = power.at(end).value;
        if (value > most + 1e-6) {
            most = value;
            best = end;
        }
    }
    return best;
}

double deviation(const MatrixXd& covariance, Eigen::Index one) { return std::sqrt(covariance(one, one)); }

}  // namespace

DegPerSec velocity_noise(const TraceView& log) {
    constexpr double apart_s = 0.01;       // chosen, not derived: sine motion of 2 Hz adds 0.05 % of itself
    constexpr double moving_share = 0.05;  // of the fastest speed: at rest an encoder has no noise
    constexpr std::size_t fewest_rows = 100;  // chosen, not derived: their median is within a tenth
    constexpr double normal_median = 0.6745;  // median magnitude of a normal variable, in standard deviations
    const auto apart = static_cast<std::size_t>(std::max(1.0, std::round(apart_s * log.sample_rate.value())));
    double fastest = 0.0;
    for (const double v : log.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    std::vector<double> differences;
    std::size_t run = 0;  // first row of the run
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (log.starts_run(k)) run = k;
        if (k < run + 3 * apart || std::abs(log.velocity_deg_s[k]) < moving_share * fastest) continue;
        const auto v = [&](std::size_t back) { return log.velocity_deg_s[k - back * apart]; };
        differences.push_back(std::abs(v(0) - 3.0 * v(1) + 3.0 * v(2) - v(3)));
    }
    if (differences.size() < fewest_rows) return DegPerSec(0.0);
    return DegPerSec(median_in(differences) / normal_median / std::sqrt(20.0));
}

std::optional<VelocityFit> fit_velocity_error(std::span<const TraceView> logs, std::span<const Sweep> sweeps,
                                              const Stack& angle, std::span<const double> orders) {
    orders = orders.first(std::min(orders.size(), most_orders));
    double fastest = 0.0;
    std::vector<double> noise_of_log;
    for (const TraceView& log : logs) noise_of_log.push_back(log.has_position() ? 0.0 : summed_noise(log));
    std::vector<DemodulatedSweep> all;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        const Sweep& sweep = sweeps[i];
        fastest = std::max(fastest, sweep.fast_deg_s);
        for (std::size_t n = 0; n < orders.size(); ++n) {
            const auto bin = static_cast<std::size_t>(std::lround(orders[n] / angle.spacing));
            const auto& floors = angle.floors[i];
            if (bin >= floors.size() || !(floors[bin] > 0.0F)) continue;
            all.push_back(demodulated(logs[sweep.log], sweep, orders[n]));
            all.back().sweep = i;
            all.back().order = n;
            all.back().noise = static_cast<double>(floors[bin]);
            all.back().variance_per_s = noise_of_log[sweep.log] / (360.0 * 360.0);
        }
    }
    if (all.empty()) return std::nullopt;
    const VelocityError beforehand{{}, DegPerSec(offset_share * fastest), {}, Seconds(likely_delay_s)};
    const RipplePower power(std::move(all), orders.size(), beforehand);
    const VectorXd best = best_of_starts(power, beforehand);
    const RipplePower::At top = power.at(best);
    const MatrixXd stiffness = -top.curve;
    const SymmetricFactors factors(stiffness);
    if (!(factors.least_pivot() > 0.0)) return std::nullopt;
    const RipplePower::SlopeVariance slopes = power.slope_variance(best);
    const auto between = [&](const MatrixXd& variance) {
        return factors.solve(MatrixXd(factors.solve(variance).transpose()));
    };
    const MatrixXd own = between(slopes.own), common = between(slopes.common), covariance = own + common;
    VelocityFit fit;
    fit.error = {DegPerSec(best[power.offset()]), DegPerSec(deviation(covariance, power.offset())),
                 Seconds(best[power.delay()]), Seconds(deviation(covariance, power.delay()))};
    // At steady speeds the lines carry no information on a delay: the prior value is no finding.
    constexpr double told_share = 0.7;  // chosen, not derived: share of the prior error
    fit.error.delay_told = fit.error.delay_error.value() < told_share * likely_delay_s;
    fit.order_shares.assign(best.begin(), best.begin() + static_cast<Eigen::Index>(orders.size()));
    fit.most_cycles = power.most_cycles(best);
    // The variance of the clearest order beyond what noise of the torque would leave if the other unknowns
    // were known.
    const double alone = slopes.own(0, 0) / (stiffness(0, 0) * stiffness(0, 0));
    fit.order_share_error = std::sqrt(common(0, 0) + std::max(0.0, own(0, 0) - alone));
    return fit;
}

}  // namespace ripplenotch
