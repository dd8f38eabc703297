// SPDX-License-Identifier: MIT
#pragma once
// Which of several methods to take: all run over one log, are measured as compare does, and are held to what
// they may cost and must do.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {

/// Of the filter that is active at a constant speed; empty for methods that have none.
[[nodiscard]] std::optional<BandResponse> band_response(const Contender& contender, Hertz sample_rate,
                                                        DegPerSec speed, const TorqueBand& band);

struct RecommendationLimits {
    std::optional<Seconds> max_delay;          ///< at 0 Hz and within the torque's band, at speeds of the log
    std::optional<double> min_attenuation_db;  ///< attenuation of every order that Recommendation::asks_for
    std::optional<double> max_start_ratio;     ///< MethodFigures::start_ratio
    bool every_order = false;                  ///< the orders are named: the faint ones are asked for, too
    [[nodiscard]] bool any() const { return max_delay || min_attenuation_db || max_start_ratio; }
};

enum class RecommendationFinding {
    recommended,
    out_of_reach,  ///< no method meets the limits; the first is the nearest
    no_ripple,
    cannot_tell,
};
[[nodiscard]] std::string_view recommendation_finding_name(RecommendationFinding finding);

struct Recommendation {
    RecommendationFinding finding = RecommendationFinding::cannot_tell;
    std::string why;  ///< reason of no_ripple and cannot_tell: a sentence
    RecommendationLimits limits;
    GearRatio ratio;  ///< by which the orders count
    /// Orders of the whole log; empty where their interpretation is uncertain.
    std::vector<RippleEstimate> orders;
    std::size_t windows = 0;         ///< windows in which the methods were measured
    double raw_ripple_rms_nm = 0.0;  ///< of the unfiltered torque in them
    std::optional<TorqueBand> band;  ///< of the torque; empty where nothing was judged
    double torque_rate_nm_s = 0.0;  ///< rate of change of the log's torque from motor turn to motor turn, rms
    std::vector<JudgedMethod> methods;  ///< the one to take first; those within the limits before the others

    /// The one to take, or the nearest; null without methods.
    [[nodiscard]] const JudgedMethod* taken() const { return methods.empty() ? nullptr : &methods.front(); }
    /// The first one of another method that has less delay, overshoot or cost than the one to take; null
    /// where there is none.
    [[nodiscard]] const JudgedMethod* runner_up() const;
    /// Whether an order is present, and not faint unless it is named.
    [[nodiscard]] bool asks_for(std::size_t order) const;
};

/// Of the strongest order's amplitude: less is faint, and not asked to be attenuated unless it is named.
inline constexpr double faint_share = 0.1;

/// Rms rate of the mean torque from one motor turn to the next; of half a second where the motor is slower.
[[nodiscard]] double torque_rate_nm_s(const TraceView& trace, GearRatio ratio);

/// Runs all over the log and sorts them by the error of their output. The same methods under looser limits
/// give the same or a better one. The control is among them or not, as given. `ripple`: the result of
/// estimate_ripple() for the whole log, of which `log` is the part used for the recommendation, one for each
/// of `lines`. `band`: the torque's, where it is stated. `measured`: what measure_on_log() gave, in place of
/// both.
[[nodiscard]] Recommendation recommend(std::span<const Contender> contenders, const ComparedLog& log,
                                       const GearAccount& lines, const RecommendationLimits& limits,
                                       std::vector<RippleEstimate> ripple,
                                       std::optional<TorqueBand> band = std::nullopt,
                                       std::optional<LogLevels> measured = std::nullopt);

/// A method as it is typed where the gear is stated by options; by its name where that is too long for a
/// line.
[[nodiscard]] std::string short_method(const MethodFigures& figures);

/// A sentence with numbers, of 30 words at most: the recommended method and its performance. Another one
/// where a second method trades something.
[[nodiscard]] std::string recommendation_verdict(const Recommendation& found);

/// recommend() among the methods of a comparison, `measured` on all rows of its log: fills in the best one
/// and recommendation_verdict(). `contenders` are as its methods.
void judge(Comparison& comparison, std::span<const Contender> contenders, const ComparedLog& log,
           const RecommendationLimits& limits, LogLevels measured);

}  // namespace ripplenotch
