// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/given_terms.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/matrices/least_squares.hpp"
#include "core/rows/row_facts.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/diagnose/setup.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "verdict/given/simulation_source.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view arm_name = "arm", ripple_name = "ripple",
                           once = "arm: standard input cannot be read twice; give the log as a file";

// The rows of columns that the log still has; both are in order of time and come from one file.
void keep_rows_of(const Log& log, const Log& whole, std::vector<std::vector<double>>& columns) {
    const std::vector<double>& kept_s = log.trace.time_s;
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < whole.trace.size() && rows.size() < kept_s.size(); ++k) {
        if (whole.trace.time_s[k] == kept_s[rows.size()]) rows.push_back(k);
    }
    if (rows.size() != kept_s.size())
        raise<DataError>("arm: {} of {} rows of {} are not among those of all joints",
                         kept_s.size() - rows.size(), kept_s.size(), log.layout.source);
    for (std::vector<double>& column : columns) {
        if (column.empty()) continue;
        std::vector<double> kept;
        kept.reserve(rows.size());
        for (const std::size_t row : rows) kept.push_back(column[row]);
        column = std::move(kept);
    }
}

GivenTerm at_rows_of(const Log& log, const Log& whole, GivenTerm term) {
    keep_rows_of(log, whole, term.torque_nm);
    return term;
}

GivenTerm stated_term(std::string_view name, std::vector<double> torque_nm) {
    return {std::string(name), {std::move(torque_nm)}, {1.0}, {stated_deviation}};
}

// The torque of a map along a log, with that of other motors.
GivenTerm ripple_term(const RippleMap& map, const GivenArm& arm, const ArmReading& reading,
                      std::size_t joint) {
    std::vector<double> torque_nm = map_along(map, reading.logs[joint].trace.view());
    for (const RippleMap& other : map.others) {
        const TraceView motion = reading.logs[reading.find(arm.chain(), other.joint)].trace.view();
        const std::vector<double> other_nm = map_along(other, motion);
        add_scaled(1.0, other_nm.data(), torque_nm.data(), other_nm.size());
    }
    return stated_term(ripple_name, std::move(torque_nm));
}

// Whether anything of a map is to be subtracted.
bool holds_ripple(const MapFit& fit) {
    return fit.doubt.empty() && (!fit.map.orders.empty() || !fit.map.others.empty());
}

// The terms of an arm along one log, its torque and that of the ripple; and the motion of its joints.
void add_arm_terms(std::vector<GivenTerm>& terms, std::vector<std::vector<double>>& others_deg_s,
                   GivenArm& arm, const GivenTerms& stated, const ArmReading& reading, const Log& log,
                   std::size_t joint) {
    const Log& whole = reading.logs[joint];
    others_deg_s = arm.others_deg_s(joint, reading);
    keep_rows_of(log, whole, others_deg_s);
    const std::optional<ArmValues>& values = stated.arm->values;
    GivenTerm term = values
                         ? stated_term(arm_name, stated_torque(arm.chain(), *values, *stated.arm->smoothing,
                                                               reading.view(), joint))
                         : arm.term(joint, reading);
    terms.push_back(at_rows_of(log, whole, std::move(term)));
    if (!stated.ripple) return;
    terms.push_back(at_rows_of(log, whole, ripple_term(stated.ripple->map, arm, reading, joint)));
}

ArmSource option_of(const StatedArm& arm) { return {arm.chain, arm.stated_joints(), "of the model"}; }

}  // namespace

std::shared_ptr<GivenArm> GivenSource::arm(const ReadOptions& reading, const std::string& path,
                                           std::size_t most_rows) {
    if (path == "-") raise<UsageError>("{}", once);
    std::shared_ptr<GivenArm>& arm = arms_[most_rows];
    if (!arm)
        arm = std::make_shared<GivenArm>(read_arm_source(*options_.arm), path, reading, std::nullopt,
                                         most_rows);
    return arm;
}

GivenTerms GivenSource::read(const ModelWithGiven& stated, const ReadOptions& reading, const GivenLog& log,
                             const GivenLog* validation) {
    if (options_.arm && stated.arm) raise<UsageError>("--arm: the model states it already; change it there");
    GivenTerms terms;
    if (options_.simulated || stated.simulated) add_simulated(terms, stated, reading, log, validation);
    if (options_.arm || stated.arm) add_arm(terms, stated, reading, log, validation);
    return terms;
}

namespace {

// The other joints of the log, of one of which the simulation may be.
std::vector<Log> other_joints(const ReadOptions& reading, const GivenLog& log) {
    constexpr std::size_t max_joints = 12;  // of an arm; a file of more is no log of one
    std::vector<Log> others;
    if (log.path == "-") return others;
    ReadOptions words = reading;
    words.joint.reset();
    words.every_joint = true;
    const std::vector<std::string> joints = open_log(log.path, words)->layout().joints;
    words.every_joint = false;
    if (joints.size() > max_joints) return others;
    for (const std::string& joint : joints) {
        if (joint == log.log.trace.joint) continue;
        words.joint = joint;
        others.push_back(read_log(log.path, words));
    }
    return others;
}

}  // namespace

void GivenSource::check_setup(GivenTerms& terms, SimulationSource& simulated, const ModelWithGiven& stated,
                              const ReadOptions& reading, const GivenLog& log) {
    if (simulated.states_delay()) return;
    SetupContext context = simulated.names();
    if (stated.model.has_gear_ratio()) context.gear_ratio = stated.model.gear_ratio;
    context.joint = log.log.trace.joint;
    SimulatedMotion motion = simulated.read_motion(reading, log.path, log.log);
    context.torque_scale = simulated.term().scale.value_or(1.0);
    for (double& nm : motion.torque_nm) nm *= context.torque_scale;
    terms.setup = suspect_setup(log.log.trace.view(), motion, context);
    // Whether it is another joint's is asked where it does not fit this one.
    if (!terms.setup->faults.empty() || terms.setup->lag() == nullptr) {
        const std::vector<Log> others = other_joints(reading, log);
        for (const Log& other : others) context.others.push_back({other.trace.joint, other.trace.view()});
        if (!others.empty()) terms.setup = suspect_setup(log.log.trace.view(), motion, context);
    }
    if (terms.setup->shift) simulated.set_delay(-terms.setup->shift->delay_s);
}

void GivenSource::add_simulated(GivenTerms& terms, const ModelWithGiven& stated, const ReadOptions& reading,
                                const GivenLog& log, const GivenLog* validation) {
    SimulationSource simulated =
        options_.simulated
            ? SimulationSource(with_joint(*options_.simulated, log.log.trace.joint), stated.simulated)
            : SimulationSource(*stated.simulated);
    if (checks_setup_) check_setup(terms, simulated, stated, reading, log);
    terms.simulated = simulated.term();
    if (simulated.file()) terms.files.push_back(*simulated.file());
    terms.log.push_back(simulated.read(reading, log.path, log.log));
    if (checks_setup_) {
        const SimulatedMotion own = simulated.read_motion_at(reading, log.path, log.log);
        terms.simulated_velocity_deg_s = own.velocity_deg_s;
        terms.simulated_position_deg = own.position_deg;
    }
    if (validation == nullptr) return;
    terms.validation.push_back(simulated.read_validation(reading, validation->path, validation->log));
}

void GivenSource::add_arm(GivenTerms& terms, const ModelWithGiven& stated, const ReadOptions& reading,
                          const GivenLog& log, const GivenLog* validation) {
    if (log.path == "-") raise<UsageError>("{}", once);
    const auto given = options_.arm ? arm(reading, log.path, log.most_rows)
                                    : std::make_shared<GivenArm>(option_of(*stated.arm), log.path, reading,
                                                                 stated.arm->smoothing, log.most_rows);
    const std::size_t joint = given->find(log.log.trace.joint);
    terms.arm = stated.arm ? *stated.arm : StatedArm{given->chain(), {}, {}};
    if (stated.arm && given->chain().joints[joint].name != stated.arm->joint)
        raise<UsageError>("--joint {}: the arm of the model is for its joint '{}'", log.log.trace.joint,
                          stated.arm->joint);
    terms.arm->joint = given->chain().joints[joint].name;
    terms.arm->log_joints = given->reading().names;
    terms.ripple = stated.ripple;
    if (!terms.arm->values) terms.fitted_arm = given;
    if (given->file()) terms.files.push_back(*given->file());
    if (terms.arm->values && !terms.arm->smoothing) terms.arm->smoothing = default_smoothing;
    terms.account =
        terms.arm->values ? given->stated_account(joint, *terms.arm->smoothing) : given->account(joint);
    if (checks_setup_ && !terms.arm->values) {
        if (!terms.setup) terms.setup.emplace();
        const auto& faults = given->setup_faults(joint);
        terms.setup->faults.insert(terms.setup->faults.begin(), faults.begin(), faults.end());
        const bool states_ripple = std::ranges::any_of(
            stated.model.terms, [](const Term& term) { return term.effect->ripple_order.has_value(); });
        if (options_.finds_ripple && faults.empty() && !states_ripple && stated.model.has_gear_ratio()) {
            terms.ripple = given->ripple(joint, stated.model.gear_ratio);
            terms.account->ripple = map_verdict(*terms.ripple);
            if (!holds_ripple(*terms.ripple)) terms.ripple.reset();
        }
    }
    add_arm_terms(terms.log, terms.others_deg_s, *given, terms, given->reading(), log.log, joint);
    if (validation == nullptr) return;
    add_arm_terms(terms.validation, terms.validation_others_deg_s, *given, terms,
                  given->other(validation->path, reading), validation->log, joint);
}

namespace {

// The sum of terms with their values as given, a number a row: torque at the joint, before any sensor. Empty
// without terms.
std::vector<double> known_torque_nm(const std::vector<GivenTerm>& terms, std::size_t rows) {
    std::vector<double> sum(terms.empty() ? 0 : rows, 0.0);
    for (const GivenTerm& term : terms) {
        for (std::size_t c = 0; c < term.torque_nm.size(); ++c)
            add_scaled(term.mean[c], term.torque_nm[c].data(), sum.data(), rows);
    }
    return sum;
}

}  // namespace

void take_joint_of(const ModelWithGiven& model, std::optional<std::string>& joint) {
    if (!model.arm || joint) return;
    const auto place = model.arm->chain.find(model.arm->joint);
    joint = model.arm->log_joints[*place];
}

namespace {

// What a diagnosis found of the given terms, as a part of the improved model.

std::vector<double> values_named(const Diagnosis& diagnosis, std::string_view name) {
    std::vector<double> values;
    for (const GivenValue& given : diagnosis.given) {
        if (given.name == name) values.push_back(given.value);
    }
    return values;
}

// A scale that nothing has shown to be another is 1; one that was found is an effect of the model.
SimulatedTerm fitted(SimulatedTerm simulated) {
    simulated.scale = simulated.scale.value_or(1.0);
    return simulated;
}

StatedArm fitted(const GivenTerms& given, const Diagnosis& diagnosis) {
    StatedArm arm = *given.arm;
    if (!given.fitted_arm) return arm;
    GivenArm& found = *given.fitted_arm;
    const std::size_t joint = *arm.chain.find(arm.joint);
    const ArmFit& fit = found.fit(joint);
    ArmValues values = arm_values(found.chain(), fit, joint, values_named(diagnosis, "arm"));
    for (double& value : values.links) value = to_digits(value);
    values.rotor_inertia_kgm2 = to_digits(values.rotor_inertia_kgm2);
    arm.values = std::move(values);
    arm.smoothing = fit.smoothing;
    return arm;
}

// What was fitted has no more digits in the model than in the story and its JSON.
Model with_fitted_digits(Model model) {
    for (Term& term : model.terms) {
        for (std::optional<double>& value : term.values) {
            if (value) value = to_digits(*value);
        }
    }
    return model;
}

}  // namespace

ModelWithGiven improved_model(const GivenTerms& given, const Diagnosis& diagnosis) {
    ModelWithGiven model{with_fitted_digits(diagnosis.model)};
    if (given.simulated) model.simulated = fitted(*given.simulated);
    if (given.arm) model.arm = fitted(given, diagnosis);
    model.ripple = given.ripple;
    return model;
}

KnownAlong stated_along(const GivenOptions& options, const ModelWithGiven& model, const ReadOptions& reading,
                        const GivenLog& log) {
    if (!options.any() && !model.any_given()) return {};
    GivenSource source(options);
    GivenTerms given = source.read(model, reading, log, nullptr);
    if (given.fitted_arm)
        raise<UsageError>(
            "the model does not state arm.links; give the value, or fit it to a log first: diagnose "
            "--improved-model");
    return {known_torque_nm(given.log, log.log.trace.size()), std::move(given.others_deg_s)};
}

namespace {

// The scale that leaves least of the log's torque beside an offset, where it is not stated. What is in the
// torque besides may move it a little.
void settle_simulation(std::vector<GivenTerm>& terms, const Trace& log) {
    for (GivenTerm& term : terms) {
        if (term.name != "simulated") continue;
        if (term.deviation[0] == stated_deviation) continue;
        const std::vector<double> offset(log.size(), 1.0);
        term.mean[0] = least_squares({term.torque_nm[0], offset}, log.torque_nm)[0];
    }
}

ModelWithGiven residual_model(const ResidualOptions& residual, const std::string& joint) {
    // Without a model nothing depends on its ratio.
    if (!residual.model) return {{GearRatio(1.0), {}}};
    const std::string path = with_joint(*residual.model, joint);
    return read_model_with_given(read_all(path), input_name(path));
}

std::vector<double> predicted_torque(const ResidualOptions& residual, const ModelWithGiven& model,
                                     const ReadOptions& reading, const GivenLog& log) {
    GivenOptions options;
    if (residual.simulated) options.simulated = with_joint(*residual.simulated, log.log.trace.joint);
    std::vector<GivenTerm> terms;
    std::vector<std::vector<double>> others_deg_s;
    if (options.any() || model.any_given()) {
        GivenTerms given = GivenSource(options).read(model, reading, log, nullptr);
        if (given.fitted_arm)
            raise<UsageError>(
                "--residual {}: the model does not state arm.links; diagnose --improved-model writes them",
                *residual.model);
        settle_simulation(given.log, log.log.trace);
        terms = std::move(given.log);
        others_deg_s = std::move(given.others_deg_s);
    }
    Motion motion = motion_along(log.log.trace.view(), default_smoothing);
    motion.known_nm = known_torque_nm(terms, log.log.trace.size());
    motion.others_deg_s = std::move(others_deg_s);
    return predict_nm(model.model, motion);
}

}  // namespace

Residual subtract_predicted(const ResidualOptions& residual, ReadOptions reading, std::size_t logs,
                            const GivenLog& log) {
    if (logs > 1 && residual.simulated && residual.simulated->starts_with("log,"))
        raise<UsageError>("--simulated log,...: it is the simulation of one log, and there are {}", logs);
    if (!log.log.trace.joint.empty()) reading.joint = log.log.trace.joint;
    const ModelWithGiven model = residual_model(residual, log.log.trace.joint);
    const std::vector<double> predicted = predicted_torque(residual, model, reading, log);
    std::vector<double>& torque_nm = log.log.trace.torque_nm;
    Residual left{rms(torque_nm), 0.0, {}};
    for (std::size_t k = 0; k < torque_nm.size(); ++k) torque_nm[k] -= predicted[k];
    left.after_nm = rms(torque_nm);
    if (residual.model && *residual.model != "-")
        left.model = with_joint(*residual.model, log.log.trace.joint);
    return left;
}

void take_joint_of(const ResidualOptions& residual, std::optional<std::string>& joint) {
    if (!residual.model || joint || *residual.model == "-" || names_joint(*residual.model)) return;
    take_joint_of(read_model_with_given(read_all(*residual.model), *residual.model), joint);
}

}  // namespace ripplenotch
