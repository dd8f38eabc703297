// SPDX-License-Identifier: MIT
// The only place where a verdict becomes text.
#include "ripplenotch/analysis/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

/// "1", "1 and 2", "1, 2 and 4".
std::string listed(const std::vector<std::string>& words) {
    if (words.size() < 2) return words.empty() ? "" : words.front();
    std::string text = words.front();
    for (std::size_t i = 1; i + 1 < words.size(); ++i) text += ", " + words[i];
    return text + " and " + words.back();
}

std::string speeds(double from, double to) {
    return to - from < 0.02 * to ? fmt::format("{:.3g} deg/s", to)
                                 : fmt::format("{:.3g} to {:.3g} deg/s", from, to);
}

/// Zero to peak, in Nm, with the decimals that its error deserves, that of the noise beside the line: at most
/// two, but of less than 0.1 Nm two digits.
std::string amplitude_text(const Line& line) {
    const double error = line.snr > 0.0 ? line.amplitude_nm / line.snr : 0.0;
    const int most = line.amplitude_nm > 0.0 ? std::max(2, decimals_of(line.amplitude_nm, 2)) : 2;
    return rounded(line.amplitude_nm, error > 0.0 ? std::min(most, decimals_of(error, 1)) : most);
}

/// "3 sweeps over 5 output turns at 60 to 180 deg/s"
std::string basis(const Grounds& grounds) {
    const std::string at = speeds(grounds.slowest_deg_s, grounds.fastest_deg_s);
    return fmt::format("{} over {:.3g} output turn{} at {}", how_many(grounds.sweeps, "sweep"),
                       grounds.sweep_turns, fmt::format("{:.3g}", grounds.sweep_turns) == "1" ? "" : "s", at);
}

std::string order_or_tone(const Grounds& grounds) {
    constexpr double one_speed = 0.05;  // chosen, not derived: share of the fastest
    const bool one = grounds.fastest_deg_s - grounds.slowest_deg_s < one_speed * grounds.fastest_deg_s;
    return fmt::format("; {} an order or a tone; record another speed to decide",
                       one ? "only one speed, so a line is" : "at these speeds a line may be");
}

bool seen_at_rest(const Line& line) {
    return std::any_of(line.by_speed.begin(), line.by_speed.end(),
                       [](const AmplitudeAtSpeed& at) { return at.speed_deg_s == 0.0; });
}

/// The result of the stretches at standstill.
std::string at_rest(const Identification& found) {
    if (found.grounds.rests == 0) return "";
    std::vector<std::string> seen;
    for (const Line& line : found.lines) {
        if (seen_at_rest(line) && line.hz) seen.push_back(fmt::format("{:.4g} Hz", *line.hz));
    }
    return seen.empty() ? "; no line at rest" : "; at rest " + listed(seen);
}

std::vector<const Line*> of_kind(const Identification& found, LineKind kind) {
    std::vector<const Line*> lines;
    for (const Line& line : found.lines) {
        if (line.kind == kind) lines.push_back(&line);
    }
    return lines;
}

std::string tones_too(const Identification& found) {
    constexpr std::size_t most = 3;  // chosen, not derived: a sentence that a person reads
    std::vector<std::string> words;
    for (const Line* line : of_kind(found, LineKind::tone)) {
        if (!seen_at_rest(*line) && words.size() < most)
            words.push_back(
                fmt::format("{:.4g} Hz{}", *line->hz, line->note.empty() ? "" : " (" + line->note + ")"));
    }
    return words.empty() ? "" : "; fixed tones at " + listed(words);
}

std::string line_in_words(const Disagreement& one) {
    return one.order ? fmt::format("order {:g}", *one.order)
                     : fmt::format("output order {:.5g}", *one.order_output);
}

/// "; the recordings disagree: order 1 from 0.38 to 0.96 Nm"
std::string disagreements_too(const Identification& found) {
    std::vector<std::string> words;
    for (const Disagreement& one : found.disagreements) {
        const auto [least, most] = std::minmax_element(
            one.values.begin(), one.values.end(),
            [](const Disagreement::Value& a, const Disagreement::Value& b) { return a.value < b.value; });
        if (one.about == Disagreement::About::ratio) {
            words.push_back(fmt::format("gear ratio from {:.6g} to {:.6g}", least->value, most->value));
        } else {
            words.push_back(
                fmt::format("{} from {:.2g} to {:.2g} Nm", line_in_words(one), least->value, most->value));
        }
    }
    return words.empty() ? "" : "; the recordings disagree: " + listed(words);
}

std::string besides(const Identification& found) { return tones_too(found) + disagreements_too(found); }

/// Which of two combs is the ratio depends on which spline drives the joint: the lines do not show it.
std::string of_both_splines(const GearRatioFit& ratio, int decimals) {
    if (!ratio.second_comb) return "";
    return fmt::format(
        "; lines of both splines: {:.{}f} and {:.{}f} turns of the wave generator a turn of the joint (the "
        "ratio is the {} where the {} spline is the output)",
        std::min(*ratio.value, *ratio.second_comb), decimals, std::max(*ratio.value, *ratio.second_comb),
        decimals, *ratio.second_comb > *ratio.value ? "larger" : "smaller",
        *ratio.second_comb > *ratio.value ? "circular" : "flexible");
}

/// "100.00 (0.73), 50.00 (0.21)", with their probabilities.
std::string candidates(const Identification& found) {
    constexpr std::size_t most = 4;  // chosen, not derived: a sentence that a person reads
    const auto& all = found.gear_ratio.candidates;
    return joined(std::span(all).first(std::min(most, all.size())), ", ", [](const RatioCandidate& one) {
        return fmt::format("{:.2f} ({:.2f})", one.value, one.score);
    });
}

std::string with_ratio(const Identification& found) {
    std::vector<const Line*> lines;
    for (const Line& line : found.lines) {
        if (line.order) lines.push_back(&line);
    }
    const std::size_t all_lines = lines.size();
    constexpr std::size_t most = 4;  // chosen, not derived: a sentence that a person reads
    if (all_lines > most) {
        std::partial_sort(lines.begin(), lines.begin() + most, lines.end(),
                          [](const Line* a, const Line* b) { return a->amplitude_nm > b->amplitude_nm; });
        lines.resize(most);
    }
    const auto of_other_spline = [&found](const Line& line) {
        const std::string words = order_in_words(Order(*line.order), GearRatio(*found.gear_ratio.value));
        return words.find("other spline") != std::string::npos ? words : std::string();
    };
    std::sort(lines.begin(), lines.end(), [&](const Line* a, const Line* b) {
        return std::pair(!of_other_spline(*a).empty(), *a->order) <
               std::pair(!of_other_spline(*b).empty(), *b->order);
    });
    std::vector<std::string> orders, others, amplitudes;
    for (const Line* line : lines) {
        const std::string words = of_other_spline(*line);
        if (words.empty())
            orders.push_back(fmt::format("{:.4g}", *line->order));
        else
            others.push_back(words);
        amplitudes.push_back(amplitude_text(*line));
    }
    std::vector<std::string> places;
    if (!orders.empty())
        places.push_back(
            fmt::format("order{} {} of the motor", orders.size() == 1 ? "" : "s", listed(orders)));
    if (!others.empty()) places.push_back(listed(others));
    std::vector<std::string> doubted;  // may be tones
    for (const Line* line : lines) {
        if (line->kind == LineKind::unknown) doubted.push_back(fmt::format("{:.4g}", *line->order));
    }
    const bool all_doubted = std::none_of(lines.begin(), lines.end(),
                                          [](const Line* line) { return line->kind == LineKind::order; });
    std::string doubt;
    if (all_doubted) {
        doubt = order_or_tone(found.grounds);
    } else if (!doubted.empty()) {
        doubt = fmt::format("; order{} {} or tone{}: record another speed to decide",
                            doubted.size() == 1 ? "" : "s", listed(doubted), doubted.size() == 1 ? "" : "s");
    }
    if (all_lines > lines.size())
        doubt += fmt::format("; and {}", how_many(all_lines - lines.size(), "fainter line"));
    const GearRatioFit& ratio = found.gear_ratio;
    if (const double probability = ratio.candidates.front().score; probability <= conclusive_probability)
        doubt += fmt::format("; the ratio has a probability of {:.2f}: {}", probability, candidates(found));
    const double half = 0.5 * (ratio.ci95_high - ratio.ci95_low);
    const int decimals = half < 0.005 ? 4 : half < 0.05 ? 3 : half < 0.5 ? 2 : 1;
    const std::string subject = !all_doubted        ? "Ripple"
                                : lines.size() == 1 ? "A line that may be ripple"
                                                    : "Lines that may be ripple";
    return fmt::format(
        "{} at {}: gear ratio {:.{}f} +/- {:.{}f} (95 %); amplitudes {} Nm zero to peak{}; from "
        "{}{}{}.",
        subject, fmt::join(places, " and "), *ratio.value, decimals, half, decimals, listed(amplitudes),
        of_both_splines(ratio, decimals), basis(found.grounds), at_rest(found) + doubt, besides(found));
}

/// "cannot tell which of 80 and 160 is the gear ratio: 80.00 (0.48), 160.00 (0.47)"
std::string undecided(const Identification& found) {
    const std::string all = candidates(found);
    if (found.gear_ratio.contradicted)
        return fmt::format("they contradict the stated gear ratio {:.6g}{}", *found.gear_ratio.value,
                           all.empty() ? "" : ": probable are " + all);
    std::vector<std::string> ratios;
    for (const double ratio : undecided_ratios(found.gear_ratio))
        ratios.push_back(fmt::format("{:.5g}", ratio));
    const std::string question =
        ratios.empty() ? "the gear ratio cannot be determined from these lines"
                       : fmt::format("cannot tell which of {} is the gear ratio", listed(ratios));
    return all.empty() ? question : question + ": " + all;
}

std::string without_ratio(const Identification& found) {
    std::vector<std::string> words;
    for (const Line* line : of_kind(found, LineKind::order)) {
        if (words.size() < 5)
            words.push_back(fmt::format("{:.5g} ({:.2g} Nm)", *line->order_output, line->amplitude_nm));
    }
    return fmt::format("Ripple at output order{} {}; from {}{}{}; {}.", words.size() == 1 ? "" : "s",
                       listed(words), basis(found.grounds), at_rest(found), besides(found), undecided(found));
}

std::string one_speed(const Identification& found) {
    const auto unknown = of_kind(found, LineKind::unknown);
    const Line& first = *unknown.front();
    std::string text =
        fmt::format("{} at {:.4g} Hz ({:.2g} Nm zero to peak)",
                    unknown.size() == 1 ? "One line" : how_many(unknown.size(), "line") + ", the strongest",
                    first.hz.value_or(0.0), first.amplitude_nm);
    if (first.order_output)
        text += fmt::format(": output order {:.5g} if it turns with the joint", *first.order_output);
    text += "; from " + basis(found.grounds) + order_or_tone(found.grounds);
    if (!found.gear_ratio.candidates.empty()) text += "; as orders: " + undecided(found);
    return text + at_rest(found) + besides(found) + ".";
}

std::string nothing(const Identification& found) {
    const SearchedOrders& searched = *found.searched;
    std::vector<std::string> bounds;
    for (const SearchedOrders::Bound& bound : searched.bounds)
        bounds.push_back(fmt::format("{:.2g} Nm from {:.3g}", bound.detectable_nm, bound.from_order));
    // Chosen, not derived: the whole range, and the two most informative ones.
    constexpr std::size_t most = 3;
    if (bounds.size() > most) bounds.erase(bounds.begin() + 1, bounds.end() - (most - 1));
    return fmt::format(
        "No ripple: no line above {} to {:.4g} cycles per output turn; in {} ({:.2g} % false "
        "alarms){}{}.",
        fmt::join(bounds, ", "), searched.highest_order, basis(found.grounds),
        100.0 * found.grounds.false_alarm, at_rest(found), besides(found));
}

std::string too_noisy(const Identification& found) {
    const SearchedOrders& searched = *found.searched;
    return fmt::format(
        "Cannot tell: too noisy or too short: a line of {:.2g} Nm at {:.3g} to {:.4g} cycles per output turn "
        "would be missed; in {}{}{}.",
        searched.detectable_nm, searched.lowest_order, searched.highest_order, basis(found.grounds),
        at_rest(found), besides(found));
}

std::string too_little(const Identification& found) {
    const bool still = found.grounds.rests > 0;
    return fmt::format(
        "Cannot tell: {}{}{}.", still ? "the joint is at rest" : "the joint moves too little or too briefly",
        at_rest(found),
        still ? "" : std::string("; needed is motion of one direction that shows a line four times or more"));
}

std::string frequencies(const Line& line) {
    if (line.hz) return fmt::format("{:.4g} Hz", *line.hz);
    const SeenFrequencies seen = seen_frequencies(line).value_or(SeenFrequencies{});
    const std::string low = fmt::format("{:.4g}", seen.lowest_hz),
                      high = fmt::format("{:.4g}", seen.highest_hz);
    return low == high ? low + " Hz" : fmt::format("{} to {} Hz", low, high);
}

std::string doubted(const Identification& found) {
    std::vector<std::string> because, seen;
    for (const Doubt& doubt : found.doubts) because.push_back(doubt.because);
    std::string text = fmt::format("Cannot tell: {}.", fmt::join(because, "; "));
    constexpr std::size_t most = 6;  // chosen, not derived: a sentence that a person reads
    for (const Line& line : found.lines) {
        if (seen.size() < most)
            seen.push_back(fmt::format("{} ({:.2g} Nm)", frequencies(line), line.amplitude_nm));
    }
    if (found.grounds.sweeps == 0) return text;
    return text + fmt::format(" Seen, from {}: {}.", basis(found.grounds),
                              seen.empty()
                                  ? "no line"
                                  : fmt::format("line{} at {}", seen.size() == 1 ? "" : "s", listed(seen)));
}

}  // namespace

std::string other_motors_sentence(const Identification& found) {
    std::vector<std::string> motors;
    for (const OtherMotorRipple& motor : found.other_motors) {
        std::vector<std::string> orders;
        for (const OtherMotorRipple::AtOrder& at : motor.orders)
            if (at.found)
                orders.push_back(fmt::format("{:.2g} Nm at order {}", at.amplitude_nm, shortest(at.order)));
        if (!orders.empty() && motor.doubt.empty())
            motors.push_back(fmt::format("{} ({})", motor.joint, fmt::join(orders, ", ")));
    }
    if (motors.empty()) return {};
    return fmt::format("The torque also holds ripple of the {} of {}, which was subtracted first.",
                       motors.size() == 1 ? "motor" : "motors", fmt::join(motors, " and "));
}

namespace {

// Clauses after a semicolon as sentences of their own, so that none is too long to be read at once.
std::string in_sentences(const std::string& text) {
    std::string sentences;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool ends = text.compare(i, 2, "; ") == 0 && i + 2 < text.size();
        sentences += ends ? '.' : text[i];
        if (!ends) continue;
        sentences += ' ';
        sentences += static_cast<char>(std::toupper(static_cast<unsigned char>(text[i + 2])));
        i += 2;
    }
    return sentences;
}

std::string clauses(const Identification& found) {
    if (!found.doubts.empty()) return doubted(found);
    switch (found.finding) {
        case RippleFinding::ratio:
            return with_ratio(found);
        case RippleFinding::orders:
            return without_ratio(found);
        case RippleFinding::one_speed:
            return one_speed(found);
        case RippleFinding::nothing:
            return nothing(found);
        case RippleFinding::too_noisy:
            return too_noisy(found);
        case RippleFinding::too_little:
            return too_little(found);
    }
    return {};
}

}  // namespace

std::string verdict_sentence(const Identification& found) { return in_sentences(clauses(found)); }

}  // namespace ripplenotch
