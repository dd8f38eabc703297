// SPDX-License-Identifier: MIT
#include "diagnose/engine/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "diagnose/engine/criterion.hpp"
#include "diagnose/engine/gram.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {
namespace {

constexpr int most_rounds = 6, most_exchanges = 5;  // a search that goes on beyond them goes in circles
constexpr std::size_t tried_of_finalists = 3;
constexpr std::size_t exchange_finalists = 5;
constexpr std::size_t rival_paths = 2;
constexpr std::size_t finalist_count = 7;  // refined: the best by grid is not always the best refined
constexpr int payload_parts = 24;          // in which a change of the load is looked for
constexpr double most_turned = 0.8;        // of the samples, whose direction turns with a change of the load
constexpr int most_bias_steps = 40;        // an error of ten cycles when the log ends
constexpr double smallest_delay_s = 1e-4;  // the valley of a delay may be narrower than any grid
constexpr double one_error = 1.0;          // squares by which a value is off by its standard error
constexpr double least_gap = 0.02;         // of the squares of the noise: a gap is no smaller

// Of two terms that say nearly the same the plainer is preferred.
struct Plainer {
    std::string_view plain, other;
    double share;
};
constexpr std::array plainer_pairs = {
    Plainer{"delay", "lag", plain_delay_share},
    Plainer{"delay", "sensor-lowpass", plain_delay_share},
    Plainer{"delay", "resonance", plain_delay_share},
    Plainer{"coulomb-friction", "hysteresis", plain_friction_share},
    Plainer{"coulomb-friction", "stribeck-friction", plain_friction_share},
    Plainer{"hysteresis", "stribeck-friction", plain_friction_share},
    Plainer{"quadratic-viscous-friction", "stribeck-friction", plain_friction_share},
    Plainer{"coulomb-friction", "backlash", plain_friction_share},
    Plainer{"hysteresis", "backlash", plain_friction_share},
    Plainer{"coulomb-friction", "position-dependent-friction", plain_friction_share},
    Plainer{"drift", "payload-change", plain_friction_share},
    // Four values in place of one or two: a step in time fits whatever happens once.
    Plainer{"coulomb-friction", "payload-change", 0.7},
    Plainer{"hysteresis", "payload-change", 0.7},
    Plainer{"viscous-friction", "payload-change", 0.7},
    Plainer{"gravity", "position-dependent-friction", plain_friction_share},
    Plainer{"load-friction", "position-dependent-friction", 0.7},
};
const Plainer* plainer_than(const SearchedTerm& plain, const SearchedTerm& other) {
    const auto found = std::ranges::find_if(
        plainer_pairs, [&](const Plainer& pair) { return plain.is(pair.plain) && other.is(pair.other); });
    return found == plainer_pairs.end() ? nullptr : &*found;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> found(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) found[k] = a[k] - b[k];
    return found;
}

// Mean over its standard error.
double t_value(const std::vector<double>& values) {
    const double count = static_cast<double>(values.size()), mean = sum(values) / count;
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return sum(values) / (std::sqrt(squares / std::max(count - 1.0, 1.0) * count) + 1e-300);
}

// A transform, a ratio, a ripple or the motion of another joint changes what the saturated regression can
// explain.
bool changes_noise(const SearchedTerm& term) {
    return term.is_transform() || term.kind->role == Role::motor_angle || term.is("ripple") ||
           term.is("start-stop-ringing") || term.kind->effect->other_joint;
}

bool has_sensor(const SearchedTerms& terms) {
    return std::ranges::any_of(terms, [](const SearchedTerm& t) { return t.kind->role == Role::sensor; });
}

bool has_choice(const SearchedTerm& term) {
    return std::ranges::any_of(term.kind->searched, &SearchedValue::is_choice);
}

bool has_plain_size(const SearchedTerm& term) {
    for (std::size_t v = 0; v < term.kind->searched.size(); ++v)
        if (std::abs(term.values[v]) == term.kind->searched[v].plain) return true;
    return false;
}

bool is_at_bound(const SearchedTerm& term, const RecordedMotion& recorded) {
    if (!term.kind->is_refined || term.kind->role == Role::motor_angle) return false;
    // At the least number of cycles that is possible it is the form of a filter.
    if (term.is("start-stop-ringing") && term.values[0] * term.values[1] < 1.1 * fewest_cycles) return true;
    for (std::size_t i = 0; i < term.kind->searched.size(); ++i) {
        const double size = std::abs(term.values[i]);
        const SearchedValue& bounds = term.kind->searched[i];
        if (bounds.is_choice || bounds.may_be_at_bound) continue;
        const double upper = bounds.upper * width_scale(*term.kind, bounds, recorded);
        if (size <= bounds.lower * 1.02 || size >= upper * 0.98) return true;
    }
    return false;
}

// A change of the load at an end of the log is a load.
bool is_at_end(const SearchedTerm& term, const RecordedMotion& recorded) {
    const double share = term.values[0] / recorded.motion().time_s.back();
    return term.is("payload-change") && (share < 0.05 || share > 0.95);
}

SearchedTerms with(SearchedTerms terms, const SearchedTerm& more) {
    terms.push_back(more);
    return terms;
}

SearchedTerms without_place(SearchedTerms terms, std::size_t place) {
    terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(place));
    return terms;
}

}  // namespace

namespace {

// With the plain size of a searched value of the newest term, where it reaches nearly as much.
SearchedTerms plainer(Criterion& criterion, const SearchedTerms& fewer, const SearchedTerms& longer) {
    const double before = criterion.cost(fewer);
    SearchedTerms plain = longer;
    for (std::size_t v = 0; v < plain.back().kind->searched.size(); ++v)
        if (const double size = plain.back().kind->searched[v].plain; size > 0.0)
            plain.back().values[v] = std::copysign(size, plain.back().values[v]);
    const bool is_as_good =
        before - criterion.cost(plain) > plain_ratio_share * (before - criterion.cost(longer));
    return is_as_good ? plain : longer;
}

}  // namespace

bool is_below_resolution(const SearchedTerm& term, double step_s) {
    const double value = std::abs(term.values[0]);
    if (term.is("delay") || term.is("lag")) return value < 1.5 * step_s;
    // A low-pass delays what is slow by sqrt(2) / (2 pi cutoff).
    return term.is("sensor-lowpass") && value > 0.15 / step_s;
}

Search::Search(const RecordedMotion& recorded, const Baseline& base,
               std::shared_ptr<const SaturatedFit> noise, std::vector<std::string> without)
    : recorded_(recorded), base_(base), noise_(std::move(noise)), without_(std::move(without)) {}

Admission Search::admission(Criterion& criterion, const SearchedTerms& shorter, const SearchedTerms& longer) {
    Admission found;
    const double noise_nm = criterion.noise().noise_nm, samples = criterion.samples();
    const double least_squares = least_gap * samples;
    const double before = criterion.fit(shorter).squares;
    found.reduction = criterion.cost(shorter) - criterion.cost(longer);
    if (!criterion.fit(longer).is_physical) {
        found.reason = "its size is that of a drive, not of a friction";
        return found;
    }
    const BlockSquares &fit_before = criterion.block_squares(shorter),
                       &fit_after = criterion.block_squares(longer);
    const std::vector<double> plain =
        difference(criterion.plain_block_squares(shorter), criterion.plain_block_squares(longer));
    std::vector<double> by_block = difference(fit_before.fitted, fit_after.fitted);
    found.block_t = std::max(t_value(by_block), t_value(plain));
    found.noise_share = std::sqrt(std::max(sum(plain), 0.0) / samples) / noise_nm;
    found.gap_share = found.reduction / std::max(before - samples, least_squares);
    const auto added = std::ranges::find_if(
        longer, [&](const SearchedTerm& term) { return std::ranges::find(shorter, term) == shorter.end(); });
    // What is known is fitted within its prior all the same: with it a departure is worth what it explains
    // of the torque, not what it spares the prior.
    if (added != longer.end() && criterion.base().is_known(added->kind->effect->name)) {
        const double noise_squares = samples * noise_nm * noise_nm;
        by_block = plain;
        for (double& squares : by_block) squares /= noise_nm * noise_nm;
        found.gap_share = sum(plain) / std::max(sum(criterion.plain_block_squares(shorter)) - noise_squares,
                                                least_gap * noise_squares);
    }
    std::vector<double> held_out = difference(fit_before.held_out, fit_after.held_out);
    std::sort(held_out.begin(), held_out.end());
    double held_out_sum = sum(held_out);
    if (held_out.size() > 8) held_out_sum -= held_out.front() + held_out.back();
    std::sort(by_block.begin(), by_block.end());
    const auto best = std::max<std::size_t>(
        2, static_cast<std::size_t>(best_block_share * static_cast<double>(by_block.size())));
    by_block.resize(by_block.size() - std::min(best, by_block.size()));
    // Few stretches are enough for what closes most of the gap, if much remains without the best of them.
    // Friction with another friction may only correct the form of that.
    const bool corrects_form =
        added != longer.end() && added->is_friction_loop() &&
        (std::ranges::any_of(shorter, [](const SearchedTerm& t) { return t.is_friction_loop(); }) ||
         criterion.base().has("coulomb-friction") || criterion.base().states("coulomb-friction") ||
         criterion.base().is_simulated);
    const bool is_friction = added != longer.end() && added->kind->effect->resists;
    // All events that carry a friction or an offset, few as they may be, have to agree on its size.
    if ((is_friction && !added->is("stribeck-friction")) ||
        (added != longer.end() && (added->kind->effect->differs || added->is("offset"))))
        found.block_t = std::max(found.block_t, criterion.size_t_value(longer, *added));
    const double least_beyond = !corrects_form                   ? least_spread
                                : added->is("stribeck-friction") ? stribeck_spread * samples
                                                                 : form_spread * samples;
    // What is no friction, which acts at reversals, must be a share of the whole gap as well.
    const double whole_share = found.reduction / std::max(criterion.fit({}).squares - samples, least_squares);
    const bool is_spread = found.gap_share > dominant_gap_share && sum(by_block) > least_beyond &&
                           (is_friction || whole_share > least_gap_share);
    const bool changes_form = added != longer.end() && added->changes_ripple();
    const bool is_silent =
        added != longer.end() && is_below_resolution(*added, criterion.recorded().step_s());
    // Each condition is refused by a value that is no number, too.
    if (!(found.reduction > least_reduction))
        found.reason = "it reduces the residual no more than chance";
    else if (!(found.block_t > least_block_t) && !is_spread)
        found.reason = "few stretches of the log carry it";
    else if (!(held_out_sum > 0.0))
        found.reason = "it does not predict stretches that were left out";
    else if (!is_silent && !(found.noise_share > least_noise_share))
        found.reason = "its torque is far below the noise";
    else if (!is_silent &&
             (!(found.gap_share > least_gap_share) || (changes_form && whole_share < least_whole_share)))
        found.reason = "it explains a small part of what is unexplained";
    else if (!is_silent && added != longer.end() &&
             (is_at_bound(*added, criterion.recorded()) || is_at_end(*added, criterion.recorded())))
        found.reason = "its best value is a bound";
    found.is_admissible = found.reason.empty();
    return found;
}

// Orders and tones at lines of the residual, and ratios that put the model's ripple on lines.
void Search::add_lines(Criterion& criterion, const SearchedTerms& terms,
                       std::vector<SearchedTerm>& found) const {
    const std::vector<double> residual = criterion.residual_nm(terms);
    const double turns_per_s = recorded_.fastest_deg_s() / 360.0;
    const double highest = 0.45 / recorded_.step_s() / turns_per_s;
    const double ratio = motor_angle(terms, base_.ratio).ratio.value();
    if (ratio > 0.0) {
        const AngleSpectrum lines =
            angle_spectrum(recorded_, residual, 0.4 * ratio, std::min(13.0 * ratio, highest));
        const double usual = lines.power.empty() ? 0.0 : median_of(lines.power);
        for (int half = 1; half < 26 && !lines.power.empty(); ++half) {
            const double order = 0.5 * half;
            const bool is_there = std::ranges::find(base_.orders, order) != base_.orders.end() ||
                                  std::ranges::any_of(terms, [&](const SearchedTerm& t) {
                                      return t.is("ripple") && t.values[0] == order;
                                  });
            if (is_there || order * ratio > lines.cycles_per_turn.back()) continue;
            double power = 0.0;
            for (std::size_t k = 0; k < lines.power.size(); ++k)
                if (std::abs(lines.cycles_per_turn[k] - order * ratio) < 0.6 / lines.turns)
                    power = std::max(power, lines.power[k]);
            if (power > 6.0 * usual) found.push_back({&term_kind("ripple"), {order, 0.0}});
        }
    }
    if (ratio <= 0.0) {
        const AngleSpectrum lines = angle_spectrum(recorded_, residual, 3.0, std::min(highest, 1000.0));
        if (!lines.power.empty()) {
            const auto top = std::max_element(lines.power.begin(), lines.power.end()) - lines.power.begin();
            if (lines.power[static_cast<std::size_t>(top)] > 30.0 * median_of(lines.power))
                found.push_back({&term_kind("output-ripple"),
                                 {rounded(lines.cycles_per_turn[static_cast<std::size_t>(top)], 6), 0.0}});
        }
    }
    if (!contains(terms, "tone"))
        if (const auto tone_hz = find_tone(recorded_, residual))
            found.push_back({&term_kind("tone"), {*tone_hz, 0.0}});
    if (base_.orders.empty() || contains(terms, "gear-ratio") ||
        std::ranges::any_of(terms, [](const SearchedTerm& term) { return term.changes_ripple(); }))
        return;
    const std::vector<double> with_ripple = criterion.residual_nm(terms, Criterion::Ripple::left);
    const double known = base_.ratio.value();
    const double largest_order = *std::max_element(base_.orders.begin(), base_.orders.end());
    const AngleSpectrum lines = angle_spectrum(recorded_, with_ripple, 0.4 * known,
                                               std::min(1.6 * largest_order * known, highest), 0.12);
    if (lines.power.empty()) return;
    const double usual = median_of(lines.power),
                 spacing = lines.cycles_per_turn[1] - lines.cycles_per_turn[0];
    const auto power_at = [&](double cycles) {
        const double place = (cycles - lines.cycles_per_turn.front()) / spacing;
        if (place < 0.0 || place > static_cast<double>(lines.power.size() - 1)) return 0.0;
        const auto below = std::min(static_cast<std::size_t>(place), lines.power.size() - 2);
        const double share = place - static_cast<double>(below);
        return (lines.power[below] + share * (lines.power[below + 1] - lines.power[below])) / usual;
    };
    const double step = 0.1 / (lines.turns * largest_order * known);
    std::vector<double> factors, powers;
    for (std::size_t k = 0; 0.7 + step * static_cast<double>(k) < 1.4; ++k) {
        factors.push_back(0.7 + step * static_cast<double>(k));
        powers.push_back(0.0);
        for (const double order : base_.orders) powers.back() += power_at(order * known * factors.back());
    }
    for (int peak = 0; peak < 2; ++peak) {
        const auto top =
            static_cast<std::size_t>(std::max_element(powers.begin(), powers.end()) - powers.begin());
        if (std::abs(factors[top] - 1.0) * known * lines.turns > 0.05)
            found.push_back({&term_kind("gear-ratio"), {known * factors[top], 0.0}});
        for (std::size_t k = 0; k < powers.size(); ++k)
            if (std::abs(factors[k] - factors[top]) * known * lines.turns < 1.5) powers[k] = 0.0;
    }
}

bool Search::is_left_out(const TermKind& kind) const {
    return std::ranges::find(without_, kind.effect->name) != without_.end();
}

bool Search::may_be_missing(const TermKind& kind, const SearchedTerms& terms) const {
    const std::string_view name = kind.effect->name;
    if (base_.has(name) || (contains(terms, name) && !kind.may_occur_twice)) return false;
    const bool needs_ripple = kind.role == Role::ripple_change || kind.role == Role::motor_angle;
    if (needs_ripple && (base_.orders.empty() || base_.ratio.value() <= 0.0)) return false;
    if (kind.role == Role::sensor) return !has_sensor(terms);
    if (kind.effect->other_joint && recorded_.motion().others_deg_s.empty()) return false;
    if (name == "simulation-scale") return !base_.known_nm.empty() && base_.is_scale_known;
    // Once it is removed from the motion it is not searched again.
    if (name == "velocity-bias")
        return recorded_.is_position_integrated() && recorded_.removed_bias_deg_s() == 0.0;
    return true;
}

// A friction that turns over with the only reversal is no change of the load.
bool Search::moves_both_ways_about(double time_s) const {
    std::array<double, 4> samples{};
    const Motion& motion = recorded_.motion();
    for (std::size_t k = 0; k < motion.size(); ++k) {
        if (recorded_.usable()[k] == 0) continue;
        const int side = motion.time_s[k] < time_s ? 0 : 2;
        samples[static_cast<std::size_t>(side + (motion.velocity_deg_s[k] > 0.0 ? 1 : 0))] += 1.0;
    }
    const double before = samples[1] / std::max(samples[0] + samples[1], 1.0);
    const double after = samples[3] / std::max(samples[2] + samples[3], 1.0);
    return std::abs(after - before) < most_turned;
}

// Values that the search of a kind begins with.
std::vector<SearchedTerm> Search::begins(const TermKind& kind, const SearchedTerms& terms) const {
    const std::string_view name = kind.effect->name;
    std::vector<SearchedTerm> found;
    if (kind.searched.empty()) {
        found.push_back({&kind, {}});
    } else if (name == "payload-change") {
        const double duration_s = recorded_.motion().time_s.back();
        for (int part = 0; part <= payload_parts; ++part) {
            const double time_s = rounded(duration_s * (0.05 + 0.9 * part / payload_parts), 5);
            if (moves_both_ways_about(time_s)) found.push_back({&kind, {time_s, 0.0}});
        }
    } else if (kind.effect->other_joint) {
        const auto& others = recorded_.motion().others_deg_s;
        for (std::size_t joint = 0; joint < others.size(); ++joint) {
            if (std::ranges::all_of(others[joint], [](double v) { return v == 0.0; })) continue;
            for (const double ratio : kind.searched[1].grid)
                found.push_back(
                    {&kind, {static_cast<double>(joint + 1), ratio, kind.searched[2].grid.front()}});
        }
    } else if (name == "velocity-bias") {
        const double step = bias_step_deg_s(recorded_, base_);
        for (int steps = 1; steps <= most_bias_steps; ++steps)
            for (const double sign : {-1.0, 1.0})
                found.push_back({&kind, {rounded(sign * steps * step, 7), 0.0}});
    } else if (name == "encoder-eccentricity") {
        const double turn_deg = 1.0 / (*std::max_element(base_.orders.begin(), base_.orders.end()) *
                                       motor_angle(terms, base_.ratio).ratio.value());
        for (const double off_deg : {20.0, 60.0})  // of the fastest ripple
            for (int phase = 0; phase < 6; ++phase)
                found.push_back({&kind, {rounded(off_deg * turn_deg, 5), 60.0 * phase}});
    } else {
        // Narrower loops belong to a known Coulomb friction.
        const double least =
            name == "hysteresis" && (base_.has("coulomb-friction") || base_.states("coulomb-friction"))
                ? 0.3
                : -1e9;
        const double scale = width_scale(kind, kind.searched[0], recorded_);
        for (const double first : kind.searched[0].grid) {
            if (first < least) continue;
            if (kind.searched.size() == 1) found.push_back({&kind, {first * scale, 0.0}});
            if (kind.searched.size() == 2)
                for (const double second : kind.searched[1].grid)
                    found.push_back(
                        {&kind, {first * scale, second * width_scale(kind, kind.searched[1], recorded_)}});
        }
    }
    return found;
}

std::optional<SearchedTerm> Search::velocity_bias(Criterion& criterion) const {
    const TermKind& kind = term_kind("velocity-bias");
    if (!may_be_missing(kind, {}) || is_left_out(kind)) return std::nullopt;
    std::optional<SearchedTerms> best;
    for (const SearchedTerm& term : begins(kind, {}))
        if (!best || criterion.fit({term}).squares < criterion.fit(*best).squares) best = {term};
    best = refined(criterion, *best, 0);
    if (!admission(criterion, {}, *best).is_admissible) return std::nullopt;
    return best->front();
}

std::vector<SearchedTerm> Search::starts(Criterion& criterion, const SearchedTerms& terms) const {
    std::vector<SearchedTerm> found;
    for (const TermKind& kind : term_kinds()) {
        if (!may_be_missing(kind, terms)) continue;
        for (const SearchedTerm& term : begins(kind, terms))
            if (std::ranges::find(terms, term) == terms.end()) found.push_back(term);
    }
    add_lines(criterion, terms, found);
    std::erase_if(found, [&](const SearchedTerm& term) { return is_left_out(*term.kind); });
    return found;
}

// Starts in order of what each reduces, the best of each kind.
std::vector<Search::Candidate> Search::ranked(Criterion& criterion, const SearchedTerms& terms) const {
    const double before = criterion.fit(terms).squares;
    std::vector<Candidate> scored;
    for (const SearchedTerm& term : starts(criterion, terms))
        scored.push_back({term, before - criterion.fit(with(terms, term)).squares});
    std::ranges::stable_sort(
        scored, [](const Candidate& a, const Candidate& b) { return a.reduction > b.reduction; });
    std::vector<Candidate> best;
    for (const Candidate& one : scored) {
        const bool is_seen = std::ranges::any_of(best, [&](const Candidate& other) {
            const SearchedTerm &a = one.term, &b = other.term;
            if (a.kind != b.kind) return false;
            if (a.is("delay")) return (a.values[0] > 0.0) == (b.values[0] > 0.0);
            // Lines at different frequencies are different candidates.
            const bool is_line = a.kind->effect->ripple_order || a.is("output-ripple") ||
                                 a.is("ripple-modulation") || a.is("gear-ratio");
            return !is_line || a.values[0] == b.values[0];
        });
        if (!is_seen) best.push_back(one);
    }
    return best;
}

std::vector<SearchedTerms> Search::extensions(Criterion& criterion, const SearchedTerms& terms,
                                              std::size_t finalists) const {
    std::vector<Candidate> candidates = ranked(criterion, terms);
    candidates.resize(std::min(candidates.size(), finalists));
    const bool may_delay =
        !has_sensor(terms) && !is_left_out(term_kind("delay")) &&
        std::ranges::none_of(candidates, [](const Candidate& c) { return c.term.is("delay"); });
    if (may_delay) candidates.push_back({{&term_kind("delay"), {smallest_delay_s, 0.0}}, 0.0});
    std::vector<SearchedTerms> found;
    for (const Candidate& candidate : candidates)
        found.push_back(
            plainer(criterion, terms, refined(criterion, with(terms, candidate.term), terms.size())));
    std::ranges::stable_sort(found, [&](const SearchedTerms& a, const SearchedTerms& b) {
        return criterion.cost(a) < criterion.cost(b);
    });
    for (std::size_t i = 1; i < found.size(); ++i) {
        if (!is_preferred(criterion, terms, {found[i], found[i].back()}, {found[0], found[0].back()}))
            continue;
        const auto place = found.begin() + static_cast<std::ptrdiff_t>(i);
        std::rotate(found.begin(), place, place + 1);
        break;
    }
    return found;
}

// Squares of the torque that a set of terms leaves, with what was logged at standstill.
double Search::squares_with_rests(const Criterion& criterion, const SearchedTerms& terms) const {
    const Motion& motion = recorded_.motion();
    const MotorAngle angle = motor_angle(terms, base_.ratio);
    std::vector<std::vector<double>> columns = ripple_columns(motion, base_.orders, angle.ratio);
    for (const BaseColumn& column : base_.columns) columns.push_back(column.torque_nm);
    for (const SearchedTerm& term : terms) {
        if (term.kind->role != Role::joint_torque && term.kind->role != Role::sensor_torque) continue;
        for (auto& column : unit_columns(*term.kind->effect, unit_values(term),
                                         {motion, angle.ratio, criterion.noise().load_nm}))
            columns.push_back(std::move(column));
    }
    std::vector<double> residual = recorded_.torque_nm();
    if (!base_.known_nm.empty()) residual = difference(residual, base_.known_nm);
    const std::vector<double> factors = regress(columns, residual, recorded_.recorded());
    double squares = 0.0;
    for (std::size_t k = 0; k < residual.size(); ++k) {
        for (std::size_t c = 0; c < columns.size(); ++c) residual[k] -= factors[c] * columns[c][k];
        if (recorded_.recorded()[k] != 0) squares += residual[k] * residual[k];
    }
    return squares;
}

// At standstill an offset stays and a difference of friction is gone: there what was logged decides.
bool Search::is_preferred(Criterion& criterion, const SearchedTerms& fewer, const Choice& one,
                          const Choice& other) const {
    const double before = criterion.cost(fewer);
    const auto reaches = [&](double share) {
        return before - criterion.cost(one.terms) > share * (before - criterion.cost(other.terms));
    };
    const auto differs = [](const SearchedTerm& term) {
        return term.is("asymmetric-friction") || term.is("asymmetric-viscous-friction");
    };
    if ((differs(one.newest) && other.newest.is("offset")) ||
        (one.newest.is("offset") && differs(other.newest)))
        return reaches(plain_friction_share) &&
               squares_with_rests(criterion, one.terms) < squares_with_rests(criterion, other.terms);
    const Plainer* pair = plainer_than(one.newest, other.newest);
    return pair && reaches(pair->share);
}

SearchState Search::with_new_noise(const SearchState& state) const {
    auto noise = std::make_shared<const SaturatedFit>(
        fit_saturated(recorded_, base_, state.terms, &state.criterion->noise()));
    return {state.terms, std::make_shared<Criterion>(recorded_, base_, std::move(noise))};
}

// Friction of this joint alone can be taken for one that it shares at another ratio than the plain one: both
// are tried at once.
std::optional<SearchedTerms> Search::with_own_friction(Criterion& criterion, const SearchedTerms& terms,
                                                       std::size_t shared) const {
    const TermKind& own = term_kind("coulomb-friction");
    if (!has_choice(terms[shared]) || has_plain_size(terms[shared]) || !may_be_missing(own, terms) ||
        is_left_out(own))
        return std::nullopt;
    const auto best = [&](const SearchedTerms& fewer, const TermKind& kind) {
        std::optional<SearchedTerms> found;
        for (const SearchedTerm& begin : begins(kind, fewer)) {
            const SearchedTerms longer = with(fewer, begin);
            if (!found || criterion.fit(longer).squares < criterion.fit(*found).squares) found = longer;
        }
        return plainer(criterion, fewer, refined(criterion, *found, fewer.size()));
    };
    const SearchedTerms fewer = without_place(terms, shared);
    SearchedTerms both = best(best(fewer, own), *terms[shared].kind);
    const SearchedTerms alone = without_place(both, fewer.size());
    if (criterion.cost(both) >= criterion.cost(terms) - least_reduction ||
        !admission(criterion, alone, both).is_admissible)
        return std::nullopt;
    return both;
}

// What is needless goes, what is better comes in its place.
void Search::exchange(SearchState& state, std::vector<SearchedTerms>& seen) const {
    Criterion& criterion = *state.criterion;
    for (int pass = 0; pass < most_exchanges; ++pass) {
        SearchedTerms& terms = state.terms;
        SearchedTerms sorted = terms;
        std::sort(sorted.begin(), sorted.end());
        if (std::ranges::find(seen, sorted) != seen.end()) return;
        seen.push_back(sorted);
        std::optional<SearchedTerms> best;
        const auto offer = [&](const SearchedTerms& other) {
            if (!best || criterion.cost(other) < criterion.cost(*best)) best = other;
        };
        // The newest as well: its noise may have been measured anew.
        for (std::size_t i = 0; i < terms.size(); ++i) {
            const SearchedTerms fewer = without_place(terms, i);
            if (!admission(criterion, fewer, terms).is_admissible) offer(fewer);
        }
        const bool is_all_needed = !best;
        for (std::size_t i = 0; i < terms.size() && is_all_needed; ++i)
            if (const auto both = with_own_friction(criterion, terms, i)) offer(*both);
        for (std::size_t i = 0; i < terms.size() && is_all_needed; ++i) {
            const SearchedTerms fewer = without_place(terms, i);
            auto rivals = extensions(criterion, fewer, exchange_finalists);
            rivals.resize(std::min(rivals.size(), tried_of_finalists));
            for (const SearchedTerms& rival : rivals) {
                // A shape that was found while another term was missing may lie in the wrong valley.
                const bool is_same = rival.back().kind == terms[i].kind;
                if (criterion.cost(rival) >=
                        criterion.cost(terms) - (is_same ? one_error : least_reduction) ||
                    !admission(criterion, fewer, rival).is_admissible)
                    continue;
                if (is_same) {
                    SearchedTerms moved = terms;
                    moved[i] = rival.back();
                    offer(moved);
                } else if (!is_preferred(criterion, fewer, {terms, terms[i]}, {rival, rival.back()})) {
                    offer(rival);
                }
            }
        }
        if (!best) return;
        terms = *best;
    }
}

SearchState Search::path(SearchState state, std::vector<RefusedTerm>& refused) const {
    std::vector<SearchedTerms> seen;
    if (!state.terms.empty() && changes_noise(state.terms.back())) state = with_new_noise(state);
    for (int round = 0; round < most_rounds; ++round) {
        auto longer = extensions(*state.criterion, state.terms, finalist_count);
        longer.resize(std::min(longer.size(), tried_of_finalists));
        refused.clear();
        bool has_grown = false;
        for (const SearchedTerms& one : longer) {
            Admission admitted = admission(*state.criterion, state.terms, one);
            if (admitted.is_admissible) {
                state.terms = one;
                has_grown = true;
                break;
            }
            refused.push_back({one.back(), std::move(admitted)});
        }
        if (!has_grown) break;
        if (changes_noise(state.terms.back())) state = with_new_noise(state);
        state.terms = polished(*state.criterion, state.terms);
        exchange(state, seen);
    }
    return state;
}

SearchResult Search::run() {
    const auto first = std::make_shared<Criterion>(recorded_, base_, noise_);
    SearchResult result;
    result.best = path({{}, first}, result.refused);
    const auto left = [](const SearchState& state) {
        return state.criterion->fit(state.terms).squares / state.criterion->samples();
    };
    if (left(result.best) < much_left) return result;
    // Where much is left, paths that begin with the next best terms compete with it.
    const SearchedTerms winner = result.best.terms;
    std::size_t tried = 0;
    std::vector<SearchState> rivals;
    std::vector<std::vector<RefusedTerm>> rival_refused;
    for (const SearchedTerms& begin : extensions(*first, {}, finalist_count)) {
        if (tried == rival_paths) break;
        if (contains(winner, begin.back().kind->effect->name) || !admission(*first, {}, begin).is_admissible)
            continue;
        ++tried;
        rivals.push_back(path({begin, first}, rival_refused.emplace_back()));
    }
    for (std::size_t i = 0; i < rivals.size(); ++i) {
        Criterion& criterion = *result.best.criterion;
        if (criterion.cost(rivals[i].terms) >= criterion.cost(result.best.terms) - least_reduction) continue;
        result.best = rivals[i];
        result.refused = rival_refused[i];
    }
    return result;
}

namespace {

// Halvings, roughly, of a step of the coordinate search.
constexpr double shrink = 0.55;
constexpr double straight_drift_s = 1e3;  // from here on a drift is a line, whatever its time constant

// Steps of both signs about the best value so far, each series shorter than the last.
struct StepSearch {
    Criterion& criterion;
    SearchedTerms& terms;
    std::size_t place, value;
    double best;

    template <class Moved>
    void run(int passes, double step, double shrunk, Moved moved) {
        for (int pass = 0; pass < passes; ++pass, step *= shrunk) {
            for (const double signed_step : {-step, step}) {
                SearchedTerms tried = terms;
                const auto next = moved(terms[place].values[value], signed_step);
                if (!next) continue;
                tried[place].values[value] = *next;
                const double squares = criterion.fit(tried).squares;
                if (squares >= best) continue;
                best = squares;
                terms = std::move(tried);
            }
        }
    }
};

}  // namespace

double bias_step_deg_s(const RecordedMotion& recorded, const Baseline& base) {
    const double cycles_per_deg =
        *std::max_element(base.orders.begin(), base.orders.end()) * base.ratio.value() / 360.0;
    return 0.25 / (cycles_per_deg * recorded.motion().time_s.back());
}

SearchedTerms refined(Criterion& criterion, SearchedTerms terms, std::size_t place) {
    const TermKind& kind = *terms[place].kind;
    if (!kind.is_refined) return terms;
    StepSearch search{criterion, terms, place, 0, criterion.fit(terms).squares};
    if (kind.effect->name == "gear-ratio") {
        const std::vector<double>& orders = criterion.base().orders;
        const double turns = std::max(criterion.recorded().travel_deg() / 360.0, 0.05);
        const double step = 0.2 / (*std::max_element(orders.begin(), orders.end()) * turns);
        search.run(7, step, 0.5,
                   [](double ratio, double by) { return std::optional(rounded(ratio + by, 7)); });
        return terms;
    }
    const bool is_delay = kind.effect->name == "delay";
    if (kind.effect->name == "velocity-bias") {
        const double step = bias_step_deg_s(criterion.recorded(), criterion.base());
        search.run(7, 0.5 * step, shrink,
                   [](double bias, double by) { return std::optional(rounded(bias + by, 7)); });
        return terms;
    }
    const int sweeps = kind.searched.size() > 1 ? 2 : 1;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (std::size_t value = 0; value < kind.searched.size(); ++value) {
            SearchedValue bounds = kind.searched[value];
            if (bounds.is_choice) continue;
            bounds.upper *= width_scale(kind, bounds, criterion.recorded());
            search.value = value;
            if (is_delay) {
                search.run(7, 0.002, shrink, [&](double delay_s, double by) -> std::optional<double> {
                    const double next = std::nearbyint((delay_s + by) * 1e6) * 1e-6;
                    if (next < bounds.lower || next > bounds.upper) return std::nullopt;
                    return next;
                });
                continue;
            }
            if (kind.effect->name == "drift" && terms[place].values[0] > straight_drift_s) continue;
            if (bounds.step > 0.0) {
                search.run(6, bounds.step, shrink, [&](double from, double by) {
                    return std::optional(rounded(std::clamp(from + by, bounds.lower, bounds.upper), 6));
                });
                continue;
            }
            search.run(5, 0.35, shrink, [&](double from, double by) {
                const double size =
                    std::clamp(std::abs(from) * portable::exp(by), bounds.lower, bounds.upper);
                return std::optional(rounded(std::copysign(size, from), 5));
            });
        }
    }
    return terms;
}

}  // namespace ripplenotch::engine
