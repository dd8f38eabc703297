// SPDX-License-Identifier: MIT
// A diagnosis: the engine finds what is missing, and this file makes of it an improved model, its gap here
// and on the validation log, and what is left open.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/matrices/least_squares.hpp"
#include "core/rows/row_facts.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/answer/answer.hpp"
#include "diagnose/engine/criterion.hpp"
#include "diagnose/engine/engine.hpp"
#include "diagnose/engine/search.hpp"
#include "diagnose/engine/terms.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {
namespace {

// The user's side is known to four per cent: a departure within is corrected and not named.
constexpr double known_deviation = 0.04;
// Errors of a value, from which on it departs from what the user stated: as the t of a term.
constexpr double least_departure = 4.0;
// Of the floor's square: a smaller gap is none to speak of, and no part of it is said to be closed.
constexpr double least_gap = 0.02;
// Below a turn the integral of a velocity does not tell where the joint is.
constexpr double one_turn_deg = 360.0;
// Residual of the improved model over that of the search, from which on its sizes are fitted anew.
constexpr double most_lost = 1.1;
// A shape whose error is that share of it is not determined by the rows of the search.
constexpr double undetermined_error = 0.3;
// Each direction has to have this share of the log for effects that differ by direction.
constexpr double least_direction = 0.05;

bool is_among(std::span<const std::string> names, std::string_view name) {
    return std::ranges::find(names, name) != names.end();
}

const GivenTerm* find_given(std::span<const GivenTerm> given, std::string_view name) {
    const auto found = std::ranges::find(given, name, &GivenTerm::name);
    return found == given.end() ? nullptr : &*found;
}

void check_rows(std::span<const GivenTerm> given, std::size_t rows, std::string_view log) {
    for (const GivenTerm& term : given) {
        for (const auto& column : term.torque_nm) {
            if (column.size() != rows)
                raise<UsageError>("{}: {} values for the {} rows of {}", term.name, column.size(), rows, log);
        }
    }
}

// Friction that turns over with the direction, over a speed or over an angle: one effect to the joint, told
// by the plainer form that explains as much.
bool is_friction_loop(const Effect& effect) {
    return effect.name == "coulomb-friction" || effect.name == "hysteresis";
}

std::optional<double> closed_percent(double before_nm, double after_nm, double floor_nm) {
    const double floor = floor_nm * floor_nm, before = before_nm * before_nm - floor;
    if (before < least_gap * floor || before <= 0.0) return std::nullopt;
    const double closed = 100.0 * (1.0 - std::max(after_nm * after_nm - floor, 0.0) / before);
    return std::abs(closed) < 1e-3 ? 0.0 : closed;
}

class DiagnosisRun {
  public:
    DiagnosisRun(const Model& model, const TraceView& log, const TraceView* validation,
                 const DiagnosisOptions& options)
        : options_(options), model_(model), log_(log), simulated_(find_given(options.given, "simulated")) {
        if (log.size() < fewest_samples_diagnosed)
            raise<DataError>("the log has {} rows; a diagnosis needs at least {}", log.size(),
                             fewest_samples_diagnosed);
        along_ = log_along(log, options.given, options.smoothing);
        along_.motion.others_deg_s.assign(options.others_deg_s.begin(), options.others_deg_s.end());
        if (validation != nullptr) {
            other_ = log_along(*validation, options.validation_given, options.smoothing);
            other_->motion.others_deg_s.assign(options.validation_others_deg_s.begin(),
                                               options.validation_others_deg_s.end());
        }
        model_.beside_simulation = simulated_ != nullptr;
    }

    [[nodiscard]] Diagnosis run() {
        result_.has_position = log_.has_position();
        result_.samples = log_.size();
        result_.setup.assign(options_.setup.begin(), options_.setup.end());
        find_log_faults();
        const SettledModel alone = settled(model_, along_, {});
        result_.baseline = alone.model;
        if (options_.setup.empty()) {
            require_motion();
            search();
        } else {
            result_.gap.noise_floor_nm = rms_where(alone.residual_nm, along_.use);
        }
        // The rows that count for the engine count for the values.
        alone_ = settled(model_, along_, departure_beside(0));
        result_.baseline = alone_.model;
        accept();
        improve();
        report();
        return std::move(result_);
    }

  private:
    void find_log_faults() {
        result_.faults = find_faults(along_.motion, along_.torque_nm, along_.use);
        std::erase_if(result_.faults, [&](const Fault& fault) {
            return is_among(options_.without, fault.term.effect->name);
        });
        if (!other_) return;
        (void)find_faults(other_->motion, other_->torque_nm, other_->use);
    }

    void require_motion() const {
        const auto& velocity = along_.motion.velocity_deg_s;
        if (std::ranges::all_of(velocity, [](double v) { return v == 0.0; }))
            raise<DataError>("the joint does not move in this log; a diagnosis needs motion");
    }

    [[nodiscard]] bool moves_both_ways() const {
        std::size_t positive = 0, negative = 0;
        for (const double v : along_.motion.velocity_deg_s) ++(v > 0.0 ? positive : negative);
        std::size_t still = 0;
        for (const double v : along_.motion.velocity_deg_s) still += v == 0.0 ? 1 : 0;
        return static_cast<double>(std::min(positive, negative - still)) >=
               least_direction * static_cast<double>(log_.size());
    }

    // Effects that are not tried, and why this log does not let them be.
    [[nodiscard]] std::vector<std::string> not_tried() {
        std::vector<std::string> names(options_.without.begin(), options_.without.end());
        const auto [low, high] = std::ranges::minmax(along_.motion.position_deg);
        const bool tells_position = log_.has_position() || high - low >= one_turn_deg;
        const bool both_ways = moves_both_ways();
        for (const Effect* effect : catalogue()) {
            if (is_among(options_.without, effect->name)) continue;
            std::string reason;
            if (needs_gear_ratio(*effect) && !model_.has_gear_ratio())
                reason = "needs the gear ratio, --gear-ratio N";
            else if (needs_position(*effect) && !tells_position)
                reason = "it depends on where the joint is, and the log has no position";
            else if (effect->differs && !both_ways)
                reason = "needs motion in both directions";
            if (reason.empty()) continue;
            names.emplace_back(effect->name);
            result_.undecidable.push_back({effect->name, std::move(reason)});
        }
        // An arm has inertia and gravity of its own.
        if (is_given(options_.given, "arm"))
            names.insert(names.end(), {"gravity", "inertia", "payload-change"});
        return names;
    }

    // With a simulation the engine takes its torque for all of what the user knows: terms of the model are
    // given as columns.
    [[nodiscard]] std::vector<GivenTerm> columns_of_model() const {
        std::vector<GivenTerm> columns;
        const Situation situation{.motion = along_.motion, .ratio = model_.gear_ratio};
        for (const Term& term : model_.terms) {
            const Effect& effect = *term.effect;
            if (effect.side != Side::joint || effect.ripple_order || effect.uses_load) continue;
            std::vector<double> values;
            for (std::size_t p = 0; p < term.values.size(); ++p)
                values.push_back(term.values[p].value_or(effect.parameters[p].start));
            const bool is_stated =
                std::ranges::all_of(term.values, [](const auto& value) { return value.has_value(); });
            GivenTerm column{std::string(effect.name), {}, {}, {}};
            if (is_stated) {
                column.torque_nm.emplace_back(log_.size(), 0.0);
                effect.apply(situation, values, column.torque_nm.front());
            } else {
                column.torque_nm = engine::unit_columns(effect, values, situation);
            }
            column.mean.assign(column.torque_nm.size(), is_stated ? 1.0 : 0.0);
            column.deviation.assign(column.torque_nm.size(),
                                    is_stated ? stated_deviation : std::numeric_limits<double>::infinity());
            columns.push_back(std::move(column));
        }
        return columns;
    }

    void search() {
        std::vector<std::string> without = not_tried();
        std::vector<double> simulated_nm;
        TraceView log = log_;
        log.torque_nm = along_.torque_nm;
        std::vector<GivenTerm> given;
        for (const GivenTerm& term : options_.given)
            if (&term != simulated_) given.push_back(term);
        std::optional<engine::Simulation> simulation;
        if (simulated_ != nullptr) {
            simulated_nm = simulated_->torque_nm.front();
            for (double& nm : simulated_nm) nm *= simulated_->mean.front();
            simulation = {simulated_nm, options_.simulated_velocity_deg_s, options_.simulated_position_deg,
                          simulated_->deviation.front() <= stated_deviation};
            for (GivenTerm& column : columns_of_model()) given.push_back(std::move(column));
        }
        const engine::Result found = engine::find_missing_effects({.log = log,
                                                                   .model = model_,
                                                                   .simulation = simulation,
                                                                   .given_terms = given,
                                                                   .others_deg_s = options_.others_deg_s,
                                                                   .without = without,
                                                                   .is_good_row = along_.use});
        good_ = along_.use;
        along_.use = found.is_used;
        result_.samples_used = found.samples;
        result_.smoothing_s = found.smoothing_s;
        result_.gap.noise_floor_nm = found.noise_nm;
        engine_residual_nm_ = found.residual_after_nm;
        searched_before_nm_ = found.rms_before_nm;
        std::size_t taken = 0;
        take_spikes(found.spike_rows);
        take_departures(found);
        take_known_values(found, 0);
        for (const engine::AdoptedTerm& term : found.terms) {
            take(term, FindingStatus::confirmed);
            take_known_values(found, ++taken);
        }
        for (const engine::AdoptedTerm& term : found.corrections) {
            take(term, FindingStatus::correction);
            take_known_values(found, ++taken);
        }
        for (const engine::NearlyAdopted& term : found.nearly_adopted)
            result_.refused.push_back({term.term, term.reason});
    }

    // Spikes that the engine alone sees.
    void take_spikes(std::span<const std::size_t> rows) {
        const Effect& spikes = find_effect("spikes");
        if (rows.empty() || is_among(options_.without, spikes.name) ||
            std::ranges::any_of(result_.faults,
                                [&](const Fault& known) { return known.term.effect == &spikes; }))
            return;
        Fault seen{{&spikes, {}}, rows.size(), {}, fmt::format("{} samples", rows.size())};
        for (const Parameter& parameter : spikes.parameters) seen.term.values.emplace_back(parameter.start);
        for (const std::size_t row : rows) seen.time_s.push_back({log_.time_s[row], log_.time_s[row]});
        result_.faults.push_back(std::move(seen));
    }

    [[nodiscard]] const Term* own_term(std::string_view name) const {
        const auto found =
            std::ranges::find_if(model_.terms, [&](const Term& term) { return term.effect->name == name; });
        return found == model_.terms.end() ? nullptr : &*found;
    }

    // The factors of an arm, as the engine fits them with its first terms, which are the findings so far.
    void take_known_values(const engine::Result& found, std::size_t terms) {
        departures_.resize(result_.rounds.size() + 1);
        departures_.back().clear();
        departure_error_.clear();
        for (std::size_t c = 0; c < found.baseline.size(); ++c) {
            if (found.baseline[c].name != "arm") continue;
            departures_.back().push_back(found.baseline_factors[terms][c]);
            departure_error_.push_back(found.baseline[c].standard_error);
        }
    }

    // That of the uncertain factors with the first so many findings.
    [[nodiscard]] std::span<const double> departure_beside(std::size_t findings) const {
        if (departures_.empty()) return {};
        return departures_[std::min(findings, departures_.size() - 1)];
    }

    // What the values of the user's side come to, where that is not what he states.
    void take_departures(const engine::Result& found) {
        for (const engine::ValuedColumn& column : found.baseline) {
            if (column.name == "simulated")
                depart("simulation-scale", 100.0 * (column.factor - 1.0), 100.0 * column.standard_error,
                       0.01 * rms_where(along_.motion.known_nm, along_.use), 100.0);
            if (column.name != "inertia") continue;
            if (own_term("inertia") != nullptr) continue;
            const double unit = degrees_per_radian;
            depart("inertia", column.factor * unit, column.standard_error * unit,
                   rms_where(along_.motion.acceleration_deg_s2, along_.use) / unit,
                   std::abs(found.simulated_inertia_nm_per_deg_s2) * unit);
            break;  // the first column of that name is the engine's own
        }
    }

    void depart(std::string_view name, double value, double error, double unit_rms_nm, double known) {
        const double rms_nm = std::abs(value) * unit_rms_nm, noise_nm = result_.gap.noise_floor_nm;
        const Effect& effect = find_effect(name);
        if (is_among(options_.without, name) || std::abs(value) < least_departure * error ||
            rms_nm < engine::least_noise_share * noise_nm || value < effect.parameters.front().lower)
            return;
        Finding finding;
        finding.term = {&effect, {value}};
        const double half = normal_95_errors * error;
        finding.values = {{.parameter = 0,
                           .value = value,
                           .standard_error = error,
                           .ci95 = Interval{value - half, value + half}}};
        if (std::abs(value) <= known_deviation * known) {
            finding.status = FindingStatus::correction;
            finding.reason = "the user's side is not known better";
        } else if (rms_nm * rms_nm < engine::least_gap_share * searched_before_nm_ * searched_before_nm_) {
            finding.status = FindingStatus::correction;
            finding.reason = "it explains a small part of the gap";
        }
        finding.evidence.noise_share = noise_nm > 0.0 ? rms_nm / noise_nm : 0.0;
        finding.evidence.block_t = std::abs(value) / std::max(error, 1e-300);
        finding.evidence.reduction = finding.evidence.block_t * finding.evidence.block_t;
        result_.rounds.push_back(std::move(finding));
    }

    void take(const engine::AdoptedTerm& adopted, FindingStatus status) {
        const Effect& effect = *adopted.term.effect;
        // What the model leaves open of sensor, motion or ripple is fitted with it; next to what it states a
        // finding is more of that.
        const Term* own = own_term(effect.name);
        if (own != nullptr && effect.side != Side::joint &&
            std::ranges::any_of(own->values, [](const auto& value) { return !value; }))
            return;
        Finding finding;
        finding.term = adopted.term;
        finding.status = status;
        finding.values = adopted.values;
        finding.evidence = {adopted.reduction, adopted.block_t, adopted.noise_share, adopted.explained_share};
        for (const engine::Rival& rival : adopted.rivals)
            finding.alternatives.push_back({rival.term, rival.margin});
        if (status == FindingStatus::correction) {
            finding.alternatives.clear();
            finding.reason = "below what the log resolves";
        } else if (std::ranges::any_of(finding.alternatives, [&](const RivalFinding& rival) {
                       return !(is_friction_loop(*rival.term.effect) && is_friction_loop(effect));
                   })) {
            finding.status = FindingStatus::ambiguous;
            finding.reason = "another effect explains the log as well";
        }
        if (finding.status != FindingStatus::correction) doubt_short_travel(finding);
        result_.rounds.push_back(std::move(finding));
    }

    // Over less than one of its cycles a torque of the output angle bends as a weight does.
    void doubt_short_travel(Finding& finding) const {
        if (finding.term.effect->name != "output-ripple") return;
        const auto [low, high] = std::ranges::minmax(along_.motion.position_deg);
        const double cycles = *finding.term.values.front() * (high - low) / one_turn_deg;
        if (cycles >= 1.0) return;
        finding.status = FindingStatus::ambiguous;
        finding.reason = fmt::format(
            "the travel of {:.0f} deg, {:.2g} of its cycles, does not distinguish it from a weight",
            high - low, cycles);
        const Effect& gravity = find_effect("gravity");
        finding.alternatives.push_back({{&gravity, {finding.term.values[1], finding.term.values[2]}}, 0.0});
    }

    // What the user takes into the model: the side of a tie in the place of the finding, or a term that was
    // refused.
    void accept() {
        for (const std::string& name : options_.accept) {
            const bool is_found = accept_side(name) || accept_refused(name);
            if (!is_found) unknown_.push_back(name);
        }
    }

    bool accept_side(const std::string& name) {
        for (const Finding& finding : result_.rounds) {
            if (finding.status != FindingStatus::ambiguous) continue;
            const Term* side = finding.term.effect->name == name ? &finding.term : nullptr;
            for (const RivalFinding& rival : finding.alternatives)
                if (side == nullptr && rival.term.effect->name == name) side = &rival.term;
            if (side == nullptr) continue;
            accepted_.push_back({*side, finding.status, finding.reason});
            replaced_.push_back(&finding);
            return true;
        }
        return false;
    }

    bool accept_refused(const std::string& name) {
        for (const RefusedCandidate& refused : result_.refused) {
            if (refused.term.effect->name != name) continue;
            accepted_.push_back({refused.term, FindingStatus::refused, refused.reason});
            return true;
        }
        return false;
    }

    [[nodiscard]] bool is_replaced(const Finding& finding) const {
        return std::ranges::find(replaced_, &finding) != replaced_.end();
    }

    // Own terms, then what was accepted, then the findings that are in the model, up to so many.
    [[nodiscard]] Model model_with(std::size_t findings, const Finding* except = nullptr) const {
        Model model = model_;
        for (const AcceptedFinding& one : accepted_) model.terms.push_back(one.term);
        for (std::size_t i = 0; i < findings; ++i) {
            const Finding& finding = result_.rounds[i];
            if (finding.is_in_model() && &finding != except && !is_replaced(finding))
                model.terms.push_back(finding.term);
        }
        return model;
    }

    [[nodiscard]] SettledModel settled_with(std::size_t findings, const Finding* except = nullptr) const {
        std::size_t last = 0;
        for (std::size_t i = 0; i < findings; ++i)
            if (result_.rounds[i].is_in_model() && &result_.rounds[i] != except) last = i + 1;
        return settled(model_with(findings, except), along_, departure_beside(last));
    }

    [[nodiscard]] double rms_of_other(const SettledModel& found) const {
        return rms(residual_along(found.model, *other_, found.departure));
    }

    // The improved model: no addition may make a gap grow, here or on the validation log.
    void improve() {
        const std::size_t count = result_.rounds.size();
        improved_ = settled_with(count);
        settle_sizes();
        withdraw_sizes_of_none();
        settle_shapes();
        if (other_) withdraw_on_other();
        while (grows()) {
            const auto newest =
                std::find_if(result_.rounds.rbegin(), result_.rounds.rend(),
                             [&](const Finding& f) { return f.is_in_model() && !is_replaced(f); });
            if (newest == result_.rounds.rend()) break;
            newest->status = FindingStatus::not_reproduced;
            newest->reason = "with it a gap is larger than with the model as given";
            is_withdrawn_ = true;
            improved_ = settled_with(count);
        }
        double before_nm = rms(alone_.residual_nm);
        std::size_t last = 0;
        for (std::size_t i = 0; i < count; ++i)
            if (result_.rounds[i].is_in_model()) last = i;
        for (std::size_t i = 0; i < count; ++i) {
            Finding& finding = result_.rounds[i];
            if (!finding.is_in_model()) continue;
            finding.gap_before_nm = before_nm;
            finding.gap_after_nm = before_nm =
                rms(i == last ? improved_.residual_nm : settled_with(i + 1).residual_nm);
        }
    }

    // The search has its own load, motion and moved simulation. Where the improved model cannot have them its
    // sizes are those that leave least along the motion of `simulate`.
    void settle_sizes() {
        if (engine_residual_nm_.empty()) return;
        const double searched_nm = rms_where(engine_residual_nm_, along_.use);
        if (rms_where(improved_.residual_nm, along_.use) < most_lost * searched_nm) return;
        Model open = improved_.model;
        const std::size_t first = model_.terms.size() + accepted_.size();
        for (std::size_t place = first; place < open.terms.size(); ++place) {
            const Effect& effect = *open.terms[place].effect;
            for (std::size_t p = 0; p < effect.parameters.size(); ++p)
                if (effect.parameters[p].linear || (effect.polar && effect.polar->phase == p))
                    open.terms[place].values[p].reset();
        }
        const Model& own = model_;
        std::copy(own.terms.begin(), own.terms.end(), open.terms.begin());
        SettledModel found = settled(open, along_, improved_.departure, &improved_.model);
        if (rms(found.residual_nm) > rms(improved_.residual_nm)) return;
        std::size_t place = first;
        for (Finding& finding : result_.rounds) {
            if (!finding.is_in_model() || is_replaced(finding)) continue;
            finding.term = found.model.terms[place];
            for (const FittedValue& fitted : found.values)
                for (FittedValue& value : finding.values)
                    if (fitted.term == place && fitted.parameter == value.parameter) value = fitted;
            ++place;
        }
        improved_ = std::move(found);
    }

    // What the search found with a load or a motion that the improved model does not have may be nothing
    // there.
    void withdraw_sizes_of_none() {
        for (;;) {
            const auto none =
                std::find_if(result_.rounds.rbegin(), result_.rounds.rend(), [&](const Finding& finding) {
                    return finding.status == FindingStatus::confirmed && !is_replaced(finding) &&
                           engine::may_be_absent({finding.term, finding.values});
                });
            if (none == result_.rounds.rend()) return;
            none->status = FindingStatus::not_reproduced;
            none->reason = "in the model its size may be none";
            is_withdrawn_ = true;
            improved_ = settled_with(result_.rounds.size());
            settle_sizes();
        }
    }

    // A shape that the catalogue assumes is as assumed where that leaves less of all rows.
    void assume_shapes() {
        std::size_t place = model_.terms.size() + accepted_.size();
        for (Finding& finding : result_.rounds) {
            if (!finding.is_in_model() || is_replaced(finding)) continue;
            for (FittedValue& value : finding.values) {
                const Parameter& parameter = finding.term.effect->parameters[value.parameter];
                if (parameter.left_out != LeftOut::assumed) continue;
                Model assumed = improved_.model;
                assumed.terms[place].values[value.parameter] = parameter.start;
                std::vector<double> left_nm = residual_along(assumed, along_, improved_.departure);
                if (rms(left_nm) >= rms(improved_.residual_nm)) continue;
                improved_.model = std::move(assumed);
                improved_.residual_nm = std::move(left_nm);
                finding.term.values[value.parameter] = value.value = parameter.start;
                if (value.ci95 && (value.value < value.ci95->low || value.value > value.ci95->high))
                    value.ci95.reset();
            }
            ++place;
        }
    }

    // The step of a friction at standstill, where no rows are searched, is the one that leaves least of all
    // rows, within its interval.
    void settle_shapes() {
        if (good_.empty()) return;
        assume_shapes();
        Model open = improved_.model;
        std::vector<std::pair<Finding*, std::size_t>> shapes;  // and the place of the value
        std::size_t place = model_.terms.size() + accepted_.size();
        for (Finding& finding : result_.rounds) {
            if (!finding.is_in_model() || is_replaced(finding)) continue;
            for (std::size_t v = 0; v < finding.values.size(); ++v) {
                const FittedValue& value = finding.values[v];
                const Parameter& parameter = finding.term.effect->parameters[value.parameter];
                if (parameter.linear || parameter.left_out != LeftOut::fitted ||
                    finding.term.effect->domain != Domain::speed)
                    continue;
                open.terms[place].values[value.parameter].reset();
                shapes.emplace_back(&finding, v);
            }
            ++place;
        }
        if (shapes.empty()) return;
        LogAlong whole = along_;
        whole.use = good_;
        const SettledModel found = settled(open, whole, improved_.departure, &improved_.model);
        if (rms(found.residual_nm) >= rms(improved_.residual_nm)) return;
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            FittedValue& value = shapes[i].first->values[shapes[i].second];
            const bool is_determined =
                value.standard_error.value_or(0.0) < undetermined_error * std::abs(value.value);
            value.value = found.values[i].value;
            if (value.ci95 && is_determined)
                value.value = std::clamp(value.value, value.ci95->low, value.ci95->high);
            else if (value.ci95 && (value.value < value.ci95->low || value.value > value.ci95->high))
                value.ci95.reset();
            shapes[i].first->term.values[value.parameter] = value.value;
        }
        improved_ = settled_with(result_.rounds.size());
    }

    [[nodiscard]] bool grows() const {
        if (!accepted_.empty()) return false;
        if (rms(improved_.residual_nm) > rms(alone_.residual_nm)) return true;
        return other_ && rms_of_other(improved_) > rms_of_other(alone_);
    }

    // The finding that the validation log speaks against most is withdrawn, until none is left.
    void withdraw_on_other() {
        const std::size_t count = result_.rounds.size();
        while (true) {
            const double with_nm = rms_of_other(improved_);
            Finding* worst = nullptr;
            double least_nm = with_nm;
            for (Finding& finding : result_.rounds) {
                if (!finding.is_in_model() || is_replaced(finding)) continue;
                const double without_nm = rms_of_other(settled_with(count, &finding));
                finding.validation_before_nm = without_nm;
                finding.validation_after_nm = with_nm;
                if (finding.status == FindingStatus::correction || without_nm >= least_nm) continue;
                least_nm = without_nm;
                worst = &finding;
            }
            if (worst == nullptr) return;
            worst->status = FindingStatus::not_reproduced;
            worst->reason = "with it the residual of the validation log is larger";
            is_withdrawn_ = true;
            improved_ = settled_with(count);
        }
    }

    void report() {
        DiagnosisGap& gap = result_.gap;
        result_.model = improved_.model;
        std::ranges::copy_if(improved_.values, std::back_inserter(result_.values),
                             [&](const FittedValue& value) { return value.term < model_.terms.size(); });
        std::size_t place = model_.terms.size() + accepted_.size();
        for (Finding& finding : result_.rounds) {
            if (!finding.is_in_model() || is_replaced(finding)) continue;
            for (FittedValue& value : finding.values) value.term = place;
            result_.values.insert(result_.values.end(), finding.values.begin(), finding.values.end());
            ++place;
        }
        add_faults_to_model();
        result_.residual_before_nm = with_ripple(alone_.residual_nm, options_.given);
        result_.residual_after_nm = residual_along(result_.model, along_, improved_.departure);
        gap.before_nm = rms(result_.residual_before_nm);
        gap.after_nm = rms(result_.residual_after_nm);
        gap.closed_percent = closed_percent(gap.before_nm, gap.after_nm, gap.noise_floor_nm);
        if (other_) {
            gap.validation_before_nm = rms(with_ripple(
                residual_along(alone_.model, *other_, alone_.departure), options_.validation_given));
            gap.validation_after_nm = rms(residual_along(result_.model, *other_, improved_.departure));
            gap.validation_closed_percent =
                closed_percent(*gap.validation_before_nm, *gap.validation_after_nm, gap.noise_floor_nm);
        }
        result_.given = values_of_given(options_.given, improved_.departure, departure_error_);
        if (!options_.given.empty()) {
            result_.beside_given_nm =
                residual_along({result_.model.gear_ratio, {}}, along_, improved_.departure);
            result_.bands = band_gaps(log_.torque_nm, result_.beside_given_nm, result_.residual_after_nm,
                                      log_.sample_rate);
        }
        // What the search leaves along its own motion, unless the improved model leaves less; withdrawn and
        // accepted terms change that.
        const bool is_as_searched =
            !is_withdrawn_ && accepted_.empty() && !engine_residual_nm_.empty() &&
            rms_where(engine_residual_nm_, along_.use) < rms_where(result_.residual_after_nm, along_.use);
        if (options_.setup.empty())
            result_.remaining = remaining_residual(
                along_.motion, is_as_searched ? engine_residual_nm_ : result_.residual_after_nm, along_.use,
                gap.noise_floor_nm);
        result_.accepted = accepted_;
        std::erase_if(result_.rounds, [&](const Finding& finding) { return is_replaced(finding); });
        add_ripple();
        name_findings(result_);
        for (const std::string& name : unknown_)
            result_.not_accepted.push_back(why_not_accepted(result_, name));
        result_.verdict = verdict_of(result_);
        if (!accepted_.empty() &&
            (result_.verdict == DiagnosisVerdict::matches || result_.verdict == DiagnosisVerdict::explained))
            result_.verdict = DiagnosisVerdict::partly_explained;
        result_.next = next_steps(result_, along_.motion);
    }

    // The residual with the ripple in it that was found beforehand.
    [[nodiscard]] std::vector<double> with_ripple(std::vector<double> residual_nm,
                                                  std::span<const GivenTerm> given) const {
        const GivenTerm* ripple = find_given(given, "ripple");
        if (ripple == nullptr || options_.found_ripple.empty()) return residual_nm;
        add_scaled(1.0, ripple->torque_nm.front().data(), residual_nm.data(), residual_nm.size());
        return residual_nm;
    }

    // It is reported before all that was searched.
    void add_ripple() {
        std::vector<Finding> found;
        for (const Term& term : options_.found_ripple) {
            Finding& finding = found.emplace_back();
            finding.term = term;
            finding.is_given = true;
            finding.reason = "subtracted first; the gap is that of all orders and motors";
            const std::size_t size = term.effect->polar->size;
            finding.values = {{0, size, *term.values[size], {}, {}, false}};
            finding.gap_before_nm = result_.gap.before_nm;
            finding.gap_after_nm = rms(alone_.residual_nm);
        }
        result_.rounds.insert(result_.rounds.begin(), found.begin(), found.end());
    }

    // A fault of the converter belongs to the model where that predicts the log better with it.
    void add_faults_to_model() {
        double left_nm = rms_where(improved_.residual_nm, along_.use);
        for (const Fault& fault : result_.faults) {
            Model with = result_.model;
            with.terms.push_back(fault.term);
            const double with_nm = rms_where(residual_along(with, along_, improved_.departure), along_.use);
            if (with_nm > left_nm || rms(residual_along(with, along_, improved_.departure)) >
                                         rms(residual_along(result_.model, along_, improved_.departure)))
                continue;
            left_nm = with_nm;
            result_.model = std::move(with);
        }
    }

    const DiagnosisOptions& options_;
    Model model_;
    const TraceView& log_;
    const GivenTerm* simulated_;
    LogAlong along_;
    std::optional<LogAlong> other_;
    std::vector<unsigned char> good_;  ///< rows that hold the joint's torque
    SettledModel alone_, improved_;
    std::vector<double> engine_residual_nm_;
    std::vector<std::vector<double>> departures_;  ///< of the uncertain factors, by number of findings
    std::vector<double> departure_error_;
    std::vector<AcceptedFinding> accepted_;
    std::vector<const Finding*> replaced_;
    std::vector<std::string> unknown_;
    double searched_before_nm_ = 0.0;  ///< rms that the user's side leaves along the motion of the search
    bool is_withdrawn_ = false;
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
