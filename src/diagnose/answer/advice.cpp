// SPDX-License-Identifier: MIT
#include "diagnose/answer/answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "core/rows/second_log.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

// The catalogue's advice; a general one when it has none.
std::string what_would_tell(const Effect& one, const Effect& other) {
    for (const auto& [effect, rival] : {std::pair(&one, &other), std::pair(&other, &one)}) {
        for (const LookAlike& alike : effect->look_alikes) {
            if (alike.name == rival->name) return std::string(alike.told_by);
        }
    }
    return "a log with rests, both directions, several speeds and a travel of more than a revolution";
}

// Everything that is undecided from this log.
std::set<std::string_view> in_doubt(const Diagnosis& diagnosis) {
    std::set<std::string_view> names;
    for (const Tie& tie : diagnosis.ambiguous) names.insert(tie.effects.begin(), tie.effects.end());
    for (const Finding& finding : diagnosis.rounds)
        if (finding.status == FindingStatus::not_reproduced) names.insert(finding.term.effect->name);
    for (const Undecidable& entry : diagnosis.undecidable)
        if (diagnosis.model.has_gear_ratio() || !needs_gear_ratio(find_effect(entry.effect)))
            names.insert(entry.effect);
    return names;
}

// What another log must have to decide between the uncertain effects.
std::string second_log_of(const Diagnosis& diagnosis, const Motion& motion) {
    const std::set<std::string_view> doubted = in_doubt(diagnosis);
    const auto [low, high] = std::ranges::minmax(motion.position_deg);
    MotionAsked asked{.travel_deg = high - low, .has_position = diagnosis.has_position};
    for (const std::string_view name : doubted) {
        const Effect& effect = find_effect(name);
        asked.direction = asked.direction || effect.domain == Domain::speed || effect.domain == Domain::time;
        asked.speed = asked.speed || effect.domain == Domain::speed || effect.domain == Domain::order;
        asked.position = asked.position || needs_position(effect);
        asked.load = asked.load || effect.uses_load;
    }
    return second_log(motion_seen(motion.velocity_deg_s), asked,
                      std::vector<std::string_view>(doubted.begin(), doubted.end()));
}

constexpr std::array edges_hz = {1.0, 10.0};

std::array<double, 3> rms_by_band(std::span<const double> values, Hertz sample_rate, bool with_mean) {
    std::vector<double> finite(values.begin(), values.end());
    for (double& value : finite) value = std::isfinite(value) ? value : 0.0;
    const auto sums = real_fourier(finite);
    const auto samples = static_cast<double>(finite.size());
    std::array<double, 3> bands{};
    for (std::size_t cell = with_mean ? 0 : 1; cell < sums.size(); ++cell) {
        const double hz = sample_rate.value() / samples * static_cast<double>(cell);
        const bool single = cell == 0 || 2 * cell == finite.size();
        bands[hz < edges_hz[0] ? 0 : (hz < edges_hz[1] ? 1 : 2)] +=
            (single ? 1.0 : 2.0) * std::norm(sums[cell]);
    }
    for (double& band : bands) band = std::sqrt(band) / samples;
    return bands;
}

}  // namespace

std::string_view status_name(FindingStatus status) {
    constexpr std::string_view names[] = {"confirmed", "ambiguous", "correction", "not-reproduced",
                                          "refused"};
    return names[static_cast<std::size_t>(status)];
}

std::string_view verdict_name(DiagnosisVerdict verdict) {
    constexpr std::string_view names[] = {"matches", "explained", "partly-explained", "unexplained",
                                          "undecided"};
    return names[static_cast<std::size_t>(verdict)];
}

std::string_view region_kind_name(RegionKind kind) {
    constexpr std::string_view names[] = {"throughout", "time", "speed", "position", "tone"};
    return names[static_cast<std::size_t>(kind)];
}

bool needs_position(const Effect& effect) {
    constexpr std::array<std::string_view, 5> names = {"gravity", "payload-change", "output-ripple",
                                                       "ripple-modulation", "position-dependent-friction"};
    return std::ranges::find(names, effect.name) != names.end();
}

DiagnosisVerdict verdict_of(const Diagnosis& diagnosis) {
    const bool is_named = !diagnosis.named.empty() || !diagnosis.ambiguous.empty();
    if (!diagnosis.remaining && diagnosis.setup.empty())
        return is_named ? DiagnosisVerdict::explained : DiagnosisVerdict::matches;
    // A fault of the log explains nothing of what is left elsewhere.
    const bool is_found =
        !diagnosis.ambiguous.empty() || std::ranges::any_of(diagnosis.rounds, [](const Finding& finding) {
            return finding.status == FindingStatus::confirmed;
        });
    return is_found ? DiagnosisVerdict::partly_explained : DiagnosisVerdict::unexplained;
}

void name_findings(Diagnosis& diagnosis) {
    auto& named = diagnosis.named;
    const auto name = [&](std::string_view one) {
        if (std::ranges::find(named, one) == named.end()) named.emplace_back(one);
    };
    for (const Fault& fault : diagnosis.faults) name(fault.term.effect->name);
    std::set<std::set<std::string>> ties;
    for (const Finding& finding : diagnosis.rounds) {
        const Effect& effect = *finding.term.effect;
        if (finding.status == FindingStatus::confirmed) name(effect.name);
        if (finding.status != FindingStatus::ambiguous) continue;
        Tie tie{{std::string(effect.name)}, {}};
        for (const RivalFinding& rival : finding.alternatives) {
            if (std::ranges::find(tie.effects, rival.term.effect->name) != tie.effects.end()) continue;
            tie.effects.emplace_back(rival.term.effect->name);
            if (tie.advice.empty()) tie.advice = what_would_tell(effect, *rival.term.effect);
        }
        if (ties.insert({tie.effects.begin(), tie.effects.end()}).second) diagnosis.ambiguous.push_back(tie);
    }
}

std::vector<std::string> next_steps(const Diagnosis& diagnosis, const Motion& motion) {
    if (!diagnosis.setup.empty()) {
        const std::string& option = diagnosis.setup.front().option;
        return {"correct the set-up" + (option.empty() ? "" : fmt::format(" ({})", option)) +
                " and diagnose again"};
    }
    std::vector<std::string> steps;
    for (const Tie& tie : diagnosis.ambiguous) {
        const auto accept = [](const std::string& side) { return "--accept " + side; };
        steps.push_back(fmt::format("{}: {} would decide; {} selects one", joined(tie.effects, " or "),
                                    tie.advice, joined(tie.effects, " or ", accept)));
    }
    if (std::string words = second_log_of(diagnosis, motion); !words.empty())
        steps.push_back(std::move(words));
    return steps;
}

std::string why_not_accepted(const Diagnosis& diagnosis, const std::string& name) {
    std::set<std::string> uncertain;
    for (const Tie& tie : diagnosis.ambiguous) uncertain.insert(tie.effects.begin(), tie.effects.end());
    for (const RefusedCandidate& refused : diagnosis.refused) uncertain.emplace(refused.term.effect->name);
    const std::string list = joined(uncertain, ", ");
    const bool is_named = std::ranges::find(diagnosis.named, name) != diagnosis.named.end();
    return fmt::format(
        "--accept {}: {}; uncertain findings: {}", name,
        is_named ? "it is confirmed, and in the model already" : "this log gives no finding of that name",
        list.empty() ? "nothing" : list);
}

std::vector<BandGap> band_gaps(std::span<const double> torque_nm, std::span<const double> beside_given_nm,
                               std::span<const double> after_nm, Hertz sample_rate) {
    const auto torque = rms_by_band(torque_nm, sample_rate, false),
               beside = rms_by_band(beside_given_nm, sample_rate, true),
               after = rms_by_band(after_nm, sample_rate, true);
    std::vector<BandGap> bands = {
        {0.0, edges_hz[0], 0, 0, 0}, {edges_hz[0], edges_hz[1], 0, 0, 0}, {edges_hz[1], 0.0, 0, 0, 0}};
    for (std::size_t b = 0; b < bands.size(); ++b) {
        bands[b].torque_nm = torque[b];
        bands[b].beside_given_nm = beside[b];
        bands[b].after_nm = after[b];
    }
    return bands;
}

}  // namespace ripplenotch
