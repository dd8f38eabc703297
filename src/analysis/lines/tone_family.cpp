// SPDX-License-Identifier: MIT
#include "analysis/lines/tone_family.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "analysis/shared_limits.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr int highest_multiple = 12;          // by hand
constexpr std::size_t fewest_multiples = 3;   // two frequencies are multiples of something always
constexpr double lowest_hz = 1.0;             // by hand: below is motion
constexpr double same_family_share = 0.0025;  // by which tones of one source may miss their multiples

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

std::optional<ToneFamily> family_of(std::span<const Tone> tones) {
    FoundFamily best;
    for (const Tone& tone : tones) {
        for (int n = 1; n <= highest_multiple && tone.hz / n >= lowest_hz; ++n) {
            FoundFamily family = matched_family(tones, tone.hz / n);
            if (family.nats > best.nats) best = std::move(family);
        }
    }
    if (best.nats < decisive_nats) return std::nullopt;
    return ToneFamily{best.hz, best.hz_error, best.multiples};
}

}  // namespace ripplenotch
