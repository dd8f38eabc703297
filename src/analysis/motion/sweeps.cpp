// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "analysis/lines/encoder.hpp"
#include "core/functions/many_numbers.hpp"
#include "core/process/two_cores.hpp"
#include "core/rows/row_facts.hpp"
#include "ripplenotch/analysis/stretches.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double sweep_smoothing_s = 0.05;  // as models smooth speeds (measured_motion.hpp)

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
    if (log.has_position()) return between_steps(log, unwrapped_position(log));
    return {integrated_velocity(log), false};
}

std::vector<double> smoothed_speed(const TraceView& log) {
    const auto width = static_cast<std::size_t>(sweep_smoothing_s * log.sample_rate.value()) | 1U;
    return moving_mean(log.velocity_deg_s, width);
}

std::vector<SampleRun> directed_runs(std::span<const double> speed_deg_s,
                                     std::span<const std::size_t> run_starts, const RunRule& rule) {
    const double slowest = std::max(rule.slowest_share * fastest_of(speed_deg_s), rule.standstill_deg_s);
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

/// |speed| below which lies a quarter of the weight, and three quarters.
std::pair<double, double> quartiles(std::span<const double> speed, std::span<const double> weight) {
    std::vector<std::pair<double, double>> sorted;
    double all = 0.0, below = 0.0;
    for (std::size_t k = 0; k < speed.size(); ++k) {
        sorted.emplace_back(std::abs(speed[k]), weight[k]);
        all += weight[k];
    }
    std::sort(sorted.begin(), sorted.end());
    auto one = sorted.begin();
    const auto up_to = [&](double share) {
        while (one + 1 != sorted.end() && below + one->second < share) below += (one++)->second;
        return one->first;
    };
    const double lower = up_to(0.25 * all);
    return {lower, up_to(0.75 * all)};
}

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
                 std::span<const double> all_speed) {
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
    weigh_sweep(sweep);
    if (!(sweep.weight_sum > 0.0)) return sweep;
    if (!plan.rest) {
        for (std::size_t k = 0; k < n; ++k) sweep.mean_deg_s += sweep.weight[k] * speed[k] / sweep.weight_sum;
        std::tie(sweep.slow_deg_s, sweep.quick_deg_s) = quartiles(speed, sweep.weight);
    }
    return sweep;
}

/// Takes an offset off a velocity and what was summed from it.
void put_right(const TraceView& log, const VelocityError& error, std::vector<double>& turns,
               std::vector<double>& speed) {
    for (std::size_t k = 0; k < turns.size(); ++k) {
        const double since_start = log.time_s[k] - log.time_s.front();
        turns[k] -= error.offset.value() * since_start / 360.0;
        speed[k] -= error.offset.value();
    }
}

/// The standstill between the runs of a log, in pieces of at most rule.longest_s.
std::vector<SampleRun> rests_of(const TraceView& log, const OutputAngle& angle, std::span<const double> speed,
                                double standstill_deg_s, const SweepRule& rule) {
    // A joint that creeps further is not at rest: a tenth of the cycle of order 1000.
    constexpr double most_turns = 1e-4;
    const auto crept = [&](std::size_t from, std::size_t to) {
        return angle.absolute && std::abs(angle.turns[to] - angle.turns[from]) > most_turns;
    };
    // Chosen, not derived: five cycles of the slowest tone that is reported.
    constexpr double shortest_s = 0.5;
    const auto longest = static_cast<std::size_t>(rule.longest_s * log.sample_rate.value());
    std::vector<SampleRun> rests;
    for (const SampleRun& run : whole_runs(log.size(), log.run_starts)) {
        std::size_t first = run.first;
        for (std::size_t k = run.first; k <= run.end; ++k) {
            const bool still = k < run.end && std::abs(speed[k]) <= standstill_deg_s;
            if (still && k - first < longest && !crept(first, k)) continue;
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
        const double still_deg_s = standstill_deg_s(log, speeds.back());
        for (const SampleRun& run :
             directed_runs(speeds.back(), log.run_starts, {rule.slowest_share, still_deg_s})) {
            for (const SampleRun& piece : pieces_of(run, log, angles.back().turns, rule)) {
                if (piece.end - piece.first >= rule.fewest_samples) planned.push_back({i, piece, false});
            }
        }
        for (const SampleRun& rest : rests_of(log, angles.back(), speeds.back(), still_deg_s, rule)) {
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
        sweeps.pieces[i] = make_sweep(logs[log], planned[i], angles[log].turns, speeds[log]);
    });
    std::erase_if(sweeps.pieces, [](const Sweep& sweep) { return !(sweep.weight_sum > 0.0); });
    return sweeps;
}

}  // namespace ripplenotch
