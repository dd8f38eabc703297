// SPDX-License-Identifier: MIT
// The main loop of a diagnosis: select -> fit -> test -> report.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "diagnose/angle/angle.hpp"
#include "diagnose/case/case.hpp"
#include "diagnose/case/known_torque.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/judging/judge.hpp"
#include "diagnose/judging/residual_regions.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/report/summary.hpp"
#include "diagnose/search/search.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {
namespace {

bool is_among(std::span<const std::string> names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

// Whether effects take part that need the joint's position, the gear ratio, or motion in both directions.
struct Examinable {
    bool of_position = true, of_motor = true, of_direction = true;
};

// Effects that a fit can find; those of the converter are found in the log itself (find_faults).
std::vector<const Effect*> examined(std::span<const std::string> without, Examinable some) {
    std::vector<const Effect*> effects;
    for (const Effect* effect : catalogue()) {
        const bool left_out = is_among(without, effect->name);
        if (left_out || effect->side == Side::converter || (!some.of_position && needs_position(*effect)) ||
            (!some.of_motor && needs_gear_ratio(*effect)) || (!some.of_direction && effect->differs))
            continue;
        effects.push_back(effect);
    }
    return effects;
}

// Faults whose effect is not among those tried have no name: the samples that they invalidate are
// unexplained. They are removed from `faults`.
std::vector<ResidualRegion> nameless(std::vector<Fault>& faults, std::span<const std::string> without) {
    std::vector<ResidualRegion> left;
    for (const Fault& fault : faults) {
        if (is_among(without, fault.term.effect->name))
            left.push_back({RegionKind::time, {fault.time_s, {}, {}, {}, {}, {}}, 0.0, 0.0});
    }
    std::erase_if(faults, [&](const Fault& fault) { return is_among(without, fault.term.effect->name); });
    return left;
}

// Measures the residual in invalidated samples, once there is a model of the others.
void measure_at_samples(std::vector<ResidualRegion>& nameless, const Case& c, const Model& stated) {
    std::vector<double> left = predict_nm(stated, c.motion);
    double all = 0.0;
    for (std::size_t k = 0; k < left.size(); ++k) {
        left[k] = c.torque_nm[k] - left[k];
        all += left[k] * left[k];
    }
    for (ResidualRegion& region : nameless) {
        double sum = 0.0, count = 0.0;
        for (const Span& span : region.where.time_s) {
            const auto first = std::lower_bound(c.motion.time_s.begin(), c.motion.time_s.end(), span.from);
            for (auto at = first; at != c.motion.time_s.end() && *at <= span.to; ++at, count += 1.0)
                sum += portable::pow(left[static_cast<std::size_t>(at - c.motion.time_s.begin())], 2);
        }
        region.rms_nm = std::sqrt(sum / std::max(count, 1.0));
        region.part = sum / std::max(all, 1e-300);
    }
}

struct Searched {
    std::unique_ptr<ModelBench> bench;  ///< on which the last model was found
    NoiseGround ground;
    NoiseFloor noise;
    Candidate first, last;
    std::vector<RefusedCandidate> refused;
};

// The noise with the last model, and that model fitted with it. The first noise estimate contains what the
// search could not explain at that time.
void measure_noise(Searched& found, const Case& c, Work& work) {
    found.noise = noise_floor(c, found.last.stated, found.last.open, found.ground);
    auto kept = found.bench ? found.bench->kept() : std::make_shared<KeptScreenings>();
    found.bench = std::make_unique<ModelBench>(c, found.noise, work, std::move(kept));
    found.bench->settle_on(found.last.stated);
    found.last = found.bench->fitted(found.last.open, found.last.stated, found.last.prices);
}

Searched search_case(const Case& c, const Model& model, std::span<const Effect* const> effects, Work& work) {
    const std::size_t own = model.terms.size();
    // The first fit has no estimate of the noise.
    ModelBench rough(c, {1.0, 1.0, {}}, work);
    Searched found;
    found.first = baseline(rough, model);
    found.last = found.first;
    for (std::size_t look = 0; look < limits::noise_floor::most_looks; ++look) {
        measure_noise(found, c, work);
        const Candidate start = found.last;
        if (look == 0) found.first = start;
        found.last = search(*found.bench, start, own, effects, found.refused);
        const double left = std::sqrt(found.last.gain_left / found.bench->samples());
        const bool found_more = found.last.stated.terms.size() > start.stated.terms.size();
        if (look > 0 && !found_more) break;
        if (work.is_over()) {
            if (found_more) measure_noise(found, c, work);
            break;
        }
        if (left > limits::noise_floor::was_too_large && found.last.stated.terms.size() == own) break;
    }
    return found;
}

// The gap after each addition, in the order of adoption.
void measure_rounds(Diagnosis& diagnosis, const ModelBench& bench, const Candidate& last, std::size_t own) {
    Candidate now = last;
    now.open.terms.resize(own);
    now.stated.terms.resize(own);
    double before = rms_of(bench.raw_residual(diagnosis.baseline), bench.looked_at().use);
    for (std::size_t i = 0; i < diagnosis.rounds.size(); ++i) {
        Finding& finding = diagnosis.rounds[i];
        now.open.terms.push_back(last.open.terms[own + i]);
        now.stated.terms.push_back(last.stated.terms[own + i]);
        now = bench.fitted(now.open, now.stated, {}, 4);
        finding.gap_before_nm = before;
        finding.gap_after_nm = before = rms_of(bench.raw_residual(now.stated), bench.looked_at().use);
    }
}

bool set_aside(Case& c, const std::vector<ResidualRegion>& left) {
    bool any = false;
    const double margin_s = limits::regions::aside_margin_s;
    for (const ResidualRegion& region : left) {
        if (!is_confined(region, c)) continue;
        for (std::size_t k = 0; k < c.size(); ++k) {
            for (const Span& span : region.where.time_s) {
                if (c.motion.time_s[k] < span.from - margin_s || c.motion.time_s[k] > span.to + margin_s)
                    continue;
                any = any || c.use[k] != 0;
                c.use[k] = c.valid[k] = 0;
            }
        }
    }
    return any;
}

double confined_part(const Case& c, const std::vector<ResidualRegion>& left) {
    double total_s = 0.0;
    for (const ResidualRegion& region : left) {
        for (const Span& span : region.where.time_s)
            total_s += region.kind == RegionKind::time ? span.to - span.from : 0.0;
    }
    return total_s / (c.motion.time_s.back() - c.motion.time_s.front());
}

// Without position an effect of the position may fit along the integral of the speed and be something else.
std::vector<Undecidable> undecidable(const ModelBench& bench, const Candidate& model,
                                     std::span<const Effect* const> tried,
                                     std::span<const std::string> without) {
    std::vector<const Effect*> others;
    for (const Effect* effect : examined(without, {.of_motor = model.stated.has_gear_ratio()})) {
        if (needs_position(*effect) && std::find(tried.begin(), tried.end(), effect) == tried.end())
            others.push_back(effect);
    }
    std::vector<Undecidable> told;
    for (const Effect* effect : others)
        told.push_back({effect->name, "it depends on where the joint is, and the log has no position", 0.0});
    for (const Trial& trial : screen(bench, model, others)) {
        for (Undecidable& entry : told) {
            if (entry.effect == trial.start.effect->name && trial.score() > 0.0)
                entry.would_explain_nm =
                    bench.share(with_trial(bench, model, trial), model) * bench.noise().material_nm;
        }
    }
    return told;
}

// A disturbance of short duration biases everything that is fitted to it. It is reported and excluded, and
// the rest of the log is diagnosed without it.
Searched search_rest(Case& part, const Model& model, std::span<const Effect* const> effects,
                     Diagnosis& diagnosis, std::vector<ResidualRegion>& aside, Work& work) {
    Searched found = search_case(part, model, effects, work);
    {
        ModelBench bench(part, found.noise, work);
        bench.settle_on(found.first.stated);
        diagnosis.disagreement = residual_regions(bench, found.first.stated);
    }
    for (std::size_t look = 0; look < limits::regions::most_asides; ++look) {
        const auto left = residual_regions(*found.bench, found.last.stated);
        // Each exclusion of an interval requires a complete new search.
        if (confined_part(part, left) > limits::regions::most_aside_part || work.is_over() ||
            !set_aside(part, left))
            break;
        for (const ResidualRegion& region : left) {
            if (region.kind == RegionKind::time) aside.push_back(region);
        }
        found = search_case(part, model, effects, work);
    }
    return found;
}

// The findings may determine the angle better than the model as given did; then the search continues from
// there.
Searched search_straight(Case& whole, Case& part, const Model& model, std::span<const Effect* const> effects,
                         Diagnosis& diagnosis, std::vector<ResidualRegion>& aside, Work& work,
                         bool has_position) {
    Searched found = search_rest(part, model, effects, diagnosis, aside, work);
    if (has_position || !straightened_by(whole, found.last, found.bench->floor_nm(found.last.stated)))
        return found;
    found.bench.reset();
    found.ground = {};
    for (std::size_t k = 0; k < part.size(); ++k)
        part.motion.position_deg[k] = whole.motion.position_deg[part.row[k]];
    measure_noise(found, part, work);
    found.first = found.bench->fitted(found.first.open, found.first.stated, found.first.prices);
    found.refused.clear();
    found.last = search(*found.bench, found.last, model.terms.size(), effects, found.refused);
    return found;
}

// Against the noise that holds the residual: the same search from the start.
Searched search_again(const Searched& before, const Case& c, const Model& model,
                      std::span<const Effect* const> effects, Work& work) {
    std::vector<double> left(c.size(), 0.0);
    const auto cleared = before.bench->cleared_residual(before.last.stated);
    for (std::size_t r = 0; r < cleared.size(); ++r) left[before.bench->rows()[r]] = cleared[r];
    Searched found;
    found.noise = noise_of_residual(c, left, before.noise);
    found.bench = std::make_unique<ModelBench>(c, found.noise, work);
    found.bench->settle_on(before.first.stated);
    found.first = found.bench->fitted(before.first.open, before.first.stated, before.first.prices);
    found.last = search(*found.bench, found.first, model.terms.size(), effects, found.refused);
    return found;
}

void check_rows(std::span<const GivenTerm> given, std::size_t rows, std::string_view log) {
    for (const GivenTerm& term : given) {
        for (const auto& column : term.torque_nm) {
            if (column.size() != rows)
                raise<UsageError>("{}: {} values for the {} rows of {}", term.name, column.size(), rows, log);
        }
    }
}

// Whether there is a simulation whose scale is not stated.
bool is_scale_open(std::span<const GivenTerm> given) {
    return std::ranges::any_of(given, [](const GivenTerm& term) {
        return term.name == "simulated" && term.deviation[0] > stated_deviation;
    });
}

bool has_offset(const Model& model) {
    return std::ranges::any_of(model.terms, [](const Term& term) { return term.effect->name == "offset"; });
}

double fastest_deg_s(const Motion& motion) {
    double fastest = 0.0;
    for (const double v : motion.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    return fastest;
}

bool moves_both_ways(const Case& c, double least_part) {
    std::size_t positive = 0, negative = 0;
    for (const double v : c.motion.velocity_deg_s) {
        if (std::abs(v) > c.moving_deg_s) ++(v > 0.0 ? positive : negative);
    }
    return static_cast<double>(std::min(positive, negative)) >= least_part * static_cast<double>(c.size());
}

// A value that is fitted in its logarithm has an interval of factors.
void widen_interval(FittedValue& value, const Parameter& parameter, double times) {
    if (!value.ci95) return;
    if (parameter.logarithmic && value.ci95->low > 0.0) {
        value.ci95->low = value.value * portable::pow(value.ci95->low / value.value, times);
        value.ci95->high = value.value * portable::pow(value.ci95->high / value.value, times);
        return;
    }
    value.ci95->low = value.value + times * (value.ci95->low - value.value);
    value.ci95->high = value.value + times * (value.ci95->high - value.value);
}

class DiagnosisRun {
  public:
    DiagnosisRun(const Model& model, const TraceView& log, const TraceView* validation,
                 const DiagnosisOptions& options)
        : options_(options),
          model_(model),
          has_position_(log.has_position()),
          whole_(whole_case(log, options.smoothing)),
          work_(limits::search::most_evaluations),
          more_work_(limits::search::most_evaluations) {
        take_known_torque(whole_, options.given);
        whole_.expected_delay = options.expected_delay;
        // Terms that the known torque adds to the model: excess friction in a simulation is below 0, and the
        // zero of the sensor is fitted along with an arm's weight, which resembles it.
        model_.beside_simulation = is_given(options.given, "simulated");
        fits_offset_ = is_given(options.given, "arm") && !has_offset(model_);
        if (fits_offset_) model_.terms.push_back(parse_term("offset"));
        model_.widest_step_deg_s = limits::search::widest_step * fastest_deg_s(whole_.motion);
        own_ = model_.terms.size();
        without_.assign(options.without.begin(), options.without.end());
        // A fault of the set-up explains a wrong scale.
        if (!is_scale_open(options.given) || !options.setup.empty())
            without_.emplace_back("simulation-scale");
        // An arm has inertia and gravity of its own.
        if (is_given(options.given, "arm"))
            without_.insert(without_.end(), {"inertia", "gravity", "payload-change"});
        moves_both_ways_ = moves_both_ways(whole_, limits::advice::least_part);
        effects_ = examined(without_, {.of_position = has_position_ || tells_position(whole_.motion),
                                       .of_motor = model_.has_gear_ratio(),
                                       .of_direction = moves_both_ways_});
        if (validation == nullptr) return;
        other_ = whole_case(*validation, options.smoothing);
        take_known_torque(*other_, options.validation_given);
        (void)find_faults(*other_);
        other_has_position_ = validation->has_position();
    }

    [[nodiscard]] Diagnosis run() {
        result_.has_position = has_position_;
        result_.setup.assign(options_.setup.begin(), options_.setup.end());
        result_.false_alarm = limits::screening::false_alarm;
        result_.samples = whole_.size();
        add_unused_rows(result_.unused, whole_,
                        "where the acceleration jumps, smoothing hides the torque of the inertia");
        result_.faults = find_faults(whole_);
        add_unused_rows(result_.unused, whole_, "spoiled by a fault of the log");
        std::vector<ResidualRegion> spoiled = nameless(result_.faults, options_.without), aside;
        AngleBefore before(whole_, has_position_);
        if (!has_position_) straighten(whole_, model_);
        Case part = excerpt(whole_);
        Searched found =
            search_straight(whole_, part, model_, effects_, result_, aside, work_, has_position_);
        found.ground = {};  // its columns are not needed any more
        if (other_ && !(has_position_ && other_has_position_)) before.of_other(*other_);
        Candidate last = tested(found, before.has_other());
        if (is_residual_left(found, last)) {
            const ModelBench plain = *found.bench;
            Diagnosis first_result = result_;
            const std::size_t own = own_;
            first_bench_ = &plain;
            Searched again = search_again(found, part, model_, effects_, more_work_);
            Candidate last_again = tested(again, before.has_other());
            first_bench_ = nullptr;
            const auto left_nm = [&](const Candidate& model) {
                return rms(plain.cleared_residual(model.stated));
            };
            if (options_.given.empty() || left_nm(last_again) < left_nm(last)) {
                found = std::move(again);
                last = std::move(last_again);
                result_.unexplained = residual_regions(plain, last.stated);
                result_.gap.noise_floor_nm = plain.floor_nm(last.stated);
                result_.residual_in_noise = true;
            } else {
                result_ = std::move(first_result);
                own_ = own;
            }
        }
        result_.angle = before.account(whole_, other_ ? &*other_ : nullptr);
        if (!has_position_) result_.undecidable = undecidable(*found.bench, last, effects_, without_);
        if (!model_.has_gear_ratio()) list_effects_of_motor();
        if (!moves_both_ways_) list_of_both_directions();
        measure_at_samples(spoiled, whole_, last.stated);
        result_.unexplained.insert(result_.unexplained.begin(), spoiled.begin(), spoiled.end());
        result_.unexplained.insert(result_.unexplained.begin(), aside.begin(), aside.end());
        report(found, last, part, aside);
        return std::move(result_);
    }

  private:
    void list_effects_of_motor() {
        for (const Effect* effect : examined(without_, {})) {
            if (needs_gear_ratio(*effect))
                result_.undecidable.push_back({effect->name, "needs the gear ratio, --gear-ratio N", 0.0});
        }
    }

    void list_of_both_directions() {
        for (const Effect* effect : examined(without_, {})) {
            if (effect->differs)
                result_.undecidable.push_back({effect->name, "needs motion in both directions", 0.0});
        }
    }

    // The effect of the motor for which the catalogue says that this one may be mistaken, if there is one.
    [[nodiscard]] const Effect* look_alike_of_motor(const Effect& effect) const {
        for (const Effect* other : catalogue()) {
            // What changes a ripple is a rival of nothing where there is none.
            if (needs_gear_ratio(*other) && other->side != Side::ripple && !is_among(without_, other->name) &&
                std::ranges::find(effect.look_alikes, other->name, &LookAlike::name) !=
                    effect.look_alikes.end())
                return other;
        }
        return nullptr;
    }

    // Without the gear ratio an effect of the motor is no rival, and what resembles one is no finding by
    // itself. Over a short travel a ripple of few cycles per turn is as smooth as a weight or an offset:
    // identify takes no ratio below 3, and 3 cycles are in opposition to the one of a weight after a quarter
    // of a turn.
    void tie_with_effects_of_motor(const Case& c) {
        if (model_.has_gear_ratio()) return;
        constexpr double least_ratio = 3.0, least_turns = 0.5 / (least_ratio - 1.0);
        const auto [low, high] = std::ranges::minmax(c.motion.position_deg);
        const bool is_short = (high - low) / 360.0 < least_turns && !is_among(without_, "ripple");
        for (Finding& finding : result_.rounds) {
            if (!is_trusted(finding)) continue;
            const Effect& effect = *finding.term.effect;
            const Effect* rival = look_alike_of_motor(effect);
            if (rival == nullptr && is_short && (needs_position(effect) || effect.name == "offset"))
                rival = &find_effect("ripple");
            if (rival == nullptr) continue;
            finding.status = FindingStatus::ambiguous;
            finding.alternatives.insert(finding.alternatives.begin(), {rival->name, 0.0});
        }
    }

    // Which findings hold, and the residual then.
    [[nodiscard]] Candidate tested(Searched& found, bool other_begins_anywhere) {
        const ModelBench& bench = *found.bench;
        std::size_t own = model_.terms.size();
        result_.unexplained = residual_regions(bench, found.last.stated);
        // A known torque is never right everywhere, and its residual is no reason against a finding that
        // rises above it. A model of the joint alone should leave nothing.
        const bool may_be_left = bench.noise_holds_residual() && !options_.given.empty();
        const auto unexplained = may_be_left ? std::vector<ResidualRegion>()
                                 : first_bench_ != nullptr
                                     ? residual_regions(*first_bench_, found.last.stated)
                                     : result_.unexplained;
        result_.rounds = judge(bench, found.last, own, effects_, unexplained);
        drop_collinear(found, unexplained);
        if (fits_offset_ && options_.setup.empty()) promote_offset(found, own, unexplained);
        doubt_for_setup();
        doubt_for_travel(bench.looked_at(), found.last.stated);
        tie_with_effects_of_motor(bench.looked_at());
        own_ = own;
        result_.refused = found.refused;
        result_.baseline = as_given(bench, found.first).stated;
        result_.evaluations =
            bench.work().spent() * Work::unit_samples / static_cast<double>(bench.looked_at().size());
        result_.search_ended = bench.work().ended();
        result_.gap.noise_floor_nm = bench.floor_nm(found.last.stated);
        result_.noise_color = found.noise.color;
        measure_rounds(result_, bench, found.last, own);
        Candidate last = believed(bench, found.last, own, result_.rounds);
        if (other_ && other_begins_anywhere) put_in_place(*other_, last.stated);
        if (other_)
            last = reproduced(bench, found.last, last, result_.baseline, *other_, own, result_.rounds);
        // The torque of an uncertain finding counts as unexplained.
        if (last.stated.terms.size() < found.last.stated.terms.size())
            result_.unexplained = residual_regions(bench, last.stated);
        return last;
    }

    // Findings whose torques are nearly collinear hide what each of them would be without the
    // other: the weakest goes, and the others are tested without it.
    void drop_collinear(Searched& found, const std::vector<ResidualRegion>& unexplained) {
        const std::size_t own = model_.terms.size();
        for (std::size_t most = result_.rounds.size(); most > 0; --most) {
            const auto doubtful = std::ranges::count_if(result_.rounds, is_doubtful);
            if (std::ranges::count(result_.rounds, FindingStatus::unidentifiable, &Finding::status) == 0 ||
                doubtful < 2)
                return;
            std::optional<std::size_t> weakest;
            for (std::size_t i = 0; i < result_.rounds.size(); ++i) {
                const bool weaker = !weakest || result_.rounds[i].evidence.share_nm <
                                                    result_.rounds[*weakest].evidence.share_nm;
                if (is_doubtful(result_.rounds[i]) && weaker) weakest = i;
            }
            found.last = without_term(*found.bench, found.last, own + *weakest);
            result_.rounds = judge(*found.bench, found.last, own, effects_, unexplained);
        }
    }

    // Without the offset of an arm fit where that is a finding.
    [[nodiscard]] Candidate as_given(const ModelBench& bench, const Candidate& first) const {
        return own_ < first.stated.terms.size() ? without_term(bench, first, own_) : first;
    }

    // The offset of an arm fit is a finding where it passes the same tests, and is larger than the residual.
    void promote_offset(Searched& found, std::size_t& own, const std::vector<ResidualRegion>& unexplained) {
        const ModelBench& bench = *found.bench;
        Candidate model = found.last;
        const std::size_t place = own - 1;
        model.prices[place] =
            portable::log(bench.samples()) +
            2.0 * portable::log(static_cast<double>(effects_.size()) / limits::screening::false_alarm);
        Finding offset = judged_alone(bench, model, place, effects_, unexplained);
        if (offset.status != FindingStatus::confirmed || offset.evidence.gain < model.prices[place] ||
            offset.evidence.share_nm < rms(bench.cleared_residual(model.stated)))
            return;
        found.last.prices[place] = model.prices[place];
        result_.rounds.insert(result_.rounds.begin(), std::move(offset));
        own = place;
    }

    // Cycles per output turn of a torque of the output angle.
    static std::optional<double> output_order(const Term& term) {
        if (term.effect->name == "gravity") return 1.0;
        return term.effect->name == "output-ripple" ? term.values[0] : std::nullopt;
    }

    // A torque that repeats with the output angle has to be seen over a cycle of its own, and two of them
    // until they are in opposition: over less, any weight bends alike. Where other joints move, or more than
    // noise is left, it needs a whole turn to be distinguished from what that is.
    void doubt_for_travel(const Case& c, const Model& model) {
        const auto [low, high] = std::ranges::minmax(c.motion.position_deg);
        const double turns = (high - low) / 360.0;
        const bool may_be_other = options_.others_move || first_bench_ != nullptr;
        for (Finding& finding : result_.rounds) {
            if (!is_trusted(finding) || finding.term.effect->name != "output-ripple") continue;
            const double order = finding.term.values[0].value_or(1.0);
            const bool is_alike = std::ranges::any_of(model.terms, [&](const Term& term) {
                const auto other = output_order(term);
                return other && *other != order && std::abs(*other - order) * turns < 0.5;
            });
            if (turns * order >= 1.0 && !is_alike && (turns >= 1.0 || !may_be_other)) continue;
            finding.status = FindingStatus::tentative;
            finding.reason =
                fmt::format("the travel of {:.0f} deg, {:.2g} of its cycles, does not distinguish it from {}",
                            high - low, turns * order, is_alike ? "another order" : "a weight");
        }
    }

    // A fault of the set-up causes torques that effects of the joint may imitate.
    void doubt_for_setup() {
        if (options_.setup.empty()) return;
        for (Finding& finding : result_.rounds) {
            if (!is_trusted(finding)) continue;
            finding.status = FindingStatus::tentative;
            finding.reason = "the fault of the set-up may cause it";
        }
    }

    // With a known torque, uncertain findings may explain that torque's error, which counts as residual.
    [[nodiscard]] bool is_residual_left(const Searched& found, const Candidate& last) const {
        if (!options_.setup.empty()) return false;
        const bool doubtful = std::any_of(result_.rounds.begin(), result_.rounds.end(), is_doubtful);
        const Model& model = options_.given.empty() ? found.last.stated : last.stated;
        return (doubtful || !result_.unexplained.empty()) &&
               rms(found.bench->cleared_residual(model)) > limits::residual::least_left * found.noise.rms_nm;
    }

    // The excerpt chose; the whole log gives the values.
    void report(const Searched& found, Candidate last, const Case& part,
                const std::vector<ResidualRegion>& aside) {
        const bool is_excerpt = part.size() < whole_.size();
        Case all = is_excerpt ? whole_ : part;
        if (is_excerpt) {
            (void)set_aside(all, aside);
            ModelBench bench(all, found.noise, work_);
            bench.settle_on(last.stated);
            last = bench.fitted(last.open, last.stated, last.prices, 4);
            const Candidate first = as_given(bench, found.first);
            result_.baseline = bench.fitted(first.open, first.stated, first.prices, 4).stated;
        }
        result_.samples_used = all.used();
        add_unused_rows(result_.unused, all, "a disturbance of short duration");
        result_.acts_where_unused = mainly_unused(effects_, all, model_);
        while (true) {
            const Candidate settled =
                final_values(all, found.noise, last, {result_.faults, result_.rounds, own_}, work_);
            report_model(settled);
            measure(settled, found.noise, all);
            if (!withdraw_for_gap(*found.bench, last)) break;
        }
        name_findings(result_);
        for (const Fault& fault : result_.faults) result_.named.emplace_back(fault.term.effect->name);
        result_.verdict = verdict_of(result_);
    }

    // The improved model with its values, and those of each finding.
    void report_model(const Candidate& last) {
        result_.model = last.stated;
        result_.values = last.values;
        for (FittedValue& value : result_.values)
            widen_interval(value, last.stated.terms[value.term].effect->parameters[value.parameter],
                           limits::values::interval_factor);
        std::size_t place = own_;
        for (Finding& finding : result_.rounds) {
            if (is_doubtful(finding)) continue;
            finding.term = last.stated.terms[place];
            finding.values.clear();
            for (const FittedValue& value : result_.values) {
                if (value.term == place) finding.values.push_back(value);
            }
            ++place;
        }
    }

    // The gaps; they equal those of `simulate` with the same model and log.
    void measure(const Candidate& last, const NoiseFloor& noise, const Case& all) {
        const KnownValues known = fit_known_values(all, last.stated, noise);
        // The uncertain values of an arm are also fitted with the model as given.
        const KnownValues alone = fit_known_values(all, result_.baseline, noise);
        result_.given = reported_values(options_.given, known);
        given_alone_ = reported_values(options_.given, alone);
        const Case improved = with_known_values(whole_, known), as_given = with_known_values(whole_, alone);
        const auto of_other = [&](const KnownValues& values) {
            return other_ ? std::optional(with_known_values(*other_, values)) : std::nullopt;
        };
        const std::optional<Case> other = of_other(known), other_as_given = of_other(alone);
        // A fault of the converter belongs to the model where that predicts the log better with it.
        for (const Fault& fault : result_.faults) {
            Model with = result_.model;
            with.terms.push_back(fault.term);
            if (left_rms(improved, with) <= left_rms(improved, result_.model))
                result_.model = std::move(with);
        }
        const GapCase log_gap{as_given, improved};
        const std::optional<GapCase> other_gap =
            other ? std::optional<GapCase>({*other_as_given, *other}) : std::nullopt;
        measure_gap(result_, log_gap, other_gap ? &*other_gap : nullptr);
        if (options_.given.empty()) return;
        result_.residual_before_nm = residual_nm(as_given, result_.baseline);
        result_.residual_after_nm = residual_nm(improved, result_.model);
        result_.beside_given_nm = residual_nm(improved, {result_.model.gear_ratio, {}});
    }

    // A model whose residual exceeds that of the one given, here or on the validation log, is no improvement:
    // the newest finding is withdrawn, or with none the previous values are restored. True when something was
    // withdrawn.
    [[nodiscard]] bool withdraw_for_gap(const ModelBench& bench, Candidate& last) {
        const DiagnosisGap& gap = result_.gap;
        const bool grows_here = gap.after_nm > gap.before_nm;
        const bool grows_there =
            gap.validation_after_nm && *gap.validation_after_nm > *gap.validation_before_nm;
        if (!grows_here && !grows_there) return false;
        std::size_t place = last.stated.terms.size();
        for (auto finding = result_.rounds.rbegin(); finding != result_.rounds.rend(); ++finding) {
            if (is_doubtful(*finding)) continue;
            finding->status = FindingStatus::not_reproduced;
            finding->reason = fmt::format(
                "with it the residual of {} is larger with the improved model than with the model as given",
                grows_here ? "the log" : "the validation log");
            last = without_term(bench, last, --place);
            return true;
        }
        result_.model = result_.baseline;
        result_.given = given_alone_;
        result_.gap.after_nm = gap.before_nm;
        result_.gap.validation_after_nm = gap.validation_before_nm;
        result_.gap.closed_percent = result_.gap.closed_percent ? std::optional(0.0) : std::nullopt;
        result_.gap.validation_closed_percent =
            result_.gap.validation_closed_percent ? std::optional(0.0) : std::nullopt;
        result_.residual_after_nm = result_.residual_before_nm;
        return false;
    }

    const DiagnosisOptions& options_;
    Model model_;
    bool has_position_, other_has_position_ = false, fits_offset_ = false, moves_both_ways_ = true;
    Case whole_;
    std::optional<Case> other_;
    Work work_, more_work_;
    std::vector<GivenValue> given_alone_;      ///< fitted with the model as given
    const ModelBench* first_bench_ = nullptr;  ///< with the noise of the first search, during the second
    std::size_t own_ = 0;                      ///< terms of the model as given
    std::vector<std::string> without_;
    std::vector<const Effect*> effects_;
    Diagnosis result_;
};

}  // namespace

Diagnosis diagnose(const Model& model, const TraceView& log, const TraceView* validation,
                   const DiagnosisOptions& options) {
    for (const std::string& name : options.without) (void)find_effect(name);
    check_rows(options.given, log.size(), "the log");
    if (validation != nullptr) {
        if (options.validation_given.size() != options.given.size())
            raise<UsageError>("{} terms are given for the log and {} for the validation log",
                              options.given.size(), options.validation_given.size());
        check_rows(options.validation_given, validation->size(), "the validation log");
    }
    return DiagnosisRun(model, log, validation, options).run();
}

}  // namespace ripplenotch
