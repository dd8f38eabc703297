// SPDX-License-Identifier: MIT
#include "analysis/steady/tone_family.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr int highest_multiple = 12;         // by hand
constexpr std::size_t fewest_multiples = 3;  // two frequencies are multiples of something always
constexpr double lowest_hz = 1.0;            // by hand: below is motion
// In nats: what a further multiple costs (one of some twelve), and a tone that should be seen and is not.
const double multiple_nats = portable::log(static_cast<double>(highest_multiple));
constexpr double missing_nats = 3.0;          // by hand: odds of 20 to 1
constexpr double least_nats = 5.0;            // by hand: odds of 150 to 1
constexpr double seen_over_floor = 4.5;       // amplitude over the floor of a line at the 1 % level
constexpr double clearly = 1.5;               // by hand: times what is just seen
constexpr double same_order_share = 0.005;    // scatter of speeds that stretches of one order may show
constexpr double same_family_share = 0.0025;  // by which tones of one source may miss their multiples
constexpr double chance_of_accident = 0.02;   // of an order seen at two speeds

double band_hz(const Sighting& seen) { return 0.5 * seen.rate_hz; }

/// A stretch in which an amplitude would have been a line.
bool would_show(const StretchLines& stretch, double amplitude_nm) {
    return amplitude_nm > clearly * seen_over_floor * stretch.floor_nm;
}

struct FoundFamily {
    double hz = 0.0, hz_error = 0.0;
    std::vector<std::optional<int>> multiple;  // by sighting; empty where it is none of the family
    double nats = 0.0;                         // how much likelier than chance, tries counted
};

struct Member {
    double hz = 0.0, allowance_hz = 0.0, amplitude_nm = 0.0, highest_hz = 0.0;
    std::size_t stretch = 0;
};

std::vector<Member> members_of(std::span<const Sighting> all, std::span<const StretchLines> stretches) {
    std::vector<Member> members;
    for (const Sighting& seen : all) {
        members.push_back({seen.hz, 4.0 * seen.hz_error + 0.25 * stretches[seen.stretch].bin_hz,
                           seen.amplitude_nm, band_hz(seen), seen.stretch});
    }
    return members;
}

FoundFamily matched_family(const std::vector<Member>& members, double hz) {
    FoundFamily family;
    family.multiple.resize(members.size());
    // Its own frequency from all that lie near a multiple, once more with the better value.
    for (int round = 0; round < 2; ++round) {
        double top = 0.0, bottom = 0.0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            const Member& one = members[i];
            const double n = std::round(one.hz / hz);
            const bool fits = n >= 1.0 && n <= highest_multiple &&
                              std::abs(one.hz - n * hz) <= one.allowance_hz * (round == 0 ? n + 1.0 : 1.0);
            family.multiple[i] = fits ? std::optional(static_cast<int>(n)) : std::nullopt;
            if (!fits) continue;
            const double weight = n * n / (one.allowance_hz * one.allowance_hz);
            top += weight * one.hz / n;
            bottom += weight;
        }
        if (!(bottom > 0.0)) return {};
        hz = top / bottom;
        family.hz_error = 0.25 / std::sqrt(bottom);
    }
    family.hz = hz;
    return family;
}

/// What the members say for a family, without the tones that it should show and does not.
double nats_of_members(const std::vector<Member>& members, const FoundFamily& family,
                       double nats_for_multiple, std::set<int>& multiples) {
    double nats = 0.0, most = 0.0;
    int common = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
        if (!family.multiple[i]) continue;
        const double gain = -portable::log(std::min(1.0, 2.0 * members[i].allowance_hz / family.hz));
        nats += gain;
        most = std::max(most, gain);
        multiples.insert(*family.multiple[i]);
        common = std::gcd(common, *family.multiple[i]);
    }
    if (multiples.size() < fewest_multiples || common != 1) return 0.0;
    // One member and the choice of its multiple make the frequency: that one is no evidence.
    const double tries = portable::log(static_cast<double>(members.size()) * highest_multiple);
    return nats - most - tries - nats_for_multiple * static_cast<double>(multiples.size());
}

double nats_missing(const std::vector<Member>& members, const FoundFamily& family,
                    const std::set<int>& multiples, std::span<const StretchLines> stretches) {
    double nats = 0.0;
    for (const int n : multiples) {
        double amplitude = 0.0, count = 0.0, highest = 0.0;
        std::set<std::size_t> there;
        for (std::size_t i = 0; i < members.size(); ++i) {
            if (family.multiple[i] != n) continue;
            amplitude += members[i].amplitude_nm;
            count += 1.0;
            highest = members[i].highest_hz;
            there.insert(members[i].stretch);
        }
        for (std::size_t s = 0; s < stretches.size(); ++s) {
            const bool missing =
                !there.contains(s) && n * family.hz < highest && would_show(stretches[s], amplitude / count);
            if (missing) nats += missing_nats;
        }
    }
    return nats;
}

FoundFamily best_family(const std::vector<Member>& members, double nats_for_multiple,
                        std::span<const StretchLines> stretches) {
    FoundFamily best;
    for (const Member& first : members) {
        for (int n = 1; n <= highest_multiple && first.hz / n >= lowest_hz; ++n) {
            FoundFamily family = matched_family(members, first.hz / n);
            if (!(family.hz > 0.0)) continue;
            std::set<int> multiples;
            family.nats = nats_of_members(members, family, nats_for_multiple, multiples);
            if (family.nats <= best.nats) continue;
            family.nats -= nats_missing(members, family, multiples, stretches);
            if (family.nats > best.nats) best = std::move(family);
        }
    }
    return best;
}

/// Of three multiples or more; a tone that a stretch should show and does not counts against it.
std::optional<FoundFamily> find_family(std::span<const Sighting> all,
                                       std::span<const StretchLines> stretches) {
    FoundFamily best = best_family(members_of(all, stretches), multiple_nats, stretches);
    if (best.nats < least_nats) return std::nullopt;
    return best;
}

/// Evidence that a line turns with the joint: each sighting beyond its first by how unlikely it meets the
/// order by chance, stretches that should show the line and do not counted against it.
double nats_of_order(const SteadyLine& line, std::span<const Sighting> all,
                     std::span<const StretchLines> stretches) {
    const Sighting& first = line.sightings.front();
    double nats = 0.0, amplitude = 0.0;
    std::set<std::size_t> there;
    for (const Sighting& seen : line.sightings) {
        amplitude += seen.amplitude_nm / static_cast<double>(line.sightings.size());
        there.insert(seen.stretch);
        if (&seen == &first) continue;
        const auto beside = std::count_if(
            all.begin(), all.end(), [&](const Sighting& other) { return other.stretch == seen.stretch; });
        const double chance =
            2.0 * order_allowance_hz(first, seen) * static_cast<double>(beside) / band_hz(seen);
        nats -= portable::log(std::min(1.0, chance));
    }
    for (std::size_t s = 0; s < stretches.size(); ++s) {
        if (stretches[s].stretch.rest || there.contains(s)) continue;
        const double hz = first.order_output() * std::abs(stretches[s].stretch.speed.value()) / 360.0;
        if (hz > lowest_hz && hz < band_hz(first) && would_show(stretches[s], amplitude))
            nats -= missing_nats;
    }
    return nats;
}

/// That so many pairs of unrelated lines of two speeds, or more, share an order.
double chance_of_shared_orders(std::size_t seen, const SteadyLine& line, std::span<const Sighting> all) {
    const Sighting &first = line.sightings.front(), &second = line.sightings.back();
    double here = 0.0, there = 0.0;
    for (const Sighting& other : all) {
        here += other.stretch == first.stretch ? 1.0 : 0.0;
        there += other.stretch == second.stretch ? 1.0 : 0.0;
    }
    const double expected = here * there * 2.0 * order_allowance_hz(first, second) / band_hz(second);
    // Poisson: 1 - sum of the terms below `seen`.
    double term = portable::exp(-expected), below = 0.0;
    for (std::size_t k = 0; k < seen; ++k) {
        below += term;
        term *= expected / static_cast<double>(k + 1);
    }
    return std::max(0.0, 1.0 - below);
}

}  // namespace

double order_allowance_hz(const Sighting& first, const Sighting& second) {
    const double order = first.order_output();
    const double speeds = order * portable::hypot(first.speed_share_error, second.speed_share_error);
    const double allowed =
        4.0 * portable::hypot(first.order_error(), second.order_error(), speeds) + same_order_share * order;
    return allowed * std::abs(second.speed_deg_s) / 360.0;
}

std::vector<SteadyLine> tones_instead(std::span<const Sighting> all, std::span<const StretchLines> stretches,
                                      std::span<const SteadyLine> lines, std::vector<bool>& used) {
    const auto family = find_family(all, stretches);
    if (!family) return {};
    const auto of_family = [&](const Sighting& seen) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (all[i].stretch == seen.stretch && all[i].seen_hz == seen.seen_hz)
                return family->multiple[i].has_value();
        }
        return false;
    };
    double nats = 0.0;
    for (const SteadyLine& line : lines) {
        if (line.kind != LineKind::order && line.kind != LineKind::alias) continue;
        const auto shared = std::count_if(line.sightings.begin(), line.sightings.end(), of_family);
        if (2 * static_cast<std::size_t>(shared) >= line.sightings.size())
            nats += nats_of_order(line, all, stretches);
    }
    if (nats >= family->nats) return {};
    std::vector<SteadyLine> tones;
    for (int n = 1; n <= *std::max_element(family->multiple.begin(), family->multiple.end()); ++n) {
        SteadyLine tone{LineKind::tone, false, {}};
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (family->multiple[i] != n) continue;
            tone.sightings.push_back(all[i]);
            used[i] = true;
        }
        if (!tone.sightings.empty()) tones.push_back(std::move(tone));
    }
    return tones;
}

void part_accidents(std::span<const Sighting> all, std::vector<SteadyLine>& lines) {
    std::vector<SteadyLine> kept;
    const auto of_two = [](const SteadyLine& line) {
        return line.kind == LineKind::order && line.sightings.size() == 2;
    };
    const auto pairs = static_cast<std::size_t>(std::count_if(lines.begin(), lines.end(), of_two));
    for (SteadyLine& line : lines) {
        if (!of_two(line) || chance_of_shared_orders(pairs, line, all) < chance_of_accident) {
            kept.push_back(std::move(line));
            continue;
        }
        for (const Sighting& seen : line.sightings) kept.push_back({LineKind::unknown, true, {seen}});
    }
    lines = std::move(kept);
}

std::optional<ToneFamily> family_of(std::span<const Tone> tones) {
    std::vector<Member> members;
    for (std::size_t i = 0; i < tones.size(); ++i)
        members.push_back(
            {tones[i].hz, 4.0 * tones[i].error_hz + same_family_share * tones[i].hz, 0.0, 0.0, i});
    const FoundFamily best = best_family(members, 0.0, {});
    if (best.nats < least_nats) return std::nullopt;
    ToneFamily family{best.hz, best.hz_error, {}};
    for (const auto& n : best.multiple) {
        if (n) family.multiples.push_back(*n);
    }
    std::sort(family.multiples.begin(), family.multiples.end());
    return family;
}

}  // namespace ripplenotch
