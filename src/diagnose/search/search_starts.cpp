// SPDX-License-Identifier: MIT
#include "diagnose/search/search_starts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/matrices/factorisations.hpp"
#include "diagnose/case/lines.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

namespace {

double in_two_digits(double value) {
    double unit = 1.0;
    while (value >= 100.0 * unit) unit *= 10.0;
    while (value < 10.0 * unit) unit *= 0.1;
    return std::round(value / unit) * unit;
}

// The values with which a term is evaluated, stated from another speed, and the resulting ripple.
struct Restated {
    std::vector<double> values;
    double ripple = 1.0;
};

Restated restated(const Term& term, double from_deg_s) {
    Restated made{values_of(term)};
    made.ripple = term.effect->restate(from_deg_s, made.values);
    return made;
}

bool is_allowed(const Effect& effect, const Restated& made) {
    if (!std::isfinite(made.ripple) || made.ripple == 0.0) return false;
    for (std::size_t p = 0; p < made.values.size(); ++p) {
        if (!allows(effect.parameters[p], made.values[p])) return false;
    }
    return true;
}

// Places of the ripple terms that it changes; empty where the size or the phase of one is not fitted.
std::vector<std::size_t> ripple_of(const Candidate& model, std::size_t changing) {
    const Term& change = model.stated.terms[changing];
    const auto order = find_parameter(*change.effect, "order");
    std::vector<std::size_t> places;
    for (std::size_t t = 0; t < model.open.terms.size(); ++t) {
        const Effect& effect = *model.open.terms[t].effect;
        if (!effect.ripple_order) continue;
        const double only = order ? change.values[*order].value_or(0.0) : 0.0;
        if (only != 0.0 && only != model.stated.terms[t].values[*effect.ripple_order]) continue;
        const auto& open = model.open.terms[t].values;
        if (!effect.polar || open[effect.polar->size] || open[effect.polar->phase]) return {};
        places.push_back(t);
    }
    return places;
}

void multiply(Term& ripple, double by) {
    auto& size = *ripple.values[ripple.effect->polar->size];
    auto& phase_deg = *ripple.values[ripple.effect->polar->phase];
    size *= std::abs(by);
    if (by < 0.0) phase_deg += phase_deg > 0.0 ? -180.0 : 180.0;
}

}  // namespace

double usual_speed_deg_s(const Case& looked_at) {
    double squares = 0.0, samples = 0.0;
    for (std::size_t k = 0; k < looked_at.size(); ++k) {
        const double v = looked_at.motion.velocity_deg_s[k];
        if (looked_at.use[k] == 0 || std::abs(v) < looked_at.moving_deg_s) continue;
        squares += v * v;
        samples += 1.0;
    }
    return squares > 0.0 ? in_two_digits(std::sqrt(squares / samples)) : 0.0;
}

void state_where_told(Candidate& model, const Case& looked_at) {
    for (std::size_t t = 0; t < model.stated.terms.size() && t < model.prices.size(); ++t) {
        Term &stated = model.stated.terms[t], &open = model.open.terms[t];
        const Effect& effect = *stated.effect;
        if (!effect.restate || !(model.prices[t] > 0.0)) continue;
        const double usual_deg_s = usual_speed_deg_s(looked_at);
        const std::vector<std::size_t> ripple = ripple_of(model, t);
        if (!(usual_deg_s > 0.0) || ripple.empty()) continue;
        // Amplitude at standstill and at the usual speed, relative to that of the term.
        const double rest = restated(stated, 0.0).ripple, usual = restated(stated, usual_deg_s).ripple;
        const double from_deg_s =
            std::abs(rest) < limits::search::least_at_rest * std::abs(usual) ? usual_deg_s : 0.0;
        if (stated.values[*effect.stated_from].value_or(0.0) == from_deg_s) continue;
        const Restated made = restated(stated, from_deg_s);
        if (!is_allowed(effect, made)) continue;
        for (std::size_t p = 0; p < made.values.size(); ++p) {
            if (stated.values[p]) stated.values[p] = made.values[p];
        }
        stated.values[*effect.stated_from] = open.values[*effect.stated_from] = from_deg_s;
        for (const std::size_t place : ripple) multiply(model.stated.terms[place], made.ripple);
    }
}

namespace {

class Shapes {
  public:
    Shapes(const ModelBench& bench, const Model& stated, std::size_t term)
        : bench_(bench), term_(stated.terms[term]), rest_(without(stated, term), bench.looked_at().motion) {
        own_ = torque_at(term_);
    }

    // Whether the torque at the bound is as good.
    [[nodiscard]] bool is_as_good_at(std::size_t parameter, double bound) const {
        const std::vector<double> there = torque_at(moved(parameter, bound));
        const double as_good = limits::shape::as_good;
        if (!(difference(own_, there) < as_good)) return false;
        // A bound that is as good as neutral is no particular shape.
        const double neutral = term_.effect->parameters[parameter].neutral;
        return !(difference(torque_at(moved(parameter, neutral)), there) < as_good);
    }

  private:
    static Model without(Model stated, std::size_t term) {
        stated.terms.erase(stated.terms.begin() + static_cast<std::ptrdiff_t>(term));
        return stated;
    }

    [[nodiscard]] Term moved(std::size_t parameter, double value) const {
        Term term = term_;
        term.values[parameter] = value;
        return term;
    }

    [[nodiscard]] std::vector<double> torque_at(const Term& term) const {
        const auto added = rest_.added(term);
        std::vector<double> torque_nm;
        for (const std::size_t k : bench_.rows()) torque_nm.push_back(added[k]);
        return torque_nm;
    }

    // Share of a torque that remains after subtraction of the best multiple of the other; 1 where that has
    // the other sign.
    [[nodiscard]] static double difference(const std::vector<double>& torque,
                                           const std::vector<double>& other) {
        double square = 0.0, both = 0.0, others = 0.0;
        for (std::size_t r = 0; r < torque.size(); ++r) {
            square += torque[r] * torque[r];
            both += torque[r] * other[r];
            others += other[r] * other[r];
        }
        if (!(both > 0.0)) return 1.0;
        return std::sqrt(std::max(square - both * both / others, 0.0) / square);
    }

    const ModelBench& bench_;
    Term term_;
    Prediction rest_;
    std::vector<double> own_;
};

bool is_shape(const Effect& effect, std::size_t p) {
    const Parameter& parameter = effect.parameters[p];
    // Angles come round, and signed numbers are sizes.
    return !parameter.linear && parameter.left_out == LeftOut::fitted && parameter.lower != -parameter.upper;
}

bool is_neutral(const Parameter& parameter, double value) {
    // A logarithm and back is off by rounding.
    return std::abs(value - parameter.neutral) <= 1e-6 * std::max(1.0, std::abs(parameter.neutral));
}

// Loss when the value is held within its bound; large, where the log requires a value beyond.
double lost_within(const ModelBench& bench, const Candidate& model, const FittedValue& value) {
    const Parameter& parameter = model.stated.terms[value.term].effect->parameters[value.parameter];
    const bool at_lower = value.value - parameter.lower < parameter.upper - value.value;
    const double inward = limits::shape::inward_part * (parameter.upper - parameter.lower);
    const double factor = limits::shape::inward_factor;
    double within = value.value + (at_lower ? inward : -inward);
    if (parameter.lower > 0.0) within = at_lower ? value.value * factor : value.value / factor;
    Model held = model.open, guess = model.stated;
    held.terms[value.term].values[value.parameter] = guess.terms[value.term].values[value.parameter] = within;
    return bench.fitted(held, guess, model.prices).gain_left - model.gain_left;
}

}  // namespace

std::string_view bent_parameter(const ModelBench& bench, const Candidate& model, std::size_t term) {
    const Effect& effect = *model.stated.terms[term].effect;
    const Term& stated = model.stated.terms[term];
    if (const auto damping = find_parameter(effect, "damping"); damping && side_of(stated) != effect.side) {
        if (*stated.values[*damping] >= limits::shape::most_damping) return effect.parameters[*damping].name;
    }
    const Shapes shapes(bench, model.stated, term);
    for (const FittedValue& value : model.values) {
        const Parameter& parameter = effect.parameters[value.parameter];
        if (value.term != term || !is_shape(effect, value.parameter)) continue;
        if (effect.polar && effect.polar->phase == value.parameter) continue;
        if (value.at_bound && !is_neutral(parameter, value.value)) {
            if (lost_within(bench, model, value) > tie_margin) return parameter.name;
        }
        for (const double bound : {parameter.lower, parameter.upper}) {
            if (is_neutral(parameter, bound)) continue;
            if (shapes.is_as_good_at(value.parameter, bound)) return parameter.name;
        }
    }
    return {};
}

namespace {

// Inertia and gravity, and an offset in addition.
constexpr Eigen::Index changing_columns = 3, all_columns = 4;
using ProductSums = Eigen::Matrix<double, all_columns + 1, all_columns + 1>;

// Sums of products of the columns and the residual up to each sample, the first none.
class RunningSums {
  public:
    RunningSums(const Case& looked_at, const std::vector<double>& residual_nm, std::size_t most_samples) {
        const Motion& motion = looked_at.motion;
        std::vector<std::size_t> rows;
        for (std::size_t k = 0; k < looked_at.size(); ++k) {
            if (looked_at.use[k] != 0) rows.push_back(k);
        }
        const std::size_t stride = rows.size() / most_samples + 1;
        std::size_t kept = 0;
        for (std::size_t r = 0; r < rows.size(); r += stride) rows[kept++] = rows[r];
        rows.resize(kept);
        double square = 0.0;
        for (const std::size_t k : rows)
            square += motion.acceleration_deg_s2[k] * motion.acceleration_deg_s2[k];
        const double usual = std::sqrt(square / std::max(static_cast<double>(kept), 1.0));
        const double scale = usual > 0.0 ? 1.0 / usual : 0.0;
        ProductSums sum = ProductSums::Zero();
        std::vector<double> angle_deg, cosine(kept), sine(kept);
        for (const std::size_t k : rows) angle_deg.push_back(motion.position_deg[k]);
        portable::cos_degrees(angle_deg, cosine);
        portable::sin_degrees(angle_deg, sine);
        for (std::size_t r = 0; r < kept; ++r) {
            times_s_.push_back(motion.time_s[rows[r]] - motion.time_s.front());
            before_.push_back(sum);
            Eigen::Matrix<double, all_columns + 1, 1> row;
            row << scale * motion.acceleration_deg_s2[rows[r]], cosine[r], sine[r], 1.0, residual_nm[rows[r]];
            sum += row * row.transpose();
        }
        all_ = sum;
        if (kept > 0) factors_.compute(damped(all_.topLeftCorner<all_columns, all_columns>()));
    }

    [[nodiscard]] std::size_t size() const { return times_s_.size(); }
    [[nodiscard]] double time_s(std::size_t place) const { return times_s_[place]; }

    /// Sum of squares above the noise, less the part explained by a constant inertia, gravity and offset.
    [[nodiscard]] double gap(double noise_nm) const {
        const Eigen::VectorXd along = all_.topRightCorner<all_columns, 1>();
        return all_(all_columns, all_columns) - along.dot(factors_.solve(along)) -
               noise_nm * noise_nm * static_cast<double>(times_s_.size());
    }

    /// Fall of the sum of squares by a change at this place.
    [[nodiscard]] double gain(std::size_t place) const {
        const ProductSums after = all_ - before_[place];
        const Eigen::MatrixXd common = after.topLeftCorner<all_columns, changing_columns>();
        const Eigen::MatrixXd projected = factors_.solve(common);
        const Eigen::MatrixXd outside =
            after.topLeftCorner<changing_columns, changing_columns>() - common.transpose() * projected;
        const Eigen::VectorXd along = after.topRightCorner<changing_columns, 1>() -
                                      projected.transpose() * all_.topRightCorner<all_columns, 1>();
        return along.dot(SymmetricFactors(damped(outside)).solve(along));
    }

  private:
    // Columns that are as good as combinations of others explain nothing.
    [[nodiscard]] Eigen::MatrixXd damped(Eigen::MatrixXd matrix) const {
        constexpr double part = 1e-6;
        for (Eigen::Index c = 0; c < matrix.rows(); ++c)
            matrix(c, c) += part * (all_(c, c) + static_cast<double>(times_s_.size()));
        return matrix;
    }

    std::vector<double> times_s_;
    std::vector<ProductSums> before_;
    ProductSums all_ = ProductSums::Zero();
    SymmetricFactors factors_;
};

}  // namespace

ChangeTimes change_times(const Case& looked_at, const std::vector<double>& residual_nm, double noise_nm) {
    const std::size_t compared_times = limits::screening::compared_times;
    const RunningSums sums(looked_at, residual_nm, limits::screening::change_samples);
    const std::size_t spacing = sums.size() / (compared_times + 1);
    if (spacing == 0) return {};
    const auto apart_from_ends =
        static_cast<std::size_t>(limits::screening::change_within * static_cast<double>(sums.size()));
    std::vector<double> gains(compared_times, 0.0);
    for (std::size_t i = 0; i < compared_times; ++i) {
        const std::size_t place = (i + 1) * spacing;
        if (place >= apart_from_ends && place + apart_from_ends <= sums.size()) gains[i] = sums.gain(place);
    }
    const double least = std::max(limits::screening::least_change * sums.gap(noise_nm), 0.0);
    ChangeTimes found{{}, static_cast<double>(compared_times)};
    const std::size_t apart = compared_times / 16;
    while (found.times_s.size() < limits::screening::most_change_times) {
        const auto best = static_cast<std::size_t>(std::ranges::max_element(gains) - gains.begin());
        if (!(gains[best] > least)) break;
        std::size_t place = best * spacing;
        const std::size_t end = std::min((best + 2) * spacing, sums.size());
        double most = 0.0;
        const std::size_t step = std::max<std::size_t>(spacing / 16, 1);
        for (std::size_t near = place; near < end; near += step) {
            if (const double gain = sums.gain(near); gain > most) {
                most = gain;
                place = near;
            }
        }
        found.times_s.push_back(sums.time_s(place));
        const std::size_t first = best > apart ? best - apart : 0,
                          last = std::min(best + apart, compared_times);
        std::fill(gains.begin() + static_cast<std::ptrdiff_t>(first),
                  gains.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
    }
    return found;
}

namespace {

const Effect* among(std::span<const Effect* const> effects, std::string_view name) {
    const auto found =
        std::ranges::find_if(effects, [&](const Effect* effect) { return effect->name == name; });
    return found == effects.end() ? nullptr : *found;
}

LateRatio best_late_ratio(const ModelBench& bench, const Effect& delay, const StatedRipple& ripple,
                          RatioRange range, const std::vector<double>& torque_nm) {
    const auto ratios_at = [&](double delay_s) {
        return LateRatio{delay_s, likely_ratios(seen_late(bench.looked_at(), Seconds(delay_s)), torque_nm,
                                                ripple.orders, range)};
    };
    LateRatio best = ratios_at(0.0);
    const double alone_nm2 = best.ratios.strongest_nm2;
    for (const double delay_s : delay.parameters[0].tried) {
        LateRatio late = ratios_at(delay_s);
        if (late.ratios.strongest_nm2 > best.ratios.strongest_nm2) best = std::move(late);
    }
    best.strongest_alone_nm2 = alone_nm2;
    return best;
}

// Delays of the model's terms, in all.
Seconds lateness_of(const Model& stated) {
    double late_s = 0.0;
    for (const Term& term : stated.terms) {
        if (term.effect->name == "delay") late_s += term.values[0].value_or(0.0);
    }
    return Seconds(late_s);
}

}  // namespace

Case seen_late(const Case& looked_at, Seconds late) {
    Case seen = looked_at;
    if (late.value() == 0.0 || seen.size() < 2) return seen;
    const auto& time_s = looked_at.motion.time_s;
    const auto& position_deg = looked_at.motion.position_deg;
    // Rows that were lost or left out make a step of several periods.
    const double longest_s = 1.5 / looked_at.motion.sample_rate.value();
    std::size_t before = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
        const double wanted_s = time_s[k] - late.value();
        while (before + 2 < seen.size() && time_s[before + 1] <= wanted_s) ++before;
        const double step_s = time_s[before + 1] - time_s[before], into_s = wanted_s - time_s[before];
        if (into_s < 0.0 || into_s > step_s || step_s > longest_s) {
            seen.use[k] = 0;
            continue;
        }
        seen.motion.position_deg[k] =
            position_deg[before] + (position_deg[before + 1] - position_deg[before]) * into_s / step_s;
    }
    return seen;
}

// The value of the parameter with which the effect makes `stated` the ratio `wanted`.
double value_for_ratio(const Effect& effect, std::size_t parameter, GearRatio stated, double wanted) {
    // The ratio is affine in the parameter.
    std::vector<double> values;
    for (const Parameter& other : effect.parameters) values.push_back(other.neutral);
    Motion scratch;
    GearRatio at_neutral = stated, at_next = stated;
    effect.change_motion(values, scratch, at_neutral);
    values[parameter] += 1.0;
    effect.change_motion(values, scratch, at_next);
    const double slope = at_next.value() - at_neutral.value();
    return effect.parameters[parameter].neutral + (wanted - at_neutral.value()) / slope;
}

std::optional<Candidate> with_late_ratio(const ModelBench& bench, const Candidate& now, std::size_t own_terms,
                                         std::span<const Effect* const> effects) {
    const Effect* const delay = among(effects, "delay");
    const Effect* const gear_ratio = among(effects, "gear-ratio");
    if (delay == nullptr || gear_ratio == nullptr) return std::nullopt;
    const auto is_one = [&](const Term& term) { return term.effect == delay || term.effect == gear_ratio; };
    Model open = now.open, guess = now.stated;
    std::vector<double> prices = now.prices;
    // One of the two that was found alone may have the wrong value, for want of the other.
    std::size_t there = 0;
    for (std::size_t term = guess.terms.size(); term-- > 0;) {
        if (!is_one(guess.terms[term])) continue;
        if (term < own_terms || ++there == 2) return std::nullopt;
        const auto at = static_cast<std::ptrdiff_t>(term);
        open.terms.erase(open.terms.begin() + at);
        guess.terms.erase(guess.terms.begin() + at);
        prices.erase(prices.begin() + at);
    }
    const StatedRipple ripple = stated_ripple(guess);
    Model without_ripple = guess;
    std::erase_if(without_ripple.terms,
                  [](const Term& term) { return term.effect->ripple_order.has_value(); });
    const std::vector<double> torque_nm = bench.raw_residual(without_ripple);
    const SeenModel seen{open, torque_nm, {}};
    KeptBeside<LateRatio>& kept = bench.kept()->late_ratios;
    const LateRatio* before = kept.find(seen, bench.looked_at().use, bench.same_model_nm2());
    const LateRatio& best =
        before != nullptr
            ? *before
            : kept.keep(seen, best_late_ratio(bench, *delay, ripple, ratios_beside(now, ripple.ratio.value()),
                                              torque_nm));
    if (best.ratios.ratios.empty() ||
        !(best.ratios.strongest_nm2 > limits::screening::late_ratio * best.strongest_alone_nm2))
        return std::nullopt;
    const double cells = best.ratios.compared * static_cast<double>(delay->parameters[0].tried.size());
    const double price =
        portable::log(bench.samples()) + portable::log(cells) +
        2.0 * portable::log(static_cast<double>(effects.size()) / limits::screening::false_alarm);
    const double error = value_for_ratio(*gear_ratio, 0, ripple.ratio, best.ratios.ratios.front());
    for (const auto& [effect, value] : {std::pair(delay, best.delay_s), std::pair(gear_ratio, error)}) {
        open.terms.push_back({effect, {std::nullopt}});
        guess.terms.push_back({effect, {value}});
        prices.push_back(price);
    }
    return bench.fitted(open, guess, std::move(prices), 12, limits::search::finalist_settled);
}

namespace {

std::vector<double> tried(const Effect& effect, std::size_t p, const Hints& hints, double samples,
                          double& cells) {
    const Parameter& parameter = effect.parameters[p];
    std::vector<double> values;
    if (parameter.tried.empty() && parameter.hint != Hint::tones) values.push_back(parameter.start);
    values.insert(values.end(), parameter.tried.begin(), parameter.tried.end());
    cells *= static_cast<double>(std::max<std::size_t>(values.size(), 1));
    if (parameter.hint == Hint::ripple_orders && hints.orders.size() > 1) {
        values.insert(values.end(), hints.orders.begin(), hints.orders.end());
        cells *= static_cast<double>(values.size());
    }
    if (parameter.hint == Hint::tones) {
        values = hints.tones_hz;
        cells *= samples / 2.0;
    }
    if (parameter.hint == Hint::delay && hints.delay_s) values.push_back(*hints.delay_s);
    if (parameter.hint == Hint::gear_ratios && !hints.ratios.ratios.empty()) {
        cells += hints.ratios.compared;
        for (const double ratio : hints.ratios.ratios)
            values.push_back(value_for_ratio(effect, p, hints.ratio, ratio));
    }
    if (parameter.hint == Hint::both_ways)
        std::erase_if(values, [&](double order) { return order < hints.least_order; });
    if (parameter.hint == Hint::change_times) {
        values = hints.changes.times_s;
        cells *= hints.changes.compared;
    }
    std::erase_if(values, [&](double value) { return !allows(parameter, value); });
    return values;
}

// Travel that is passed in both directions.
double both_ways_deg(const Case& looked_at) {
    constexpr double cell_deg = 5.0;  // chosen, not derived
    std::map<long, unsigned> passed;
    for (std::size_t k = 0; k < looked_at.size(); ++k) {
        const double v = looked_at.motion.velocity_deg_s[k];
        if (looked_at.use[k] == 0 || std::abs(v) < looked_at.moving_deg_s) continue;
        passed[std::lround(looked_at.motion.position_deg[k] / cell_deg)] |= v > 0.0 ? 1U : 2U;
    }
    return cell_deg * static_cast<double>(
                          std::ranges::count_if(passed, [](const auto& cell) { return cell.second == 3U; }));
}

// A torque that has but a size, or a size and the width of its step.
bool has_one_form(const Effect& effect) {
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        const bool phase = effect.polar && effect.polar->phase == p;
        if (!parameter.linear && !phase && parameter.name != "width_deg_s" &&
            parameter.left_out != LeftOut::assumed)
            return false;
    }
    return true;
}

}  // namespace

bool is_there_already(const Term& tried, const Model& open) {
    const Effect& effect = *tried.effect;
    if (effect.side == Side::joint) {
        // A load is picked up and put down; more changes take up whatever else differs from move to move.
        constexpr std::ptrdiff_t most_changes = 2;
        if (find_parameter(effect, "time_s") &&
            std::ranges::count(open.terms, &effect, &Term::effect) >= most_changes)
            return true;
        return has_one_form(effect) && std::ranges::any_of(open.terms, [&](const Term& term) {
                   return term.effect == &effect && !term.values.front();
               });
    }
    return std::any_of(open.terms.begin(), open.terms.end(), [&](const Term& term) {
        if (term.effect != &effect) return false;
        bool fitted = false;
        for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
            if (!term.values[p]) {
                fitted = true;
            } else if (effect.stated_from != p && effect.parameters[p].left_out != LeftOut::fitted &&
                       term.values[p] != tried.values[p]) {
                return false;
            }
        }
        return fitted;
    });
}

RatioRange ratios_beside(const Candidate& model, double about) {
    const RatioRange all{limits::screening::lowest_ratio * about, limits::screening::highest_ratio * about};
    RatioRange range = all;
    for (std::size_t t = 0; t < model.stated.terms.size(); ++t) {
        const Term& term = model.stated.terms[t];
        const auto place = term.effect->ripple_order;
        if (!place) continue;
        if (model.prices[t] == 0.0) return all;
        for (const double other : term.effect->parameters[*place].tried) {
            const double between = about * std::sqrt(other / *term.values[*place]);
            if (between < about) range.lowest = std::max(range.lowest, between);
            if (between > about) range.highest = std::min(range.highest, between);
        }
    }
    return range;
}

Hints hints_of(const ModelBench& bench, const Candidate& model, const std::vector<double>& left_nm) {
    const Model& stated = model.stated;
    Hints hints;
    if (bench.looked_at().expected_delay) hints.delay_s = bench.looked_at().expected_delay->value();
    hints.tones_hz = strongest_tones_hz(bench.looked_at(), left_nm);
    StatedRipple ripple = stated_ripple(stated);
    hints.ratio = ripple.ratio;
    hints.orders = std::move(ripple.orders);
    Model without_ripple = stated;
    std::erase_if(without_ripple.terms,
                  [](const Term& term) { return term.effect->ripple_order.has_value(); });
    hints.ratios =
        likely_ratios(seen_late(bench.looked_at(), lateness_of(stated)), bench.raw_residual(without_ripple),
                      hints.orders, ratios_beside(model, hints.ratio.value()));
    hints.least_order =
        360.0 * limits::screening::least_cycle / std::max(both_ways_deg(bench.looked_at()), 1e-9);
    hints.changes = change_times(bench.looked_at(), left_nm, bench.noise().rms_nm);
    return hints;
}

std::vector<Term> starts_of(const Effect& effect, const Hints& hints, double samples, double& cells) {
    std::vector<Term> starts{{&effect, {}}};
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        const bool phase = effect.polar && p == effect.polar->phase;
        std::vector<double> values{parameter.linear || phase ? parameter.start : parameter.neutral};
        if (!parameter.linear && !phase) values = tried(effect, p, hints, samples, cells);
        std::vector<Term> more;
        for (const Term& start : starts) {
            for (const double value : values) {
                more.push_back(start);
                more.back().values.emplace_back(value);
            }
        }
        starts = std::move(more);
    }
    // A ripple effect of an order that the model has already adds nothing new, but a screening finds that out
    // by itself.
    return starts;
}

}  // namespace ripplenotch
