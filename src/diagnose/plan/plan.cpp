// SPDX-License-Identifier: MIT
#include "ripplenotch/diagnose/plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "diagnose/plan/fourier_motion.hpp"
#include "diagnose/plan/questions.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

// How closely is looked, and nothing that is decided by.
struct Looking {
    static constexpr std::array durations_s = {6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 25.0, 30.0};
    static constexpr int draws = 16, moves = 16;
    static constexpr Hertz rate{100.0};
    static constexpr std::size_t most_rows = 4000;
};

// Every n-th row.
Motion thinned(const Motion& motion, std::size_t step) {
    Motion few{Hertz(motion.sample_rate.value() / static_cast<double>(step)), {}, {}, {}, {}};
    for (std::size_t k = 0; k < motion.size(); k += step) {
        few.time_s.push_back(motion.time_s[k]);
        few.position_deg.push_back(motion.position_deg[k]);
        few.velocity_deg_s.push_back(motion.velocity_deg_s[k]);
        few.acceleration_deg_s2.push_back(motion.acceleration_deg_s2[k]);
    }
    return few;
}

struct Judged {
    FourierMotion motion;
    double score = -1.0;  ///< the least gain, in units of what is needed
};

class Planning {
  public:
    Planning(const std::vector<AskedTerm>& asked, const MotionLimits& limits, double variance_nm2)
        : asked_(asked), limits_(limits), variance_nm2_(variance_nm2) {}

    [[nodiscard]] double score(const FourierMotion& motion, Seconds duration) const {
        const Motion along = make_motion(within(motion, limits_, duration), Looking::rate);
        double least = std::numeric_limits<double>::infinity();
        for (const AskedTerm& term : asked_)
            least = std::min(least, separation(term, along).squares / variance_nm2_ / term.needed);
        return least;
    }

    [[nodiscard]] Judged best(Seconds duration, std::uint64_t seed) const {
        Noise noise(seed, NoiseChannel::torque);
        Judged best;
        const auto take = [&](FourierMotion motion) {
            const double now = score(motion, duration);
            if (now > best.score) best = {std::move(motion), now};
        };
        for (int k = 0; k < Looking::draws; ++k) take(drawn(noise));
        for (int k = 0; k < Looking::moves; ++k)
            take(moved(best.motion, k < Looking::moves / 2 ? 0.3 : 0.1, noise));
        return best;
    }

    [[nodiscard]] std::vector<PlanQuestion> questions(const Motion& along, double variance_nm2) const {
        std::vector<PlanQuestion> told;
        for (const AskedTerm& term : asked_) {
            const Separation found = separation(term, along);
            // Less than a single sample of noise brings is rounding.
            const double before = term.gain_before < 1.0 ? 0.0 : term.gain_before;
            told.push_back({std::string(term.term.effect->name), std::string(found.rival), term.open, before,
                            found.squares / variance_nm2});
        }
        return told;
    }

  private:
    const std::vector<AskedTerm>& asked_;
    const MotionLimits& limits_;
    double variance_nm2_;
};

}  // namespace

void check(const MotionLimits& limits) {
    const auto positive = [](double value, std::string_view name) {
        if (!(value > 0.0) || !std::isfinite(value))
            raise<UsageError>("--limits, {}: {} is not above 0", name, shortest(value));
    };
    positive(limits.speed_deg_s, "speed");
    positive(limits.acceleration_deg_s2, "acceleration");
    positive(limits.highest_deg - limits.lowest_deg, "range");
}

Seconds MotionPlan::duration() const {
    return Seconds(static_cast<double>(motion.size()) / motion.sample_rate.value());
}

std::optional<MotionPlan> plan_motion(const Diagnosis& diagnosis, const TraceView& log,
                                      const MotionLimits& limits, const PlanOptions& options) {
    check(limits);
    const Motion whole = motion_along(log, options.smoothing);
    const std::size_t step = whole.size() / Looking::most_rows + 1;
    const double variance = diagnosis.gap.noise_floor_nm * diagnosis.gap.noise_floor_nm;
    const std::vector<AskedTerm> asked =
        asked_terms(diagnosis, thinned(whole, step), variance / static_cast<double>(step),
                    options.rules.advice.plan_gain);
    if (asked.empty()) return std::nullopt;
    // A row that is looked at stands for so many of the log to come.
    const double judged_variance = variance * Looking::rate.value() / options.sample_rate.value();
    const Planning planning(asked, limits, judged_variance);
    Judged best;
    Seconds duration = options.longest;
    for (const double seconds : Looking::durations_s) {
        if (seconds > options.longest.value()) break;
        const Judged now = planning.best(Seconds(seconds), options.seed);
        if (now.score > best.score) {
            best = now;
            duration = Seconds(seconds);
        }
        if (best.score >= 1.0) break;
    }
    MotionPlan plan;
    plan.motions = within(best.motion, limits, duration);
    plan.motion = make_motion(plan.motions, options.sample_rate);
    plan.questions = planning.questions(make_motion(plan.motions, Looking::rate), judged_variance);
    plan.decides = best.score >= 1.0;
    return plan;
}

}  // namespace ripplenotch
