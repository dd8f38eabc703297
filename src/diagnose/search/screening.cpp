// SPDX-License-Identifier: MIT
#include "diagnose/search/screening.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose/search/search_starts.hpp"
#include "model/carriers.hpp"
#include "model/fit/weighing.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

// Whether a screening solves for this coordinate anew together with another effect.
bool is_solved(const Coordinate& coordinate) {
    return coordinate.linear || coordinate.kind != CoordinateKind::logarithm;
}

// A term whose torque a change of the ripple does not affect.
bool is_plain(const Term& term) { return term.effect->side == Side::joint && !term.effect->ripple_order; }

std::vector<double> starts(const Coordinates& coordinates) {
    std::vector<double> point;
    for (const Coordinate& coordinate : coordinates.list()) point.push_back(coordinate.start);
    return point;
}

// The samples that a screening uses, from the model's residual along the whole log: effects with memory
// (hysteresis, lag) depend on samples that were left out.
Column residual_of(const ModelBench& bench, const Case& some, const std::vector<double>& left_nm) {
    const std::vector<std::size_t>& rows = bench.looked_at().row;
    Column residual;
    for (const std::size_t row : some.row)
        residual.push_back(
            left_nm[static_cast<std::size_t>(std::ranges::lower_bound(rows, row) - rows.begin())]);
    return residual;
}

class Screening {
  public:
    static constexpr std::size_t all_lags = static_cast<std::size_t>(-1);

    /// `most_lags`: as many samples as there are before the first that counts.
    Screening(const ModelBench& bench, const Candidate& model, const std::vector<double>& left_nm, Case some,
              const Hints& hints, std::size_t most_lags)
        : model_(model),
          case_(std::move(some)),
          prediction_(model.stated, case_.motion, &carriers_),
          samples_(bench.samples()),
          work_(bench.work()),
          hints_(hints) {
        const double full_hz = bench.looked_at().motion.sample_rate.value();
        const auto step = static_cast<std::size_t>(std::lround(full_hz / case_.motion.sample_rate.value()));
        const double counting = std::max(static_cast<double>(case_.used()), 1.0);
        const double lag_price = limits::noise_floor::lag_price;
        const NoiseFloor::Thinned noise = bench.noise().thinned(step, most_lags, counting, lag_price);
        const NoiseFloor::Thinned full = bench.noise().thinned(1, all_lags, samples_, lag_price);
        weighing_.emplace(case_.size(), case_.use, noise.color, case_.valid);
        weighing_->set_nuisance(uncertain_torques(case_, model.stated), noise.white_nm);
        residual_ = counted(residual_of(bench, case_, left_nm));
        look_at_slopes();
        left_ = outside_of(basis_, residual_);
        // Gains of the thinned log in those of the whole one: what slow torques stand against is the noise's
        // density there, and that of rows which were left out is as large.
        const double part = counting * static_cast<double>(step) / samples_;
        unit_ = noise.density_nm2 / full.density_nm2 / part / (noise.white_nm * noise.white_nm);
    }

    /// Among the starts that act as a sensor does, or among the others.
    [[nodiscard]] std::optional<Trial> best(const Effect& effect, std::size_t effects, bool sensors) const {
        double cells = 1.0;
        const auto starts = starts_of(effect, hints_, samples_, cells);
        std::optional<Trial> best;
        for (const Term& start : starts) {
            if (sensors != (side_of(start) == Side::sensor)) continue;
            if (is_there_already(start, model_.open) || !turns_a_period(start)) continue;
            Trial trial = opened(start);
            const double values = static_cast<double>(free_values(trial.open));
            trial.price = values * portable::log(samples_) + 2.0 * portable::log(cells) +
                          2.0 * portable::log(static_cast<double>(effects) / limits::screening::false_alarm);
            trial.gain = gain_of(start) * unit_;
            if (trial.gain > 0.0 && (!best || trial.score() > best->score())) best = trial;
        }
        return best;
    }

  private:
    // A torque that repeats with the output angle has to repeat within the travel: over less than a period
    // every smooth function of the position looks like it.
    [[nodiscard]] bool turns_a_period(const Term& start) const {
        const Effect& effect = *start.effect;
        const auto order = find_parameter(effect, "order");
        const bool is_friction = find_parameter(effect, "width_deg_s").has_value();
        if (effect.domain != Domain::position || is_friction || !order) return true;
        const auto& position_deg = case_.motion.position_deg;
        const auto [low, high] = std::ranges::minmax_element(position_deg);
        return (*high - *low) * *start.values[*order] >= 360.0;
    }

    // Slopes of the model's coordinates, and the errors of the motion.
    void look_at_slopes() {
        std::vector<Column> all;
        errors_ = acceleration_errors(case_, prediction_.model());
        for (const Nuisance& error : errors_) all.push_back(counted(error.torque_nm));
        std::vector<Column> untouched = all;
        errors_basis_ = orthonormal(untouched);
        walk_ = walk_errors(case_, prediction_.model());
        for (const Nuisance& error : walk_) all.push_back(counted(error.torque_nm));
        const Coordinates coordinates(model_.open, &prediction_.model());
        const std::vector<double> point = starts(coordinates);
        for (std::size_t c = 0; c < point.size(); ++c) {
            const Coordinate& coordinate = coordinates.list()[c];
            slopes_nm_.push_back(slope_nm(prediction_, coordinates, point, c));
            all.push_back(counted(slopes_nm_.back()));
            if (is_solved(coordinate) && is_plain(model_.open.terms[coordinate.term]))
                untouched.push_back(all.back());
        }
        basis_ = orthonormal(all);
        plain_basis_ = orthonormal(untouched);
    }

    static std::size_t free_values(const Term& term) {
        std::size_t count = 0;
        for (std::size_t p = 0; p < term.values.size(); ++p) {
            // Lines that were picked from a list are chosen as much as fitted.
            const bool picked = term.effect->parameters[p].left_out == LeftOut::refused;
            if (!term.values[p] || picked) ++count;
        }
        return count;
    }

    static Trial opened(const Term& start) {
        Trial trial{start, start};
        for (std::size_t p = 0; p < start.values.size(); ++p) {
            if (start.effect->parameters[p].left_out == LeftOut::fitted) trial.open.values[p].reset();
        }
        return trial;
    }

    // The samples that count, whitened.
    [[nodiscard]] Column counted(const Column& column) const { return (*weighing_)(column); }

    // Fall of the sum of squares, in Nm^2, of the thinned log.
    [[nodiscard]] double gain_of(const Term& start) const {
        const Effect& effect = *start.effect;
        const bool sized = std::any_of(effect.parameters.begin(), effect.parameters.end(),
                                       [](const Parameter& parameter) { return parameter.linear; });
        return sized ? gain_beside(start) : gain_within(start);
    }

    // Gain of an effect with a size: its torque is added to the model's.
    [[nodiscard]] double gain_beside(const Term& start) const {
        const Effect& effect = *start.effect;
        std::vector<Column> columns;
        double least = -1e300;
        const auto add = [&](Term term) { columns.push_back(counted(prediction_.added(term))); };
        for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
            const Parameter& parameter = effect.parameters[p];
            Term term = start;
            for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
                if (effect.parameters[i].linear) term.values[i] = 0.0;
            }
            if (parameter.linear) {
                // Small enough that a change of the ripple stays in proportion.
                term.values[p] = effect.side == Side::joint ? 1.0 : 1e-2 * parameter.start;
                add(term);
                if (effect.polar && effect.polar->size == p) {
                    term.values[effect.polar->phase] = *term.values[effect.polar->phase] + 90.0;
                    add(term);
                } else {
                    least = least_in(model_.open, effect, p) >= 0.0 ? 0.0 : least;
                }
            } else if (effect.side != Side::joint && parameter.left_out == LeftOut::fitted &&
                       parameter.tried.empty() && !(effect.polar && effect.polar->phase == p)) {
                // A second number that acts without the size, such as a phase that differs by direction.
                term.values[p] = parameter.neutral + 1e-3 * (parameter.upper - parameter.lower);
                add(term);
            }
        }
        std::vector<Column> beside;
        for (const Column& column : columns) {
            const Column part = outside_of(basis_, column);
            const double part_asked = limits::screening::least_outside;
            if (!(product(part, part) > part_asked * part_asked * product(column, column))) continue;
            beside.push_back(part);
        }
        if (beside.empty()) return 0.0;
        if (columns.size() == 1 && least == 0.0 && product(beside[0], left_) < 0.0) return 0.0;
        double gain = 0.0;
        for (const Column& direction : orthonormal(beside)) {
            const double along = product(direction, left_);
            gain += along * along;
        }
        return gain;
    }

    // Gain of an effect that changes the model's own torque: everything linear is solved anew.
    [[nodiscard]] double gain_within(const Term& start) const {
        if (const auto torque_nm = prediction_.behind(start, prediction_.torque_nm()))
            return gain_behind(start, *torque_nm);
        Model open = model_.open;
        open.terms.push_back(start);
        const Prediction changed = prediction_.with(start);
        const bool only_ripple = changed.has_only_ripple_anew();
        const Coordinates coordinates(open, &changed.model());
        const std::vector<double> point = starts(coordinates);
        std::vector<Column> columns;
        for (std::size_t c = 0; c < point.size(); ++c) {
            const Coordinate& coordinate = coordinates.list()[c];
            if (!is_solved(coordinate) || (only_ripple && is_plain(open.terms[coordinate.term]))) continue;
            columns.push_back(counted(slope_nm(changed, coordinates, point, c)));
        }
        for (const Nuisance& error : walk_errors(case_, changed.model()))
            columns.push_back(counted(error.torque_nm));
        work_.add(changed.applied(), case_.size());
        return fall(only_ripple ? plain_basis_ : errors_basis_, columns, changed.torque_nm());
    }

    // Gain of a sensor that comes after all others: it transforms each slope as it does the torque.
    [[nodiscard]] double gain_behind(const Term& sensor, const std::vector<double>& torque_nm) const {
        const Coordinates coordinates(model_.open, &prediction_.model());
        std::vector<Column> columns;
        for (std::size_t c = 0; c < slopes_nm_.size(); ++c) {
            if (!is_solved(coordinates.list()[c])) continue;
            columns.push_back(counted(*prediction_.behind(sensor, slopes_nm_[c])));
        }
        for (const Nuisance& error : errors_)
            columns.push_back(counted(carries_errors(sensor) ? *prediction_.behind(sensor, error.torque_nm)
                                                             : error.torque_nm));
        for (const Nuisance& error : walk_)
            columns.push_back(counted(*prediction_.behind(sensor, error.torque_nm)));
        work_.add(columns.size() + 1, case_.size());
        return fall({}, columns, torque_nm);
    }

    // Fall of the square where the model's torque becomes another one.
    [[nodiscard]] double fall(std::span<const Column> basis, std::span<const Column> columns,
                              std::vector<double> torque_nm) const {
        for (std::size_t k = 0; k < torque_nm.size(); ++k)
            torque_nm[k] = prediction_.torque_nm()[k] - torque_nm[k];
        Column left = counted(torque_nm);
        for (std::size_t k = 0; k < left.size(); ++k) left[k] += residual_[k];
        return product(left_, left_) - (product(left, left) - explained(basis, columns, left));
    }

    const Candidate& model_;
    Case case_;
    mutable Carriers carriers_;
    Prediction prediction_;
    double samples_, unit_ = 1.0;
    std::optional<Weighing> weighing_;
    Work& work_;
    Column residual_, left_;
    std::vector<std::vector<double>> slopes_nm_;  ///< one for each of the model's coordinates
    std::vector<Nuisance> errors_, walk_;
    std::vector<Column> basis_, plain_basis_,
        errors_basis_;  ///< bases of all, of all without ripple, of errors
    const Hints& hints_;
};

std::vector<Trial> sorted(std::vector<Trial> trials) {
    std::stable_sort(trials.begin(), trials.end(),
                     [](const Trial& a, const Trial& b) { return a.score() > b.score(); });
    return trials;
}

// Filters as near as that rank trials alike.
bool same_color(const std::vector<double>& a, const std::vector<double>& b) {
    constexpr double near = 0.02;
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::abs(a[i] - b[i]) > near) return false;
    }
    return true;
}

}  // namespace

std::vector<Trial> screen(const ModelBench& bench, const Candidate& model,
                          std::span<const Effect* const> effects) {
    const std::vector<double> left_nm = bench.raw_residual(model.stated);
    const SeenModel seen{model.open, left_nm, effects};
    const double unit_nm2 = bench.noise().rms_nm * bench.noise().rms_nm;
    KeptBeside<Screened>& kept = bench.kept()->screened;
    const Screened* before = kept.find(seen, bench.looked_at().use, bench.same_model_nm2());
    if (before != nullptr && same_color(before->color, bench.noise().color)) {
        std::vector<Trial> trials = before->trials;
        for (Trial& trial : trials) trial.gain *= before->unit_nm2 / unit_nm2;
        return sorted(std::move(trials));
    }
    const Hints hints = hints_of(bench, model, left_nm);
    const std::size_t count = limits::screening::sketch_samples;
    const Screening thinned(bench, model, left_nm, sketch(bench.looked_at(), count), hints,
                            Screening::all_lags);
    // Delays and lags look at neighbouring samples, which a thinned log does not have.
    const Screening stretches(bench, model, left_nm, blocks(bench.looked_at(), count), hints,
                              limits::recording::block_begin);
    std::optional<Screening> ringing;
    if (std::ranges::any_of(effects, [](const Effect* effect) { return effect->whole.has_value(); }))
        ringing.emplace(bench, model, left_nm, long_blocks(bench.looked_at(), 2 * count), hints,
                        limits::recording::ringing_begin);
    std::vector<Trial> trials;
    // A thinned log has no delay of a few samples, and what lies behind one has the wrong phase there.
    const bool delayed = std::ranges::any_of(model.stated.terms,
                                             [](const Term& term) { return side_of(term) == Side::sensor; });
    for (const Effect* effect : effects) {
        // One that may act on either side is tried on both: which closes more is known once it is fitted.
        for (const bool sensors : {false, true}) {
            const Screening& screening =
                sensors && effect->whole ? *ringing : (delayed || sensors ? stretches : thinned);
            if (auto trial = screening.best(*effect, effects.size(), sensors)) trials.push_back(*trial);
        }
    }
    return sorted(kept.keep(seen, {std::move(trials), unit_nm2, bench.noise().color}).trials);
}

}  // namespace ripplenotch
