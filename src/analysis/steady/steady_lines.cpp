// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/steady_lines.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "analysis/steady/likely_offset.hpp"
#include "analysis/steady/steady_offset.hpp"
#include "analysis/steady/tone_family.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/alias.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_peaks = 16;      // per stretch, the clearest
constexpr std::size_t fewest_samples = 64;  // as for a spectrum
constexpr double same_fold_share = 0.0005;  // the same for orders beyond half the sample rate: many are tried
constexpr double chance_of_fold = 0.01;     // by hand: as the false alarms allowed by default
constexpr double highest_folded_order = 1000.0;  // by hand: per output turn
constexpr double other_speed_share = 0.02;       // speeds further apart are different ones

std::vector<StretchLines> measure_stretches(std::span<const TraceView> logs, const SteadyRule& rule,
                                            double false_alarm) {
    std::vector<StretchLines> found;
    for (std::size_t i = 0; i < logs.size(); ++i) {
        for (const Stretch& stretch : steady_stretches(logs[i], rule)) {
            if (stretch.count >= fewest_samples) found.push_back({i, stretch, {}, {}, 0.0, 0.0});
        }
    }
    on_two_cores(found.size(), [&](std::size_t i) {
        StretchLines& one = found[i];
        const TraceView part = logs[one.log].part(one.stretch.first, one.stretch.count);
        Spectrum spectrum = torque_spectrum(part, {{}, false_alarm / static_cast<double>(found.size())});
        std::stable_sort(spectrum.peaks.begin(), spectrum.peaks.end(),
                         [](const SpectralPeak& a, const SpectralPeak& b) { return a.snr > b.snr; });
        if (spectrum.peaks.size() > most_peaks) spectrum.peaks.resize(most_peaks);
        one.peaks = std::move(spectrum.peaks);
        one.humps = std::move(spectrum.humps);
        one.floor_nm = median_of(std::move(spectrum.floor_nm));
        one.bin_hz = spectrum.bin_width.value();
    });
    return found;
}

std::vector<Sighting> sightings_of(std::span<const TraceView> logs,
                                   const std::vector<StretchLines>& stretches) {
    std::vector<Sighting> all;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        const Stretch& stretch = stretches[i].stretch;
        const TraceView& log = logs[stretches[i].log];
        const double speed = stretch.rest ? 0.0 : stretch.speed.value();
        for (const SpectralPeak& peak : stretches[i].peaks) {
            const double share = stretch.rest ? 0.0 : stretch.speed_error_deg_s / std::abs(speed);
            all.push_back({i, peak.hz, peak.hz_stderr, speed, share, peak.amplitude_nm, peak.snr,
                           log.sample_rate.value(), peak.hz, !log.has_position()});
        }
    }
    return all;
}

bool same_order(const Sighting& a, const Sighting& b) {
    if (a.speed_deg_s == 0.0 || b.speed_deg_s == 0.0) return false;
    const double hz = a.order_output() * std::abs(b.speed_deg_s) / 360.0;
    return std::abs(hz - b.hz) <= order_allowance_hz(a, b);
}

bool same_tone(const Sighting& a, const Sighting& b, const std::vector<StretchLines>& stretches) {
    const double bin = 0.25 * std::max(stretches[a.stretch].bin_hz, stretches[b.stretch].bin_hz);
    return std::abs(a.hz - b.hz) <= 4.0 * portable::hypot(a.hz_error, b.hz_error) + bin;
}

std::size_t count_speeds(std::vector<double> speeds) {
    for (double& speed : speeds) speed = std::abs(speed);
    std::sort(speeds.begin(), speeds.end());
    std::size_t count = 0;
    double last = -1.0;
    for (const double speed : speeds) {
        if (count > 0 && speed <= last * (1.0 + other_speed_share)) continue;
        last = speed;
        ++count;
    }
    return count;
}

struct Group {
    LineKind kind = LineKind::unknown;
    std::vector<std::size_t> members;  // indices of sightings
    std::size_t speeds = 0;
    double clearness = 0.0;
    double order = 0.0;  // of an alias, unfolded
    /// More speeds first; at equal speeds an order before a tone, for every pair of orders 1 and 2 at speeds
    /// 1 : 2 shares a frequency by arithmetic, while tones at related speeds share an order only by accident;
    /// a folded order last, for many are tried; then the clearer.
    bool operator<(const Group& other) const {
        if (speeds != other.speeds) return speeds < other.speeds;
        const auto rank = [](LineKind k) { return k == LineKind::order ? 2 : k == LineKind::tone ? 1 : 0; };
        if (kind != other.kind) return rank(kind) < rank(other.kind);
        return clearness < other.clearness;
    }
};

/// The nearest sighting in each stretch that goes with the seed.
template <class Same>
Group grow(LineKind kind, std::size_t seed, const std::vector<Sighting>& all, const std::vector<bool>& used,
           Same same) {
    Group group{kind, {seed}, 0, 0.0, 0.0};
    std::vector<std::optional<std::size_t>> nearest;
    for (std::size_t j = 0; j < all.size(); ++j) {
        if (used[j] || all[j].stretch == all[seed].stretch || !same(all[seed], all[j])) continue;
        nearest.resize(std::max(nearest.size(), all[j].stretch + 1));
        auto& best = nearest[all[j].stretch];
        if (!best || all[j].snr > all[*best].snr) best = j;
    }
    for (const auto& member : nearest) {
        if (member) group.members.push_back(*member);
    }
    std::vector<double> speeds;
    for (const std::size_t member : group.members) {
        speeds.push_back(all[member].speed_deg_s);
        group.clearness += portable::log(std::max(1.0, all[member].snr));
    }
    group.speeds = count_speeds(std::move(speeds));
    return group;
}

/// What an order beyond half the sample rate would show in a stretch: distance to the sighting over what is
/// allowed.
struct FoldedMatch {
    double hz = 0.0;  ///< unfolded
    double share = 1e300;
    double chance = 1.0;  ///< that a line at any frequency lies as near
};

FoldedMatch match_folded(double order, double order_error, const Sighting& seen) {
    const double hz = order * std::abs(seen.speed_deg_s) / 360.0;
    const double allowed =
        4.0 * portable::hypot(seen.hz_error, hz * seen.speed_share_error, hz * order_error / order) +
        same_fold_share * hz;
    const double off = folded_hz({.hz = hz, .rate_hz = seen.rate_hz}) - seen.seen_hz;
    return {hz, std::abs(off) / allowed, std::min(1.0, 4.0 * allowed / seen.rate_hz)};
}

/// An order beyond half the sample rate that explains sightings at three speeds or more, none of which shares
/// its seen order with the others; so unlikely by chance, all the unfoldings that were tried counted.
Group grow_folded(std::size_t seed, const std::vector<Sighting>& all, const std::vector<bool>& used) {
    Group best;
    const Sighting& first = all[seed];
    const auto orders = unfolded_orders({.seen = first.order_output(), .highest = highest_folded_order},
                                        Hertz(first.rate_hz), DegPerSec(first.speed_deg_s));
    for (const double order : orders) {
        const double hz = order * std::abs(first.speed_deg_s) / 360.0;
        const double error =
            order * portable::hypot(first.hz_error / hz, first.speed_share_error, 0.5 * same_fold_share);
        Group group{LineKind::alias, {seed}, 0, 0.0, order};
        std::vector<double> speeds{first.speed_deg_s};
        double chance = static_cast<double>(orders.size());
        for (std::size_t stretch = 0; stretch <= all.back().stretch; ++stretch) {
            std::optional<std::size_t> nearest;
            std::size_t there = 0;
            FoldedMatch match;
            for (std::size_t j = 0; j < all.size(); ++j) {
                const Sighting& seen = all[j];
                if (used[j] || seen.stretch != stretch || stretch == first.stretch || seen.speed_deg_s == 0.0)
                    continue;
                ++there;
                const FoldedMatch one = match_folded(order, error, seen);
                if (one.share > 1.0 || one.share >= match.share) continue;
                match = one;
                nearest = j;
            }
            if (!nearest) continue;
            chance *= std::min(1.0, match.chance * static_cast<double>(there));
            group.members.push_back(*nearest);
            speeds.push_back(all[*nearest].speed_deg_s);
        }
        group.speeds = count_speeds(std::move(speeds));
        group.clearness = -portable::log(chance);
        if (group.speeds >= 3 && chance < chance_of_fold && best < group) best = std::move(group);
    }
    return best;
}

/// Puts the sightings at the frequencies whose images they are.
void unfold_line(SteadyLine& line, double order) {
    for (Sighting& seen : line.sightings) {
        const double hz = order * std::abs(seen.speed_deg_s) / 360.0;
        const double turns = std::round(hz / seen.rate_hz);
        seen.hz = turns * seen.rate_hz + std::copysign(seen.seen_hz, hz - turns * seen.rate_hz);
    }
}

std::vector<SteadyLine> grouped(const std::vector<Sighting>& all, const std::vector<StretchLines>& stretches,
                                std::vector<bool> used) {
    std::vector<SteadyLine> lines;
    while (true) {
        Group best;
        for (std::size_t seed = 0; seed < all.size(); ++seed) {
            if (used[seed]) continue;
            if (all[seed].speed_deg_s != 0.0)
                best = std::max(best, grow(LineKind::order, seed, all, used, same_order));
            const auto tone = [&](const Sighting& a, const Sighting& b) {
                return same_tone(a, b, stretches);
            };
            best = std::max(best, grow(LineKind::tone, seed, all, used, tone));
            if (all[seed].speed_deg_s != 0.0) best = std::max(best, grow_folded(seed, all, used));
        }
        if (best.members.empty()) return lines;
        SteadyLine line;
        std::sort(best.members.begin(), best.members.end());
        for (const std::size_t member : best.members) {
            used[member] = true;
            line.sightings.push_back(all[member]);
        }
        // At rest nothing turns: what is seen there is a tone, even if it is seen nowhere else.
        const bool at_rest = std::any_of(line.sightings.begin(), line.sightings.end(),
                                         [](const Sighting& seen) { return seen.speed_deg_s == 0.0; });
        line.kind = at_rest ? LineKind::tone : best.speeds > 1 ? best.kind : LineKind::unknown;
        if (line.kind == LineKind::alias) unfold_line(line, best.order);
        lines.push_back(std::move(line));
    }
}

void find_lines(const std::vector<Sighting>& all, SteadyLines& found) {
    std::vector<bool> used(all.size(), false);
    found.lines = grouped(all, found.stretches, used);
    std::vector<SteadyLine> tones = tones_instead(all, found.stretches, found.lines, used);
    if (!tones.empty()) {
        found.lines = grouped(all, found.stretches, used);
        std::move(tones.begin(), tones.end(), std::back_inserter(found.lines));
    }
    part_accidents(all, found.lines);
}

}  // namespace

double Sighting::order_output() const { return 360.0 * hz / std::abs(speed_deg_s); }
double Sighting::order_error() const { return 360.0 * hz_error / std::abs(speed_deg_s); }

SteadyLines find_steady_lines(std::span<const TraceView> logs, const SteadyRule& rule, double false_alarm) {
    SteadyLines found;
    found.stretches = measure_stretches(logs, rule, false_alarm);
    std::vector<double> speeds;
    for (const StretchLines& one : found.stretches) {
        (one.stretch.rest ? found.resting : found.moving) += 1;
        if (!one.stretch.rest) speeds.push_back(one.stretch.speed.value());
    }
    found.speeds = count_speeds(std::move(speeds));
    std::vector<Sighting> all = sightings_of(logs, found.stretches);
    const DegPerSec likely = likely_offset(all);
    take_off(likely, all);
    find_lines(all, found);
    found.offset = steady_offset(found.lines, likely);
    for (SteadyLine& line : found.lines)
        take_off(found.offset ? found.offset->offset - likely : DegPerSec(0.0), line.sightings);
    return found;
}

}  // namespace ripplenotch
