// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/match_low_pass.hpp"

#include <fmt/format.h>

#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {
namespace {

constexpr double lowest_cutoff = 1e-5, highest_cutoff = 0.49;  // of the sample rate
constexpr double wanted_precision = 1e-5;                      // by hand, and told in match_low_pass.hpp
constexpr std::size_t cutoffs_a_pass = 15;                     // by hand: tried in one pass over a log

struct Bracket {
    double low_hz, high_hz;
};

std::string order_list(const GearAccount& lines) {
    std::string text = lines.orders.size() == 1 ? "order " : "orders ";
    for (std::size_t i = 0; i < lines.orders.size(); ++i) {
        if (i > 0) text += i + 1 == lines.orders.size() ? " and " : ", ";
        text += shortest(lines.orders[i].value());
    }
    return text;
}

// The interval between neighbouring cut-offs in which the ripple passes the target; it rises with the
// cut-off.
std::optional<Bracket> tighter(const std::vector<double>& cutoffs_hz, const LogLevels& levels,
                               double ripple_rms_nm) {
    for (std::size_t i = 0; i < cutoffs_hz.size(); ++i) {
        if (*levels.methods[i].ripple_rms_nm < ripple_rms_nm) continue;
        if (i == 0) return std::nullopt;
        return Bracket{cutoffs_hz[i - 1], cutoffs_hz[i]};
    }
    return std::nullopt;
}

}  // namespace

std::optional<double> ripple_gain(std::span<const Biquad> cascade, const GearAccount& lines,
                                  Hertz sample_rate, DegPerSec speed) {
    double before = 0.0, after = 0.0;
    for (std::size_t i = 0; i < lines.orders.size(); ++i) {
        const Hertz at = ripple_frequency(lines.orders[i], lines.ratio, speed);
        if (!(at.value() > 0.0) || !(at < 0.5 * sample_rate)) continue;
        const double amplitude = lines.amplitude_nm.empty() ? 1.0 : lines.amplitude_nm[i];
        before += amplitude * amplitude;
        after += amplitude * amplitude * std::norm(response(cascade, at, SampledAt(sample_rate)));
    }
    if (!(before > 0.0)) return std::nullopt;
    return std::sqrt(after / before);
}

std::optional<Hertz> cutoff_for_gain(double gain, int order, const GearAccount& lines, Hertz sample_rate,
                                     DegPerSec speed) {
    const auto gain_at = [&](double cutoff) {
        const auto left = ripple_gain(design_low_pass({cutoff * sample_rate, order}, sample_rate), lines,
                                      sample_rate, speed);
        if (!left)
            raise<UsageError>("no ripple line is below half the sample rate, {} Hz",
                              0.5 * sample_rate.value());
        return *left;
    };
    double low = portable::log(lowest_cutoff), high = portable::log(highest_cutoff);
    if (!(gain_at(portable::exp(low)) <= gain && gain <= gain_at(portable::exp(high)))) return std::nullopt;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (gain_at(portable::exp(middle)) <= gain ? low : high) = middle;
    }
    return Hertz(portable::exp(0.5 * (low + high)) * sample_rate.value());
}

std::optional<Hertz> cutoff_for_ripple(double ripple_rms_nm, int order, const ComparedLog& log,
                                       const GearAccount& lines) {
    const double rate_hz = log.trace.sample_rate.value();
    Bracket bracket{lowest_cutoff * rate_hz, highest_cutoff * rate_hz};
    // A pass over the log costs about the same for many filters as for one, so each pass cuts the bracket
    // into many.
    while (bracket.high_hz / bracket.low_hz > 1.0 + wanted_precision) {
        std::vector<double> cutoffs_hz;
        std::vector<Contender> contenders;
        for (std::size_t i = 0; i <= cutoffs_a_pass; ++i) {
            const double share = static_cast<double>(i) / static_cast<double>(cutoffs_a_pass);
            cutoffs_hz.push_back(bracket.low_hz * portable::pow(bracket.high_hz / bracket.low_hz, share));
            const Spec spec{
                "lowpass",
                {{"cutoff", fmt::format("{:.17g}Hz", cutoffs_hz.back())}, {"order", std::to_string(order)}}};
            contenders.push_back(make_contender(spec));
        }
        const LogLevels levels = measure_on_log(contenders, log, lines);
        if (levels.windows == 0) return std::nullopt;
        const auto next = tighter(cutoffs_hz, levels, ripple_rms_nm);
        if (!next) return std::nullopt;
        bracket = *next;
    }
    return Hertz(std::sqrt(bracket.low_hz * bracket.high_hz));
}

Spec low_pass_spec(Hertz cutoff, int order) {
    return {"lowpass",
            {{"cutoff", fmt::format("{:.7g}Hz", cutoff.value())}, {"order", std::to_string(order)}}};
}

std::optional<double> combined_gain(const MethodFigures& figures, const GearAccount& lines) {
    double before = 0.0, after = 0.0;
    for (std::size_t i = 0; i < figures.attenuation.size(); ++i) {
        if (!figures.attenuation[i].db) continue;
        const double amplitude = lines.amplitude_nm.empty() ? 1.0 : lines.amplitude_nm[i];
        before += amplitude * amplitude;
        after += amplitude * amplitude * portable::pow(10.0, -*figures.attenuation[i].db / 10.0);
    }
    if (!(before > 0.0)) return std::nullopt;
    return std::sqrt(after / before);
}

LowPassMatch match_at_speed(const std::string& subject, double gain, int order, const GearAccount& lines,
                            Hertz sample_rate, DegPerSec speed) {
    LowPassMatch match{subject, std::nullopt, "", order, std::nullopt, std::nullopt, std::nullopt};
    if (gain < complete_null_gain) {
        match.clause = fmt::format(
            "no low-pass equals {}: at {:.6g} deg/s it takes the lines out completely; "
            "--match-attenuation 22dB finds the low-pass of a stated attenuation",
            subject, speed.value());
        return match;
    }
    match.attenuation_db = -20.0 * portable::log10(gain);
    match.cutoff = cutoff_for_gain(gain, order, lines, sample_rate, speed);
    if (!match.cutoff) {
        match.clause = fmt::format(
            "no low-pass of order {} takes {:.2f} dB off the ripple at {:.6g} deg/s (cut-offs from {:.3g} to "
            "{:.3g} Hz)",
            order, *match.attenuation_db, speed.value(), lowest_cutoff * sample_rate.value(),
            highest_cutoff * sample_rate.value());
        return match;
    }
    match.low_pass = low_pass_spec(*match.cutoff, order).text();
    match.clause = fmt::format("at an equal ripple attenuation of {:.2f} dB ({} at {:.6g} deg/s, {})",
                               *match.attenuation_db, order_list(lines), speed.value(),
                               lines.amplitude_nm.empty() ? "equal amplitudes" : "amplitudes of the joint");
    return match;
}

LowPassMatch match_on_log(const std::string& subject, double ripple_rms_nm, int order, const ComparedLog& log,
                          const GearAccount& lines) {
    LowPassMatch match{subject, std::nullopt, "", order, std::nullopt, ripple_rms_nm, std::nullopt};
    match.cutoff = cutoff_for_ripple(ripple_rms_nm, order, log, lines);
    if (!match.cutoff) {
        match.clause = fmt::format(
            "no low-pass of order {} leaves {:.3g} Nm rms of ripple on this log (cut-offs from {:.3g} to "
            "{:.3g} Hz)",
            order, ripple_rms_nm, lowest_cutoff * log.trace.sample_rate.value(),
            highest_cutoff * log.trace.sample_rate.value());
        return match;
    }
    match.low_pass = low_pass_spec(*match.cutoff, order).text();
    match.clause = fmt::format("at an equal remaining ripple of {:.3g} Nm rms ({} on this log)",
                               ripple_rms_nm, order_list(lines));
    return match;
}

}  // namespace ripplenotch
