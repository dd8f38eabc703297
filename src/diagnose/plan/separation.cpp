// SPDX-License-Identifier: MIT
#include "diagnose/plan/separation.hpp"

#include <algorithm>
#include <cmath>

#include "core/vectors/dot.hpp"
#include "diagnose/search/search_starts.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

using TermColumn = std::vector<double>;

double square(const TermColumn& column) { return dot(column.data(), column.data(), column.size()); }

// Columns made orthogonal to one another, one after the other (Gram and Schmidt, twice for each).
class Basis {
  public:
    // What is left of the column beside those that are in.
    [[nodiscard]] TermColumn left(TermColumn column) const {
        for (int turn = 0; turn < 2; ++turn)
            for (const TermColumn& one : ortho_)
                add_scaled(-dot(one.data(), column.data(), column.size()), one.data(), column.data(),
                           column.size());
        return column;
    }
    void add(TermColumn column) {
        constexpr double next_to_nothing = 1e-14;  // of its square: it is in already
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

// How the torque changes with each value of the model that a fit would look for.
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

// Squares of `target` that the place leaves, all of it beside the basis.
double left_beside(const Basis& basis, const TermColumn& target, const TriedPlace& place) {
    Basis own;
    for (const TermColumn& column : place.columns) own.add(basis.left(column));
    return square(own.left(target));
}

}  // namespace

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
        // Its size, as if it had the first phase: how far it is from the term hangs little on the phase.
        const double size = std::sqrt(square(torque) / square(one));
        for (std::size_t p = 0; p < found.values.size(); ++p)
            if (rival.parameters[p].linear && allows(rival.parameters[p], size)) found.values[p] = size;
    }
    return any;
}

}  // namespace ripplenotch
