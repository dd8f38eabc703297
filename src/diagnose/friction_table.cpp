// SPDX-License-Identifier: MIT
#include "ripplenotch/diagnose/friction_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Chance that a table without any of the further frictions gets one.
constexpr double false_alarm = 0.01;
// Two of which the chances are less than 400 to 1 apart are a tie, as 2 log(odds).
constexpr double tie_margin = 12.0;

// Rows as a motion: each at its speed, not accelerated, and at no position in particular.
Motion motion_of(const FrictionTable& table) {
    Motion motion;
    motion.sample_rate = Hertz(1.0);
    for (std::size_t k = 0; k < table.velocity_deg_s.size(); ++k) {
        motion.time_s.push_back(static_cast<double>(k));
        motion.velocity_deg_s.push_back(table.velocity_deg_s[k]);
    }
    motion.position_deg.assign(motion.size(), 0.0);
    motion.acceleration_deg_s2.assign(motion.size(), 0.0);
    return motion;
}

// The last decimal place that the torques have: they are not known better than to half of it.
double rounding_nm(std::span<const double> torque_nm) {
    double step = 1.0;
    for (int decimals = 0; decimals < 12; ++decimals, step *= 0.1) {
        const bool all = std::ranges::all_of(
            torque_nm, [step](double nm) { return std::abs(nm / step - std::round(nm / step)) < 1e-6; });
        if (all) return step;
    }
    return 0.0;
}

class TableFit {
  public:
    TableFit(const FrictionTable& table) : motion_(motion_of(table)), torque_nm_(table.torque_nm) {
        double slowest = std::numeric_limits<double>::infinity();
        for (const double v : motion_.velocity_deg_s) slowest = std::min(slowest, std::abs(v));
        // Each row is steady motion, in which the step at standstill is complete: a tanh of 5 is.
        const double complete = 5.0;
        width_deg_s_ = std::clamp(slowest / complete, 0.001, 0.2);
        const double step_nm = rounding_nm(torque_nm_);
        // The mean square of an error that is anything within a step.
        least_squares_ = static_cast<double>(motion_.size()) * std::max(step_nm * step_nm / 12.0, 1e-24);
    }

    [[nodiscard]] Term term(std::string_view name) const {
        const Effect& effect = find_effect(name);
        Term made{&effect, std::vector<std::optional<double>>(effect.parameters.size())};
        if (const auto width = find_parameter(effect, "width_deg_s")) made.values[*width] = width_deg_s_;
        return made;
    }

    struct Fitted {
        Model open;  ///< fitted values left out
        Fit fit;
        double squares = 0.0;
        [[nodiscard]] double freedom() const {
            return static_cast<double>(fit.samples) - static_cast<double>(fit.values.size());
        }
    };

    // The best of fits that begin at each Stribeck speed that the catalogue tries, and at those of the rows.
    [[nodiscard]] Fitted fitted(const Model& open) const {
        std::vector<Model> starts{open};
        for (std::size_t t = 0; t < open.terms.size(); ++t) {
            const auto place = find_parameter(*open.terms[t].effect, "stribeck_speed_deg_s");
            if (!place || open.terms[t].values[*place]) continue;
            const Parameter& speed = open.terms[t].effect->parameters[*place];
            std::vector<double> tried(speed.tried.begin(), speed.tried.end());
            for (const double v : motion_.velocity_deg_s) tried.push_back(std::abs(v));
            starts.clear();
            for (const double at : tried) {
                starts.push_back(open);
                starts.back().terms[t].values[*place] = std::clamp(at, speed.lower, speed.upper);
            }
        }
        Fitted best{open, {}, std::numeric_limits<double>::infinity()};
        for (const Model& start : starts) {
            Fitted one = fitted_from(open, start);
            if (one.squares < best.squares) best = std::move(one);
        }
        return best;
    }

    // The chance that noise alone lowers the squares as much by one or two values: exact for two of a linear
    // model (F distribution with 2 degrees of freedom), and an upper bound for one.
    [[nodiscard]] double chance(const Fitted& with, const Fitted& without) const {
        if (with.freedom() < 1.0) return 1.0;
        const double ratio = with.squares / std::max(without.squares, with.squares);
        return std::min(1.0, portable::pow(ratio, 0.5 * with.freedom()) * cells());
    }

    // The t of a size that is found just so, of so many degrees of freedom.
    [[nodiscard]] double least_t(double freedom) const {
        const double ratio = portable::pow(false_alarm / cells(), 2.0 / freedom);
        return std::sqrt(freedom * (1.0 / ratio - 1.0));
    }

    // Trials in all: three curves of fixed form, two of them together, and a Stribeck speed may be anything
    // between the rows, which their number bounds.
    [[nodiscard]] double cells() const { return 4.0 + static_cast<double>(motion_.size()); }

    // From where to where a value may go until the squares, least over all others, rise by as much as
    // Student's t allows. For a value that the torque is linear in, in a linear model, it is the usual
    // interval.
    [[nodiscard]] Interval interval(const Fitted& best, const FittedValue& value) const {
        const Parameter& parameter = best.open.terms[value.term].effect->parameters[value.parameter];
        const double t = student_95(best.freedom());
        const double most = std::max(best.squares, least_squares_) * (1.0 + t * t / best.freedom());
        const auto is_within = [&](double at) {
            Model stated = best.open;
            stated.terms[value.term].values[value.parameter] = at;
            // Every value is a guess; those that are open in `stated` move on from there.
            return fitted_from(stated, best.fit.model).squares <= most;
        };
        return {end_of(parameter, value, parameter.lower, is_within),
                end_of(parameter, value, parameter.upper, is_within)};
    }

    [[nodiscard]] double error_of(const Fitted& with, std::string_view parameter) const {
        for (const FittedValue& value : with.fit.values) {
            if (with.open.terms[value.term].effect->parameters[value.parameter].name == parameter &&
                value.term + 1 == with.open.terms.size())
                return value.standard_error.value_or(std::numeric_limits<double>::infinity());
        }
        return std::numeric_limits<double>::infinity();
    }

    [[nodiscard]] const Motion& motion() const { return motion_; }
    [[nodiscard]] double least_squares() const { return least_squares_; }

  private:
    [[nodiscard]] Fitted fitted_from(const Model& open, const Model& start) const {
        const FitOptions options{.first_guess = &start};
        Fitted found{open, fit(open, motion_, torque_nm_, options), 0.0};
        const double rms_nm = found.fit.residual_rms_nm;
        found.squares = std::max(rms_nm * rms_nm * static_cast<double>(motion_.size()), least_squares_);
        return found;
    }

    [[nodiscard]] static double end_of(const Parameter& parameter, const FittedValue& value, double bound,
                                       const std::function<bool(double)>& is_within) {
        // Steps away from the value that double until they are outside, then halves between.
        const auto at = [&](double step) {
            const double sign = bound < value.value ? -1.0 : 1.0;
            const double there = parameter.logarithmic ? value.value * portable::pow(2.0, sign * step)
                                                       : value.value + sign * step;
            return sign < 0.0 ? std::max(there, bound) : std::min(there, bound);
        };
        const double scale = value.standard_error.value_or(0.1 * std::abs(value.value));
        double inside = 0.0, outside = parameter.logarithmic ? 0.05 : std::max(scale, 1e-12);
        while (is_within(at(outside))) {
            if (at(outside) == bound) return bound;
            inside = outside;
            outside *= 2.0;
        }
        for (int halving = 0; halving < 20; ++halving) {
            const double middle = 0.5 * (inside + outside);
            (is_within(at(middle)) ? inside : outside) = middle;
        }
        return at(0.5 * (inside + outside));
    }

    Motion motion_;
    std::span<const double> torque_nm_;
    double width_deg_s_ = 0.2, least_squares_ = 0.0;
};

// Rows that move.
struct Rows {
    std::vector<double> velocity_deg_s, torque_nm;
};

Rows moving(const FrictionTable& table, FrictionDiagnosis& result) {
    Rows rows;
    for (std::size_t k = 0; k < table.velocity_deg_s.size(); ++k) {
        const double v = table.velocity_deg_s[k];
        if (v == 0.0) {
            ++result.rows_at_rest;
            continue;
        }
        rows.velocity_deg_s.push_back(v);
        rows.torque_nm.push_back(table.torque_nm[k]);
        ++(v > 0.0 ? result.positive : result.negative);
    }
    result.rows = rows.velocity_deg_s.size();
    return rows;
}

void check_rows(const Rows& rows, FrictionDiagnosis& result) {
    // Two values, and one row more for their errors.
    constexpr std::size_t fewest = 3;
    if (rows.velocity_deg_s.size() < fewest)
        raise<DataError>(
            "{} rows that move, expected {} or more: Coulomb and viscous friction are two values, "
            "and their errors need a row more",
            rows.velocity_deg_s.size(), fewest);
    Span& speed = result.speed_deg_s;
    speed = {std::numeric_limits<double>::infinity(), 0.0};
    double along = 0.0;
    for (std::size_t k = 0; k < rows.velocity_deg_s.size(); ++k) {
        const double v = rows.velocity_deg_s[k];
        speed = {std::min(speed.from, std::abs(v)), std::max(speed.to, std::abs(v))};
        along += v > 0.0 ? rows.torque_nm[k] : -rows.torque_nm[k];
    }
    // Speeds as near as this are one that was measured several times.
    constexpr double same = 0.01;
    if (speed.to - speed.from <= same * speed.to)
        raise<DataError>(
            "every row has the speed {:.4g} deg/s, expected two speeds or more: one does not separate "
            "Coulomb from viscous friction",
            speed.to);
    if (along < 0.0)
        raise<DataError>(
            "the mean torque has the sign opposite to the speed, expected the torque that moves the joint "
            "against its friction; invert the sign of one of the columns");
}

// Adds what lowers the squares by more than chance, the most unlikely first. Differences of level and of
// slope that oppose each other explain little alone: where nothing is found, the two are tried together, and
// each has to be more than chance beside the other.
TableFit::Fitted with_found(const TableFit& table, Model model, std::vector<std::string_view> names,
                            FrictionDiagnosis& result) {
    using Names = std::vector<std::string_view>;
    struct Trial {
        Names added;
        TableFit::Fitted fitted;
        double chance = 1.0;
    };
    TableFit::Fitted best = table.fitted(model);
    const auto tried = [&](Names added) {
        Model with = best.open;
        for (const std::string_view name : added) with.terms.push_back(table.term(name));
        if (table.motion().size() <= best.fit.values.size() + added.size() + 1)
            return Trial{std::move(added), best};
        TableFit::Fitted fitted = table.fitted(with);
        const double chance = table.chance(fitted, best);
        return Trial{std::move(added), std::move(fitted), chance};
    };
    while (!names.empty()) {
        std::vector<Trial> trials;
        for (const std::string_view name : names) trials.push_back(tried({name}));
        Trial found = *std::ranges::min_element(trials, {}, &Trial::chance);
        std::vector<const Trial*> differences;
        for (const Trial& one : trials) {
            if (one.added[0].starts_with("asymmetric-")) differences.push_back(&one);
        }
        if (found.chance > false_alarm && differences.size() == 2) {
            Trial both = tried({differences[0]->added[0], differences[1]->added[0]});
            const bool is_each_needed = std::ranges::all_of(differences, [&](const Trial* alone) {
                return table.chance(both.fitted, alone->fitted) <= false_alarm;
            });
            if (is_each_needed) found = std::move(both);
        }
        if (found.chance > false_alarm) {
            for (std::size_t i = 0; i < names.size(); ++i)
                result.tried.push_back({names[i], false, trials[i].chance});
            break;
        }
        for (const std::string_view name : found.added) {
            result.tried.push_back({name, true, found.chance});
            std::erase(names, name);
        }
        best = std::move(found.fitted);
    }
    return best;
}

// What was not added and would have explained the table as well in the place of what was.
void add_rivals(const TableFit& table, const TableFit::Fitted& best, FrictionDiagnosis& result) {
    constexpr std::size_t always = 2;  // Coulomb and viscous
    for (std::size_t t = always; t < best.open.terms.size(); ++t) {
        const std::string name(best.open.terms[t].effect->name);
        for (const TriedFriction& other : result.tried) {
            if (other.found) continue;
            Model model = best.open;
            model.terms[t] = table.term(other.effect);
            const double behind = static_cast<double>(table.motion().size()) *
                                  portable::log(table.fitted(model).squares / best.squares);
            if (behind >= tie_margin) continue;
            const bool is_stribeck = name == "stribeck-friction" || other.effect == "stribeck-friction";
            result.ambiguous.push_back(
                {{name, std::string(other.effect)},
                 is_stribeck ? "rows at more speeds, below the Stribeck speed and far above it,"
                             : "rows at more speeds, the fastest five times the slowest or more,"});
        }
    }
}

void examine_stribeck(const TableFit& table, const TableFit::Fitted& best, FrictionDiagnosis& result) {
    const Effect& stribeck = find_effect("stribeck-friction");
    const auto place = *find_parameter(stribeck, "stribeck_speed_deg_s");
    const double coulomb_nm = best.fit.values.front().value;
    Model with = best.open;
    std::erase_if(with.terms, [&](const Term& term) { return term.effect == &stribeck; });
    with.terms.push_back(table.term(stribeck.name));
    constexpr double finer = 1.1;  // from speed to speed that is examined
    if (table.motion().size() < with.terms.size() + 2) return;
    for (double at = 0.1 * result.speed_deg_s.from; at < 2.0 * result.speed_deg_s.to; at *= finer) {
        if (!allows(stribeck.parameters[place], at)) continue;
        with.terms.back().values[place] = at;
        const TableFit::Fitted there = table.fitted(with);
        // The noise is that of the best model: without the Stribeck friction it would hold it.
        const double own = std::sqrt(there.squares / there.freedom());
        const double error_nm = own > 0.0 ? table.error_of(there, "torque_nm") * result.noise_nm / own
                                          : std::numeric_limits<double>::infinity();
        if (coulomb_nm < table.least_t(there.freedom()) * error_nm) continue;
        if (!result.stribeck_deg_s) result.stribeck_deg_s = Span{at, at};
        result.stribeck_deg_s->to = at;
    }
}

bool is_found(const FrictionDiagnosis& result, std::string_view effect) {
    return std::ranges::any_of(
        result.tried, [effect](const TriedFriction& one) { return one.found && one.effect == effect; });
}

void list_undecidable(FrictionDiagnosis& result) {
    const auto add = [&](std::string_view effect, std::string reason) {
        result.undecidable.push_back({find_effect(effect).name, std::move(reason)});
    };
    if (!is_found(result, "stribeck-friction")) {
        const std::string slowest =
            fmt::format("no row is slower than {:.4g} deg/s", result.speed_deg_s.from);
        if (!result.stribeck_deg_s)
            add("stribeck-friction",
                slowest + ", or too few are slow: it cannot be distinguished from Coulomb friction");
        else
            add("stribeck-friction", fmt::format("below a Stribeck speed of {:.3g} deg/s: {}",
                                                 result.stribeck_deg_s->from, slowest));
    }
    if (result.positive == 0 || result.negative == 0) {
        add("asymmetric-friction", "all rows turn one way");
        add("asymmetric-viscous-friction", "all rows turn one way");
        add("offset", "all rows turn one way: it is part of the Coulomb friction");
    }
    for (const std::string_view effect :
         {"load-friction", "position-dependent-friction", "friction-warm-up", "hysteresis"})
        add(effect, "a table of speed and torque does not show it; a log does");
}

}  // namespace

FrictionDiagnosis diagnose_friction(const FrictionTable& table) {
    if (table.velocity_deg_s.size() != table.torque_nm.size())
        raise<UsageError>("{} speeds and {} torques, expected as many", table.velocity_deg_s.size(),
                          table.torque_nm.size());
    FrictionDiagnosis result;
    const Rows rows = moving(table, result);
    check_rows(rows, result);
    const TableFit fit({rows.velocity_deg_s, rows.torque_nm});
    std::vector<std::string_view> names = {"stribeck-friction", "quadratic-viscous-friction"};
    const bool both_ways = result.positive > 0 && result.negative > 0;
    if (both_ways) names.insert(names.begin(), {"asymmetric-friction", "asymmetric-viscous-friction"});
    const TableFit::Fitted best = with_found(
        fit, {{}, {fit.term("coulomb-friction"), fit.term("viscous-friction")}}, std::move(names), result);
    result.model = best.fit.model;
    result.values = best.fit.values;
    for (FittedValue& value : result.values) {
        value.ci95 = fit.interval(best, value);
        value.standard_error.reset();
    }
    result.residual_nm = best.fit.residual_rms_nm;
    result.noise_nm = std::sqrt(best.squares / best.freedom());
    if (is_found(result, "asymmetric-friction"))
        result.ambiguous.push_back({{"asymmetric-friction", "offset"}, "a torque measured at rest"});
    add_rivals(fit, best, result);
    examine_stribeck(fit, best, result);
    list_undecidable(result);
    return result;
}

}  // namespace ripplenotch
