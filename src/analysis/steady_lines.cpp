// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/steady_lines.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ripplenotch {
namespace {

constexpr std::size_t most_peaks = 16;  // per stretch, the clearest
constexpr std::size_t fewest_samples = 64;
constexpr double same_order_share = 0.005;  // scatter of speeds that stretches of one order may show
constexpr double other_speed_share = 0.02;  // speeds further apart are different ones

double median_of(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::vector<StretchLines> measure_stretches(std::span<const TraceView> logs, const SteadyRule& rule,
                                            double false_alarm) {
    std::vector<StretchLines> found;
    for (std::size_t i = 0; i < logs.size(); ++i) {
        for (const Stretch& stretch : steady_stretches(logs[i], rule)) {
            if (stretch.count >= fewest_samples) found.push_back({i, stretch, {}, 0.0, 0.0});
        }
    }
    for (StretchLines& one : found) {
        const TraceView part = logs[one.log].part(one.stretch.first, one.stretch.count);
        Spectrum spectrum = torque_spectrum(part, {{}, false_alarm / static_cast<double>(found.size())});
        std::stable_sort(spectrum.peaks.begin(), spectrum.peaks.end(),
                         [](const SpectralPeak& a, const SpectralPeak& b) { return a.snr > b.snr; });
        if (spectrum.peaks.size() > most_peaks) spectrum.peaks.resize(most_peaks);
        one.peaks = std::move(spectrum.peaks);
        one.floor_nm = median_of(std::move(spectrum.floor_nm));
        one.bin_hz = spectrum.bin_width.value();
    }
    return found;
}

std::vector<Sighting> sightings_of(const std::vector<StretchLines>& stretches) {
    std::vector<Sighting> all;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        const Stretch& stretch = stretches[i].stretch;
        const double speed = stretch.rest ? 0.0 : stretch.speed.value();
        for (const SpectralPeak& peak : stretches[i].peaks) {
            const double share = stretch.rest ? 0.0 : stretch.speed_error_deg_s / std::abs(speed);
            all.push_back({i, peak.hz, peak.hz_stderr, speed, share, peak.amplitude_nm, peak.snr});
        }
    }
    return all;
}

bool same_order(const Sighting& a, const Sighting& b) {
    if (a.speed_deg_s == 0.0 || b.speed_deg_s == 0.0) return false;
    const double order = a.order_output();
    const double speeds = order * std::hypot(a.speed_share_error, b.speed_share_error);
    const double allowed =
        4.0 * std::hypot(a.order_error(), b.order_error(), speeds) + same_order_share * order;
    return std::abs(order - b.order_output()) <= allowed;
}

bool same_tone(const Sighting& a, const Sighting& b, const std::vector<StretchLines>& stretches) {
    const double bin = 0.25 * std::max(stretches[a.stretch].bin_hz, stretches[b.stretch].bin_hz);
    return std::abs(a.hz - b.hz) <= 4.0 * std::hypot(a.hz_error, b.hz_error) + bin;
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
    /// More speeds first; at equal speeds an order before a tone, for every pair of orders 1 and 2 at speeds
    /// 1 : 2 shares a frequency by arithmetic, while tones at related speeds share an order only by accident;
    /// then the clearer.
    bool operator<(const Group& other) const {
        if (speeds != other.speeds) return speeds < other.speeds;
        if (kind != other.kind) return kind == LineKind::tone;
        return clearness < other.clearness;
    }
};

/// The nearest sighting in each stretch that goes with the seed.
template <class Same>
Group grow(LineKind kind, std::size_t seed, const std::vector<Sighting>& all, const std::vector<bool>& used,
           Same same) {
    Group group{kind, {seed}, 0, 0.0};
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
        group.clearness += std::log(std::max(1.0, all[member].snr));
    }
    group.speeds = count_speeds(std::move(speeds));
    return group;
}

std::vector<SteadyLine> grouped(const std::vector<Sighting>& all,
                                const std::vector<StretchLines>& stretches) {
    std::vector<SteadyLine> lines;
    std::vector<bool> used(all.size(), false);
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
        lines.push_back(std::move(line));
    }
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
    found.lines = grouped(sightings_of(found.stretches), found.stretches);
    return found;
}

}  // namespace ripplenotch
