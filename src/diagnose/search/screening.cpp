// SPDX-License-Identifier: MIT
#include "diagnose/search/screening.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/linear_algebra.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/search/search_starts.hpp"
#include "model/carriers.hpp"
#include "model/fit_coordinates.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd to_vector(const std::vector<double>& values) {
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

// Takes off what lies along the first `count` columns of the basis.
void take_off(const MatrixXd& basis, Index count, VectorXd& column) {
    const auto rows = static_cast<std::size_t>(column.size());
    for (Index b = 0; b < count; ++b) {
        const double* const other = basis.col(b).data();
        add_scaled(-dot(other, column.data(), rows), other, column.data(), rows);
    }
}

double length_of(const VectorXd& column) {
    return std::sqrt(dot(column.data(), column.data(), static_cast<std::size_t>(column.size())));
}

// A column that keeps most of its length is orthogonal to rounding after one pass; twice is enough for any
// other (Kahan, Parlett).
MatrixXd orthonormal(const std::vector<VectorXd>& columns, Index rows) {
    MatrixXd basis(rows, static_cast<Index>(columns.size()));
    Index kept = 0;
    for (const VectorXd& given : columns) {
        const double length = length_of(given);
        if (!(length > 0.0)) continue;
        VectorXd column = given;
        take_off(basis, kept, column);
        if (length_of(column) < 0.5 * length) take_off(basis, kept, column);
        const double left = length_of(column);
        if (left > 1e-7 * length) basis.col(kept++) = column / left;
    }
    basis.conservativeResize(rows, kept);
    return basis;
}

// Of a column, what lies outside the basis.
VectorXd outside_of(const MatrixXd& basis, VectorXd column) {
    take_off(basis, basis.cols(), column);
    return column;
}

// A joint has one delay, one lag, one gear ratio, and ripple grows with the speed in one way: what a second
// one would mend is another effect's.
bool is_there_already(const Term& tried, const Candidate& model) {
    const Effect& effect = *tried.effect;
    if (effect.side == Side::joint) return false;
    return std::any_of(model.open.terms.begin(), model.open.terms.end(), [&](const Term& term) {
        if (term.effect != &effect) return false;
        bool fitted = false;
        for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
            if (!term.values[p]) {
                fitted = true;
            } else if (effect.parameters[p].left_out != LeftOut::fitted &&
                       term.values[p] != tried.values[p]) {
                return false;
            }
        }
        return fitted;
    });
}

// Of the samples that a screening looks at. The model itself is run along the whole log: what it remembers
// (hysteresis, lag) lies in samples that were left out.
VectorXd residual_of(const ModelBench& bench, const Case& some, const Model& stated) {
    const std::vector<double> whole = bench.raw_residual(stated);
    const std::vector<std::size_t>& rows = bench.looked_at().row;
    VectorXd residual(static_cast<Index>(some.size()));
    for (std::size_t k = 0; k < some.size(); ++k) {
        const auto at = std::ranges::lower_bound(rows, some.row[k]) - rows.begin();
        residual[static_cast<Index>(k)] = whole[static_cast<std::size_t>(at)];
    }
    return residual;
}

class Screening {
  public:
    Screening(const ModelBench& bench, const Candidate& model, Case some, const Hints& hints)
        : model_(model),
          rules_(bench.rules()),
          case_(std::move(some)),
          prediction_(model.stated, case_.motion, &carriers_),
          samples_(bench.samples()),
          work_(bench.work()),
          hints_(hints) {
        counts_.resize(static_cast<Index>(case_.size()));
        for (std::size_t k = 0; k < case_.size(); ++k)
            counts_[static_cast<Index>(k)] = case_.use[k] != 0 ? 1.0 : 0.0;
        residual_ = counted(residual_of(bench, case_, model.stated));
        basis_ = orthonormal(columns_of(model.open, prediction_, false), residual_.size());
        left_ = outside(residual_);
        // Gains of the thinned log in those of the whole one.
        unit_ = samples_ / std::max(counts_.sum(), 1.0) / (bench.noise().rms_nm * bench.noise().rms_nm);
    }

    [[nodiscard]] std::optional<Trial> best(const Effect& effect, std::size_t effects) const {
        double cells = 1.0;
        const auto starts = starts_of(effect, hints_, samples_, cells);
        std::optional<Trial> best;
        for (const Term& start : starts) {
            if (is_there_already(start, model_)) continue;
            Trial trial = opened(start);
            const double values = static_cast<double>(free_values(trial.open));
            trial.price = values * portable::log(samples_) + 2.0 * portable::log(cells) +
                          2.0 * portable::log(static_cast<double>(effects) / rules_.screening.false_alarm);
            trial.gain = gain_of(start) * unit_;
            if (trial.gain > 0.0 && (!best || trial.score() > best->score())) best = trial;
        }
        return best;
    }

  private:
    // Slopes of the model's coordinates, and the errors of the motion.
    [[nodiscard]] std::vector<VectorXd> columns_of(const Model& open, const Prediction& prediction,
                                                   bool only_linear) const {
        const Coordinates coordinates(open, &prediction.model());
        std::vector<double> point;
        for (const Coordinate& coordinate : coordinates.list()) point.push_back(coordinate.start);
        std::vector<VectorXd> columns;
        for (std::size_t c = 0; c < point.size(); ++c) {
            const Coordinate& coordinate = coordinates.list()[c];
            if (only_linear && !coordinate.linear && coordinate.kind == CoordinateKind::logarithm) continue;
            columns.push_back(counted(to_vector(slope_nm(prediction, coordinates, point, c))));
        }
        for (const Nuisance& error : motion_errors(case_, prediction.model(), rules_.recording))
            columns.push_back(counted(to_vector(error.torque_nm)));
        return columns;
    }

    [[nodiscard]] VectorXd outside(const VectorXd& column) const { return outside_of(basis_, column); }

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

    [[nodiscard]] VectorXd counted(const VectorXd& column) const { return column.cwiseProduct(counts_); }

    // Fall of the sum of squares, in Nm^2, of the thinned log.
    [[nodiscard]] double gain_of(const Term& start) const {
        const Effect& effect = *start.effect;
        const bool sized = std::any_of(effect.parameters.begin(), effect.parameters.end(),
                                       [](const Parameter& parameter) { return parameter.linear; });
        return sized ? gain_beside(start) : gain_within(start);
    }

    // Of an effect with a size: its torque is added to the model's.
    [[nodiscard]] double gain_beside(const Term& start) const {
        const Effect& effect = *start.effect;
        std::vector<VectorXd> columns;
        double least = -1e300;
        const auto add = [&](Term term) { columns.push_back(counted(to_vector(prediction_.added(term)))); };
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
                    least = parameter.lower >= 0.0 ? 0.0 : least;
                }
            } else if (effect.side != Side::joint && parameter.left_out == LeftOut::fitted &&
                       parameter.tried.empty() && !(effect.polar && effect.polar->phase == p)) {
                // A second number that acts without the size, such as a phase that differs by direction.
                term.values[p] = parameter.neutral + 1e-3 * (parameter.upper - parameter.lower);
                add(term);
            }
        }
        std::vector<VectorXd> beside;
        for (const VectorXd& column : columns) {
            const VectorXd part = outside(column);
            if (!(part.norm() > rules_.screening.least_outside * column.norm())) continue;
            beside.push_back(part);
        }
        if (beside.empty()) return 0.0;
        if (columns.size() == 1 && least == 0.0 && beside[0].dot(left_) < 0.0) return 0.0;
        const MatrixXd basis = orthonormal(beside, left_.size());
        double gain = 0.0;
        for (Index b = 0; b < basis.cols(); ++b) {
            const double along = basis.col(b).dot(left_);
            gain += along * along;
        }
        return gain;
    }

    // Of an effect that changes the model's own torque: everything linear is solved anew.
    [[nodiscard]] double gain_within(const Term& start) const {
        Model with = model_.stated, open = model_.open;
        with.terms.push_back(start);
        open.terms.push_back(start);
        const Prediction changed(with, case_.motion, &carriers_);
        const MatrixXd basis = orthonormal(columns_of(open, changed, true), residual_.size());
        const VectorXd left =
            residual_ + counted(to_vector(prediction_.torque_nm()) - to_vector(changed.torque_nm()));
        work_.add(changed.applied(), case_.size());
        return left_.squaredNorm() - outside_of(basis, left).squaredNorm();
    }

    const Candidate& model_;
    const DiagnosisRules& rules_;
    Case case_;
    mutable Carriers carriers_;
    Prediction prediction_;
    double samples_, unit_ = 1.0;
    Work& work_;
    VectorXd counts_, residual_, left_;
    MatrixXd basis_;
    const Hints& hints_;
};

}  // namespace

std::vector<Trial> screen(const ModelBench& bench, const Candidate& model,
                          std::span<const Effect* const> effects) {
    if (const auto before = bench.screened(model.stated, effects)) return *before;
    const Hints hints = hints_of(bench, model.stated);
    const std::size_t count = bench.rules().screening.sketch_samples;
    const Screening thinned(bench, model, sketch(bench.looked_at(), count), hints);
    // Delays and lags look at neighbouring samples, which a thinned log does not have.
    const Screening stretches(bench, model, blocks(bench.looked_at(), count, bench.rules().recording), hints);
    std::vector<Trial> trials;
    // A thinned log has no delay of a few samples, and what lies behind one has the wrong phase there.
    const bool delayed = std::ranges::any_of(
        model.stated.terms, [](const Term& term) { return term.effect->side == Side::sensor; });
    for (const Effect* effect : effects) {
        const Screening& screening = delayed || effect->side == Side::sensor ? stretches : thinned;
        if (auto trial = screening.best(*effect, effects.size())) trials.push_back(*trial);
    }
    std::stable_sort(trials.begin(), trials.end(),
                     [](const Trial& a, const Trial& b) { return a.score() > b.score(); });
    bench.remember(model.stated, effects, trials);
    return trials;
}

}  // namespace ripplenotch
