// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/always_on.hpp"

#include <algorithm>

#include "core/vectors/dot.hpp"
#include "diagnose/beside/weighing/ridge.hpp"
#include "model/fit/fit_coordinates.hpp"
#include "ripplenotch/model/prediction.hpp"
#include "ripplenotch/model/sensors.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view arm = "arm";

bool has_effect(const Model& model, std::string_view name) {
    return std::any_of(model.terms.begin(), model.terms.end(),
                       [&](const Term& term) { return term.effect->name == name; });
}

struct Mend {
    std::string name;
    Term term;  ///< of size 1
    double deviation;
};

// A simulation's error at the joint itself. An arm has inertia and gravity of its own; a model that states
// one of them says how large it is.
std::vector<Mend> mends_of(const Model& model, std::span<const GivenTerm> given,
                           const DiagnosisRules::BesideRules& rules) {
    std::vector<Mend> mends;
    if (given.empty()) return mends;
    const bool simulated =
        std::any_of(given.begin(), given.end(), [](const GivenTerm& term) { return term.name != arm; }) &&
        !is_given(given, arm);
    if (simulated && !has_effect(model, "inertia"))
        mends.push_back({"inertia_kgm2", parse_term("inertia,inertia_kgm2=1"), rules.mended_inertia_kgm2});
    if (simulated && !has_effect(model, "gravity")) {
        mends.push_back(
            {"gravity_cosine_nm", parse_term("gravity,amplitude_nm=1,phase_deg=0"), rules.mended_gravity_nm});
        mends.push_back(
            {"gravity_sine_nm", parse_term("gravity,amplitude_nm=1,phase_deg=90"), rules.mended_gravity_nm});
    }
    mends.push_back({"offset_nm", parse_term("offset,torque_nm=1"), rules.mended_offset_nm});
    return mends;
}

void add(AlwaysOn& columns, std::vector<double> torque_nm, double mean, double deviation) {
    columns.torque_nm.push_back(std::move(torque_nm));
    columns.mean.push_back(mean);
    columns.deviation.push_back(deviation);
}

// A torque at the joint; the model's delay and lag act on all of it.
void add_stated(AlwaysOn& columns, std::vector<double> at_joint_nm, const Model& model,
                const Motion& motion) {
    if (has_sensors(model)) columns.before_delay_nm.push_back(at_joint_nm);
    through_sensors(model, motion, at_joint_nm);
    columns.torque_nm.push_back(std::move(at_joint_nm));
}

}  // namespace

AlwaysOn given_columns(const Case& looked_at, const Model& model, std::span<const GivenTerm> given,
                       const DiagnosisRules& rules) {
    AlwaysOn columns;
    for (const GivenTerm& term : given) {
        for (std::size_t i = 0; i < term.torque_nm.size(); ++i) {
            std::vector<double> torque_nm;
            torque_nm.reserve(looked_at.size());
            for (const std::size_t row : looked_at.row) torque_nm.push_back(term.torque_nm[i][row]);
            add_stated(columns, std::move(torque_nm), model, looked_at.motion);
            columns.mean.push_back(term.mean[i]);
            columns.deviation.push_back(term.deviation[i]);
            columns.bears_load.push_back(term.bears_load);
        }
    }
    columns.given = columns.torque_nm.size();
    const Prediction nothing({model.gear_ratio, {}}, looked_at.motion);
    for (const Mend& mend : mends_of(model, given, rules.beside)) {
        add_stated(columns, nothing.added(mend.term), model, looked_at.motion);
        columns.mean.push_back(0.0);
        columns.deviation.push_back(mend.deviation);
        columns.bears_load.push_back(mend.term.effect->bears_load);
    }
    columns.stated = columns.torque_nm.size();
    return columns;
}

std::vector<std::string> given_names(const Model& model, std::span<const GivenTerm> given) {
    std::vector<std::string> names;
    for (const GivenTerm& term : given) names.insert(names.end(), term.torque_nm.size(), term.name);
    for (const Mend& mend : mends_of(model, given, {})) names.push_back(mend.name);
    return names;
}

AlwaysOn always_on(const Case& looked_at, const Candidate& model, std::span<const GivenTerm> given,
                   const DiagnosisRules& rules) {
    AlwaysOn columns = given_columns(looked_at, model.stated, given, rules);
    const Prediction prediction(model.stated, looked_at.motion);
    if (given.empty())
        add(columns, std::vector<double>(looked_at.size(), 1.0), 0.0, rules.beside.mended_offset_nm);
    const Coordinates coordinates(model.open, &model.stated);
    std::vector<double> point;
    for (const Coordinate& coordinate : coordinates.list()) point.push_back(coordinate.start);
    for (std::size_t c = 0; c < point.size(); ++c)
        add(columns, slope_nm(prediction, coordinates, point, c), 0.0, any_size);
    columns.of_model = columns.torque_nm.size();
    for (const Nuisance& error : motion_errors(looked_at, model.stated, rules.recording))
        add(columns, error.torque_nm, 0.0, error.usual_size > 0.0 ? error.usual_size : any_size);
    return columns;
}

std::vector<double> brought_nm(const AlwaysOn& columns, std::span<const double> values, std::size_t first,
                               std::size_t end) {
    std::vector<double> sum(columns.torque_nm.empty() ? 0 : columns.torque_nm[0].size(), 0.0);
    for (std::size_t i = first; i < end; ++i)
        add_scaled(values[i], columns.torque_nm[i].data(), sum.data(), sum.size());
    return sum;
}

std::vector<double> carried_nm(const AlwaysOn& columns, std::span<const double> values) {
    std::vector<double> sum(columns.torque_nm.empty() ? 0 : columns.torque_nm[0].size(), 0.0);
    for (std::size_t i = 0; i < columns.stated; ++i) {
        if (columns.bears_load[i])
            add_scaled(values[i], columns.at_joint_nm(i).data(), sum.data(), sum.size());
    }
    return sum;
}

}  // namespace ripplenotch
