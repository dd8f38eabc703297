// SPDX-License-Identifier: MIT
#include "analysis/lines/tones_and_hums.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>

#include "analysis/shared_limits.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
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
