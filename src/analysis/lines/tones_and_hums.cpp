// SPDX-License-Identifier: MIT
#include "analysis/lines/tones_and_hums.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>

#include "analysis/shared_limits.hpp"
#include "ripplenotch/analysis/alias.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_samples = 20000;  // by hand: bounds the time
constexpr std::size_t most_folds = 40;       // by hand: bounds the time
constexpr double most_grid = 300.0;          // by hand: bounds the time

double rate_in_orders(Hertz rate, DegPerSec speed) {
    return 360.0 * rate.value() / std::max(std::abs(speed.value()), 1e-9);
}

/// Sweeps that vouch for the seen order, with the noise there; images share it.
struct Witness {
    const Sweep* sweep = nullptr;
    double noise = 0.0;
};

std::vector<Witness> witnesses_of(std::span<const Sweep> sweeps, const Stack& angle, double seen) {
    const auto bin = static_cast<std::size_t>(std::lround(std::max(0.0, seen / angle.spacing)));
    std::vector<std::size_t> by_weight(sweeps.size());
    std::iota(by_weight.begin(), by_weight.end(), std::size_t{0});
    std::stable_sort(by_weight.begin(), by_weight.end(), [&](std::size_t a, std::size_t b) {
        return angle.sweep_weights[a] > angle.sweep_weights[b];
    });
    std::vector<Witness> witnesses;
    std::size_t samples = 0;
    for (const std::size_t i : by_weight) {
        const auto& floors = angle.floors[i];
        if (bin >= floors.size() || floors[bin] <= 0.0F) continue;
        samples += sweeps[i].turns.size();
        if (samples > most_samples) break;
        witnesses.push_back({&sweeps[i], static_cast<double>(floors[bin])});
    }
    return witnesses;
}

double gain_of_comb(std::span<const Witness> witnesses, double order) {
    double most = 0.0, gain = 0.0;
    for (const Witness& witness : witnesses) {
        const double weight = witness.sweep->effective_samples();
        const double power =
            std::norm(fourier_point(witness.sweep->turns, witness.sweep->value, order).value);
        most = std::max(most, weight);
        gain += weight * (power / witness.noise - 1.0);
    }
    return most > 0.0 ? gain / most : 0.0;
}

/// Largest gain between two orders: a grid of a third of a resolution, then halved steps around its best.
Fold best_between(std::span<const Witness> witnesses, double from, double to, double step) {
    step = std::max(step, (to - from) / most_grid);
    Fold best{0.5 * (from + to), -1e300};
    for (double at = std::max(from, step); at <= to; at += step) {
        const double gain = gain_of_comb(witnesses, at);
        if (gain > best.gain) best = {at, gain};
    }
    for (double reach = step / 2.0; reach > step / 200.0; reach /= 2.0) {
        for (const double at : {best.order_output - reach, best.order_output + reach}) {
            const double gain = gain_of_comb(witnesses, at);
            if (gain > best.gain) best = {at, gain};
        }
    }
    return best;
}

}  // namespace

std::vector<Fold> folds_of(std::span<const Sweep> sweeps, const Stack& angle, const SeenOrder& order) {
    const auto [seen, highest] = order;
    const std::vector<Witness> witnesses = witnesses_of(sweeps, angle, seen);
    std::vector<Fold> folds;
    if (witnesses.empty()) return folds;
    const Sweep& heaviest = *witnesses.front().sweep;
    const double slow = rate_in_orders(Hertz(heaviest.rate_hz), DegPerSec(heaviest.slow_deg_s));
    const double quick = rate_in_orders(Hertz(heaviest.rate_hz), DegPerSec(heaviest.quick_deg_s));
    const double step = 0.5 / heaviest.length_turns, reach = 6.0 * step;
    for (double k = 1.0; k * quick - seen <= highest && folds.size() < most_folds; k += 1.0) {
        for (const double side : {-1.0, 1.0}) {
            const double from = k * quick + side * seen - reach, to = k * slow + side * seen + reach;
            // An image that falls on the seen order itself says nothing.
            const bool on_itself = from < seen + 4.0 * angle.resolution && to > seen - 4.0 * angle.resolution;
            if (from < highest && !on_itself) folds.push_back(best_between(witnesses, from, to, step));
        }
    }
    std::stable_sort(folds.begin(), folds.end(),
                     [](const Fold& a, const Fold& b) { return a.gain > b.gain; });
    return folds;
}

double excess_scatter(double squares, double freedom) {
    if (!(freedom >= 1.0)) return 1.0;
    constexpr double normal_99 = 2.3263;  // 99 % quantile of a normal variable
    // 99 % quantile of chi-square by the cube root of Wilson and Hilferty, within 1 % of the exact one.
    const double share = 2.0 / (9.0 * freedom);
    const double limit = freedom * portable::pow(1.0 - share + normal_99 * std::sqrt(share), 3.0);
    return squares > limit ? std::sqrt(squares / freedom) : 1.0;
}

namespace {

constexpr int highest_multiple = 12;          // by hand
constexpr std::size_t fewest_multiples = 3;   // two frequencies are multiples of something always
constexpr double lowest_hz = 1.0;             // by hand: below is motion
constexpr double same_family_share = 0.0025;  // by which tones of one source may miss their multiples

/// A fixed tone and the standard error of its frequency.
struct Tone {
    double hz = 0.0, error_hz = 0.0;
};

struct FoundFamily {
    double hz = 0.0, hz_error = 0.0;
    std::vector<int> multiples;  // ascending
    double nats = 0.0;           // how much likelier than chance, tries counted
};

double allowance_hz(const Tone& tone) { return 4.0 * tone.error_hz + same_family_share * tone.hz; }

/// The family of one frequency, which is fitted to all tones near its multiples.
FoundFamily matched_family(std::span<const Tone> tones, double hz) {
    FoundFamily family;
    std::vector<int> multiple(tones.size());
    for (int round = 0; round < 2; ++round) {
        double top = 0.0, bottom = 0.0;
        for (std::size_t i = 0; i < tones.size(); ++i) {
            const double n = std::round(tones[i].hz / hz), allowed = allowance_hz(tones[i]);
            const bool fits = n >= 1.0 && n <= highest_multiple &&
                              std::abs(tones[i].hz - n * hz) <= allowed * (round == 0 ? n + 1.0 : 1.0);
            multiple[i] = fits ? static_cast<int>(n) : 0;
            if (!fits) continue;
            top += n * tones[i].hz / (allowed * allowed);
            bottom += n * n / (allowed * allowed);
        }
        if (!(bottom > 0.0)) return {};
        hz = top / bottom;
        family.hz_error = 0.25 / std::sqrt(bottom);
    }
    family.hz = hz;
    double most = 0.0;
    int common = 0;
    std::set<int> multiples;
    for (std::size_t i = 0; i < tones.size(); ++i) {
        if (multiple[i] == 0) continue;
        const double nats = -portable::log(std::min(1.0, 2.0 * allowance_hz(tones[i]) / hz));
        family.nats += nats;
        most = std::max(most, nats);
        multiples.insert(multiple[i]);
        common = std::gcd(common, multiple[i]);
    }
    // One tone and the choice of its multiple make the frequency: that one is no evidence.
    const double tries = portable::log(static_cast<double>(tones.size()) * highest_multiple);
    const bool one_source = multiples.size() >= fewest_multiples && common == 1;
    family.nats = one_source ? family.nats - most - tries : 0.0;
    family.multiples.assign(multiples.begin(), multiples.end());
    return family;
}

}  // namespace

std::vector<ToneFamily> families_among(std::span<const Reported> reported) {
    std::vector<Tone> tones;
    for (const Reported& one : reported) {
        if (one.line.kind == LineKind::tone && one.line.hz) tones.push_back({*one.line.hz, one.hz_error});
    }
    FoundFamily best;
    for (const Tone& tone : tones) {
        for (int n = 1; n <= highest_multiple && tone.hz / n >= lowest_hz; ++n) {
            FoundFamily family = matched_family(tones, tone.hz / n);
            if (family.nats > best.nats) best = std::move(family);
        }
    }
    if (best.nats < decisive_nats) return {};
    return {{best.hz, best.hz_error, best.multiples}};
}

namespace {

/// Which multiple of the mains frequency a tone is; 0: none.
int mains_multiple(const Line& line, double mains_hz) {
    constexpr double tolerance = 0.004;  // mains keep within 1 %, nearly always within a fifth of that
    if (line.kind != LineKind::tone || !line.hz) return 0;
    const double n = std::round(*line.hz / mains_hz);
    const bool near = n >= 1.0 && n <= 6.0 && std::abs(*line.hz - n * mains_hz) <= tolerance * n * mains_hz;
    return near ? static_cast<int>(n) : 0;
}

}  // namespace

void name_mains(std::span<Reported> reported) {
    const auto support = [&](double mains_hz) {
        double sum = 0.0;
        for (const Reported& one : reported) {
            if (const int n = mains_multiple(one.line, mains_hz)) sum += one.line.snr / n;
        }
        return sum;
    };
    const double mains_hz = support(60.0) > support(50.0) ? 60.0 : 50.0;
    for (Reported& one : reported) {
        const int n = mains_multiple(one.line, mains_hz);
        if (n == 0) continue;
        const std::string name = n == 1 ? fmt::format("mains {:.0f} Hz", mains_hz)
                                        : fmt::format("{} times mains {:.0f} Hz", n, mains_hz);
        one.line.note = one.line.note.empty() ? name : name + ", " + one.line.note;
    }
}

namespace {

constexpr std::size_t most_hums = 3;  // by hand: a list that a person reads

/// Of humps that overlap, the one with most torque.
void add(const SpectralHump& hump, std::vector<Hum>& hums) {
    const Hum hum{hump.from_hz, hump.to_hz, hump.peak_hz, hump.rms_nm};
    const auto same = std::find_if(hums.begin(), hums.end(), [&](const Hum& known) {
        return known.from_hz <= hum.to_hz && hum.from_hz <= known.to_hz;
    });
    if (same == hums.end()) {
        hums.push_back(hum);
    } else if (hum.rms_nm > same->rms_nm) {
        *same = hum;
    }
}

}  // namespace

std::vector<Hum> hums_beside(const MotionLines& motion, const std::vector<Line>& lines) {
    double ripple_nm = 0.0;
    for (const Line& line : lines) {
        if (line.kind != LineKind::tone) ripple_nm = std::max(ripple_nm, line.amplitude_nm);
    }
    std::vector<Hum> hums;
    // What lines leave of a sweep has no one speed: humps of theirs are smaller than the lines.
    for (const SpectralHump& hump : motion.humps) add(hump, hums);
    // A sine of this amplitude has as much torque in it.
    std::erase_if(hums, [&](const Hum& hum) { return std::sqrt(2.0) * hum.rms_nm <= ripple_nm; });
    std::stable_sort(hums.begin(), hums.end(),
                     [](const Hum& a, const Hum& b) { return a.rms_nm > b.rms_nm; });
    if (hums.size() > most_hums) hums.resize(most_hums);
    return hums;
}

}  // namespace ripplenotch
