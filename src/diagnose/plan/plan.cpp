// SPDX-License-Identifier: MIT
#include "diagnose/plan/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/case/case.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/search/search_starts.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/diagnose/plan.hpp"
#include "ripplenotch/model/noise.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motions.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

namespace {

// How far the torque of an effect is, along a motion, from all that other effects could make of it.

/// A term that is to be distinguished from others.
struct AskedTerm {
    Term term;                          ///< with its values
    Model rest;                         ///< the model without it, every value stated
    std::vector<const Effect*> rivals;  ///< each may stand in its place
    double scale = 1.0;   ///< scale of its torque: a torque that cancels is no larger than the measured one
    bool open = true;     ///< whether the log left it open
    double needed = 0.0;  ///< gain
    double gain_before = 0.0;  ///< along the log
};

struct Separation {
    double squares = 0.0;    ///< squares of the torque that only the term explains, Nm^2
    std::string_view rival;  ///< the rival that explains the most of it; empty: none is tested
};

using TermColumn = std::vector<double>;

double square(const TermColumn& column) { return dot(column.data(), column.data(), column.size()); }

// Columns made orthogonal to one another, one after the other (Gram and Schmidt, twice for each).
class Basis {
  public:
    // The residual of the column after projection on those that are in.
    [[nodiscard]] TermColumn left(TermColumn column) const {
        for (int turn = 0; turn < 2; ++turn)
            for (const TermColumn& one : ortho_)
                add_scaled(-dot(one.data(), column.data(), column.size()), one.data(), column.data(),
                           column.size());
        return column;
    }
    void add(TermColumn column) {
        constexpr double next_to_nothing = 1e-14;  // share of its square: it is in already
        const double before = square(column);
        column = left(std::move(column));
        const double after = square(column);
        if (!(after > next_to_nothing * before)) return;
        const double scale = 1.0 / std::sqrt(after);
        for (double& value : column) value *= scale;
        ortho_.push_back(std::move(column));
    }

  private:
    std::vector<TermColumn> ortho_;
};

// Derivatives of the torque with respect to each value of the model that a fit would estimate.
void add_slope_columns(const Prediction& prediction, Basis& basis) {
    const Model& model = prediction.model();
    for (std::size_t t = 0; t < model.terms.size(); ++t) {
        for (std::size_t p = 0; p < model.terms[t].values.size(); ++p) {
            const Parameter& parameter = model.terms[t].effect->parameters[p];
            if (parameter.left_out != LeftOut::fitted || !model.terms[t].values[p]) continue;
            Term changed = model.terms[t];
            const double value = *changed.values[p];
            const double step = 1e-3 * std::max(std::abs(value), std::abs(parameter.start));
            changed.values[p] = value + step <= parameter.upper ? value + step : value - step;
            if (step > 0.0 && allows(parameter, *changed.values[p]))
                basis.add(prediction.changed(t, changed));
        }
    }
}

Basis basis_beside(const AskedTerm& asked, const Prediction& prediction, std::size_t samples) {
    Basis basis;
    if (asked.term.effect->name != "offset") basis.add(TermColumn(samples, 1.0));
    add_slope_columns(prediction, basis);
    return basis;
}

// Torques of the effect, of a size of 1, at one place of its shape: two where it has a phase.
struct TriedPlace {
    std::vector<Term> terms;
    std::vector<TermColumn> columns;
};

std::vector<TriedPlace> tried_places(const Effect& effect, const Prediction& prediction) {
    constexpr std::size_t most_places = 40;
    double cells = 1.0;
    std::vector<Term> starts = starts_of(effect, {}, 0.0, cells);
    if (starts.size() > most_places) starts.resize(most_places);
    std::vector<TriedPlace> places;
    for (Term& start : starts) {
        for (std::size_t p = 0; p < start.values.size(); ++p)
            if (effect.parameters[p].linear && start.values[p] == effect.parameters[p].neutral)
                start.values[p] = effect.parameters[p].neutral + 1.0;
        TriedPlace place;
        place.terms.push_back(start);
        if (effect.polar) {
            place.terms.push_back(start);
            place.terms.back().values[effect.polar->phase] = -90.0;
        }
        for (const Term& term : place.terms) place.columns.push_back(prediction.added(term));
        places.push_back(std::move(place));
    }
    return places;
}

// Squares of `target` outside the span of the basis and of the place's columns.
double left_beside(const Basis& basis, const TermColumn& target, const TriedPlace& place) {
    Basis own;
    for (const TermColumn& column : place.columns) own.add(basis.left(column));
    return square(own.left(target));
}

// Every column has an entry per sample of `motion`.
Separation separation(const AskedTerm& asked, const Motion& motion) {
    const Prediction prediction(asked.rest, motion);
    const Basis basis = basis_beside(asked, prediction, motion.size());
    TermColumn torque = prediction.added(asked.term);
    for (double& value : torque) value *= asked.scale;
    torque = basis.left(std::move(torque));
    Separation least{square(torque), {}};
    for (const Effect* const rival : asked.rivals) {
        for (const TriedPlace& place : tried_places(*rival, prediction)) {
            const double left = left_beside(basis, torque, place);
            if (left < least.squares || least.rival.empty())
                least = {std::min(left, least.squares), rival->name};
        }
    }
    return least;
}

// The rival with the values with which it is nearest to the term along `motion`, together with the rest;
// false where no place of it explains anything.
bool nearest_rival(const AskedTerm& asked, const Effect& rival, const Motion& motion, Term& found) {
    const Prediction prediction(asked.rest, motion);
    const Basis basis = basis_beside(asked, prediction, motion.size());
    const TermColumn torque = basis.left(prediction.added(asked.term));
    double least = square(torque);
    bool any = false;
    for (const TriedPlace& place : tried_places(rival, prediction)) {
        const double left = left_beside(basis, torque, place);
        const TermColumn one = basis.left(place.columns.front());
        if (!(left < least) || !(square(one) > 0.0)) continue;
        least = left;
        any = true;
        found = place.terms.front();
        // Its size, computed with the first phase: the separation depends little on the phase.
        const double size = std::sqrt(square(torque) / square(one));
        for (std::size_t p = 0; p < found.values.size(); ++p)
            if (rival.parameters[p].linear && allows(rival.parameters[p], size)) found.values[p] = size;
    }
    return any;
}

// The open questions of a diagnosis, as terms to be distinguished from rivals.

void add_rival(std::vector<const Effect*>& rivals, const Effect& own, std::string_view name) {
    for (const Effect* const effect : catalogue()) {
        if (effect->name != name || effect == &own || effect->side == Side::converter) continue;
        if (std::find(rivals.begin(), rivals.end(), effect) == rivals.end()) rivals.push_back(effect);
    }
}

// The rivals found in the log, and those in the catalogue.
std::vector<const Effect*> rivals_of(const Diagnosis& diagnosis, const Finding& finding) {
    const Effect& own = *finding.term.effect;
    std::vector<const Effect*> rivals;
    for (const RivalFinding& rival : finding.alternatives) add_rival(rivals, own, rival.effect);
    for (const Tie& tie : diagnosis.ambiguous)
        if (std::find(tie.effects.begin(), tie.effects.end(), own.name) != tie.effects.end())
            for (const std::string& name : tie.effects) add_rival(rivals, own, name);
    if (is_doubtful(finding))
        for (const LookAlike& alike : own.look_alikes) add_rival(rivals, own, alike.name);
    return rivals;
}

// The improved model without the finding, which is in it unless it is uncertain.
Model model_beside(const Diagnosis& diagnosis, const Finding& finding) {
    Model rest = diagnosis.model;
    if (is_doubtful(finding)) return rest;
    const auto& effect = *finding.term.effect;
    for (std::size_t t = diagnosis.baseline.terms.size(); t < rest.terms.size(); ++t) {
        const Term& term = rest.terms[t];
        bool same = term.effect == &effect;
        for (std::size_t p = 0; same && p < term.values.size(); ++p)
            same =
                effect.parameters[p].left_out != LeftOut::refused || term.values[p] == finding.term.values[p];
        if (!same) continue;
        rest.terms.erase(rest.terms.begin() + static_cast<std::ptrdiff_t>(t));
        break;
    }
    return rest;
}

bool is_of_the_joint(const Effect& effect) { return effect.side != Side::converter && !effect.chance; }

// Sides of ties and uncertain findings first, then findings that have to be found again. None where nothing
// is open. `along`: the motion of the log; `variance_nm2`: variance of the noise, for as many rows as `along`
// has.
std::vector<AskedTerm> asked_terms(const Diagnosis& diagnosis, const Motion& along, double variance_nm2,
                                   double enough) {
    std::vector<AskedTerm> open, found;
    for (const Finding& finding : diagnosis.rounds) {
        const bool asked = is_doubtful(finding) || finding.status == FindingStatus::ambiguous;
        const bool known = finding.status == FindingStatus::confirmed;
        if ((!asked && !known) || !is_of_the_joint(*finding.term.effect)) continue;
        AskedTerm term{finding.term, model_beside(diagnosis, finding), {}};
        term.open = asked;
        if (asked) term.rivals = rivals_of(diagnosis, finding);
        const double own_nm = rms(Prediction(term.rest, along).added(term.term));
        if (!(own_nm > 0.0)) continue;
        if (diagnosis.gap.before_nm > 0.0) term.scale = std::min(1.0, diagnosis.gap.before_nm / own_nm);
        (asked ? open : found).push_back(std::move(term));
    }
    if (open.empty()) return {};
    // The other side of a tie, as large as it would have to be.
    for (std::size_t i = 0, sides = open.size(); i < sides; ++i) {
        for (const Tie& tie : diagnosis.ambiguous) {
            if (tie.effects.empty() || tie.effects.front() != open[i].term.effect->name) continue;
            for (std::size_t k = 1; k < tie.effects.size(); ++k) {
                const Effect& rival = find_effect(tie.effects[k]);
                AskedTerm other{{}, open[i].rest, {open[i].term.effect}};
                if (is_of_the_joint(rival) && nearest_rival(open[i], rival, along, other.term))
                    open.push_back(std::move(other));
            }
        }
    }
    open.insert(open.end(), found.begin(), found.end());
    for (AskedTerm& term : open) {
        term.gain_before = separation(term, along).squares / variance_nm2;
        // A term that the log determined well has to be determined half as well, no better than an open one.
        term.needed = term.open ? enough : std::min(enough, 0.5 * term.gain_before);
    }
    std::erase_if(open, [](const AskedTerm& term) { return !(term.needed > 0.0); });
    return open;
}

/// Half-waves of a planned motion.
constexpr std::size_t planned_waves = 10;

constexpr double planned_rest_s = 0.5;  ///< before and after

// The acceleration at both ends is 0 where the sums of k s_k over odd and over even k are.
void begin_gently(std::vector<double>& speeds) {
    for (const std::size_t first : {std::size_t{0}, std::size_t{1}}) {
        double sum = 0.0, weights = 0.0;
        for (std::size_t k = first; k < speeds.size(); k += 2) {
            const double waves = static_cast<double>(k + 1);
            sum += waves * speeds[k];
            weights += waves * waves;
        }
        for (std::size_t k = first; k < speeds.size(); k += 2)
            speeds[k] -= sum * static_cast<double>(k + 1) / weights;
    }
}

std::string fourier_words(const std::vector<double>& speeds, double duration_s) {
    std::string words = "fourier,speeds=";
    for (std::size_t k = 0; k < speeds.size(); ++k)
        words += fmt::format("{}{}deg/s", k == 0 ? "" : ":", shortest(speeds[k]));
    return words + fmt::format(",duration={}s", shortest(duration_s));
}

double largest_size(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

}  // namespace

FourierMotion drawn(Noise& noise) {
    FourierMotion motion;
    for (std::size_t k = 0; k < planned_waves; ++k) motion.speeds_deg_s.push_back(noise.normal());
    motion.place = noise.uniform();
    return motion;
}

FourierMotion moved(const FourierMotion& motion, double step, Noise& noise) {
    FourierMotion other = motion;
    const double size = largest_size(motion.speeds_deg_s);
    for (double& speed : other.speeds_deg_s) speed += step * size * noise.normal();
    other.place = std::clamp(motion.place + step * noise.normal(), 0.0, 1.0);
    return other;
}

std::vector<std::string> within(const FourierMotion& motion, const MotionLimits& limits, Seconds duration) {
    constexpr double within_limits = 0.999, sampled_hz = 200.0;
    const double moves_s = duration.value() - 2.0 * planned_rest_s;
    std::vector<double> speeds = motion.speeds_deg_s;
    begin_gently(speeds);
    const Motion raw = make_motion(fourier_words(speeds, moves_s), Hertz(sampled_hz));
    const auto [low, high] = std::minmax_element(raw.position_deg.begin(), raw.position_deg.end());
    const double room_deg = limits.highest_deg - limits.lowest_deg;
    const double scale =
        within_limits * std::min({limits.speed_deg_s / largest_size(raw.velocity_deg_s),
                                  limits.acceleration_deg_s2 / largest_size(raw.acceleration_deg_s2),
                                  room_deg / (*high - *low)});
    for (double& speed : speeds) speed = to_digits(scale * speed, 6);
    const double free_deg = room_deg - scale * (*high - *low);
    const double from_deg = to_digits(limits.lowest_deg + motion.place * free_deg - scale * *low, 6);
    return {fmt::format("rest,duration={}s,from={}deg", shortest(planned_rest_s), shortest(from_deg)),
            fourier_words(speeds, moves_s), fmt::format("rest,duration={}s", shortest(planned_rest_s))};
}

namespace {

// Effort of the search for a motion; not used for decisions.
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
    double score = -1.0;  ///< the least gain, relative to the needed one
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
    // A row that is evaluated represents so many of the log to come.
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
