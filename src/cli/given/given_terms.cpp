// SPDX-License-Identifier: MIT
#include "cli/given/given_terms.hpp"

#include <algorithm>
#include <cmath>

#include "cli/gear/chosen_method.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view arm_name = "arm", nuisance_name = "nuisance",
                           once = "arm: standard input cannot be read twice; give the log as a file";

// The term's rows that the log still has; both are in order of time and come from one file.
GivenTerm at_rows_of(const Log& log, const Log& whole, GivenTerm term) {
    const std::vector<double>& kept_s = log.trace.time_s;
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < whole.trace.size() && rows.size() < kept_s.size(); ++k) {
        if (whole.trace.time_s[k] == kept_s[rows.size()]) rows.push_back(k);
    }
    if (rows.size() != kept_s.size())
        raise<DataError>("arm: {} of {} rows of {} are not among those of all joints",
                         kept_s.size() - rows.size(), kept_s.size(), log.layout.source);
    for (std::vector<double>& column : term.torque_nm) {
        std::vector<double> kept;
        kept.reserve(rows.size());
        for (const std::size_t row : rows) kept.push_back(column[row]);
        column = std::move(kept);
    }
    return term;
}

GivenTerm stated_term(std::string_view name, std::vector<double> torque_nm) {
    return {std::string(name), {std::move(torque_nm)}, {1.0}, {stated_deviation}};
}

// The terms of an arm along one log: its torque, and what is stated beside it.
void add_arm_terms(std::vector<GivenTerm>& terms, GivenArm& arm, const StatedArm& stated,
                   const ArmReading& reading, const Log& log, std::size_t joint) {
    const Log& whole = reading.logs[joint];
    GivenTerm term = stated.values
                         ? stated_term(arm_name, stated_torque(arm.chain(), *stated.values, *stated.smoothing,
                                                               reading.view(), joint))
                         : arm.term(joint, reading);
    terms.push_back(at_rows_of(log, whole, std::move(term)));
    if (!stated.nuisance.any()) return;
    auto beside_nm = nuisance_torque(arm.chain(), stated.nuisance, whole.trace.view(), joint);
    terms.push_back(at_rows_of(log, whole, stated_term(nuisance_name, std::move(beside_nm))));
}

ArmOption option_of(const StatedArm& arm) { return {arm.chain, arm.stated_joints(), "of the model"}; }

}  // namespace

void attach_given(Options& options, GivenOptions& given) {
    options.text("--simulated", given.simulated, "SPEC", simulated_option_help);
    options.text("--arm", given.arm, "SPEC", std::string(arm_option_help));
}

std::vector<std::string> GivenTerms::open() const {
    std::vector<std::string> names;
    if (fitted_arm) names.emplace_back("arm.links");
    return names;
}

std::shared_ptr<GivenArm> GivenSource::arm(const ReadOptions& reading, const std::string& path,
                                           std::size_t most_rows) {
    if (path == "-") raise<UsageError>("{}", once);
    std::shared_ptr<GivenArm>& arm = arms_[most_rows];
    if (!arm)
        arm = std::make_shared<GivenArm>(read_arm_option(*options_.arm), path, reading, std::nullopt,
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
    constexpr std::size_t most_joints = 12;  // of an arm; a file of more is no log of one
    std::vector<Log> others;
    if (log.path == "-") return others;
    ReadOptions words = reading;
    words.joint.reset();
    words.every_joint = true;
    const std::vector<std::string> joints = open_log(log.path, words)->layout().joints;
    words.every_joint = false;
    if (joints.size() > most_joints) return others;
    for (const std::string& joint : joints) {
        if (joint == log.log.trace.joint) continue;
        words.joint = joint;
        others.push_back(read_log(log.path, words));
    }
    return others;
}

// Whether the delay differs from 0 by more than its interval and half a sample.
bool is_behind(const SimulationLag& lag, const Trace& log) {
    const double half_sample_s = 0.5 / log.sample_rate.value();
    return std::abs(lag.delay_s) > half_sample_s && (lag.delay_95_s.low > 0.0 || lag.delay_95_s.high < 0.0);
}

}  // namespace

void GivenSource::check_setup(GivenTerms& terms, SimulatedOption& simulated, const ModelWithGiven& stated,
                              const ReadOptions& reading, const GivenLog& log) {
    if (simulated.states_delay()) return;
    SetupContext context = simulated.names();
    context.gear_ratio = stated.model.gear_ratio;
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
    const std::optional<SimulationLag>& by_motion = terms.setup->motion_lag;
    if (by_motion && by_motion->identifiable && is_behind(*by_motion, log.log.trace))
        simulated.set_delay(-by_motion->delay_s);
    else
        terms.setup->motion_lag.reset();
}

void GivenSource::add_simulated(GivenTerms& terms, const ModelWithGiven& stated, const ReadOptions& reading,
                                const GivenLog& log, const GivenLog* validation) {
    SimulatedOption simulated =
        options_.simulated
            ? SimulatedOption(with_joint(*options_.simulated, log.log.trace.joint), stated.simulated)
            : SimulatedOption(*stated.simulated);
    if (checks_setup_) check_setup(terms, simulated, stated, reading, log);
    terms.simulated = simulated.term();
    if (simulated.file()) terms.files.push_back(*simulated.file());
    terms.log.push_back(simulated.read(reading, log.path, log.log));
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
    if (!terms.arm->values) terms.fitted_arm = given;
    if (given->file()) terms.files.push_back(*given->file());
    if (terms.arm->values && !terms.arm->smoothing) terms.arm->smoothing = default_smoothing;
    terms.account =
        terms.arm->values ? given->stated_account(joint, *terms.arm->smoothing) : given->account(joint);
    if (checks_setup_ && !terms.arm->values) {
        if (!terms.setup) terms.setup.emplace();
        const auto& faults = given->setup_faults(joint);
        terms.setup->faults.insert(terms.setup->faults.begin(), faults.begin(), faults.end());
    }
    add_arm_terms(terms.log, *given, *terms.arm, given->reading(), log.log, joint);
    if (validation == nullptr) return;
    add_arm_terms(terms.validation, *given, *terms.arm, given->other(validation->path, reading),
                  validation->log, joint);
}

std::vector<double> known_torque_nm(const std::vector<GivenTerm>& terms, std::size_t rows) {
    std::vector<double> sum(terms.empty() ? 0 : rows, 0.0);
    for (const GivenTerm& term : terms) {
        for (std::size_t c = 0; c < term.torque_nm.size(); ++c)
            add_scaled(term.mean[c], term.torque_nm[c].data(), sum.data(), rows);
    }
    return sum;
}

void take_joint_of(const ModelWithGiven& model, std::optional<std::string>& joint) {
    if (!model.arm || joint) return;
    const auto place = model.arm->chain.find(model.arm->joint);
    joint = model.arm->log_joints[*place];
}

}  // namespace ripplenotch
