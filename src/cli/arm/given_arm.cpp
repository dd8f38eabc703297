// SPDX-License-Identifier: MIT
#include "cli/arm/given_arm.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace ripplenotch {
namespace {

double deviation(std::span<const double> values) {
    double mean = 0.0, squares = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    for (const double value : values) squares += (value - mean) * (value - mean);
    return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

GivenArm::GivenArm(ArmOption option, const std::string& path, const ReadOptions& options,
                   std::optional<Seconds> smoothing, std::size_t most_rows)
    : option_(std::move(option)),
      smoothing_(smoothing),
      most_rows_(most_rows),
      reading_(read_arm(path, options, most_rows, option_.chain, option_.stated)),
      travel_(arm_travel(option_.chain, reading_.view(), reading_.names)) {}

const ArmReading& GivenArm::other(const std::string& path, const ReadOptions& options) {
    const auto known = others_.find(path);
    if (known != others_.end()) return known->second;
    ArmReading other = read_arm(path, options, most_rows_, option_.chain, option_.stated);
    (void)arm_travel(option_.chain, other.view(), other.names);
    return others_.emplace(path, std::move(other)).first->second;
}

const ArmFit& GivenArm::fit(std::size_t joint, const std::vector<bool>& use) {
    const bool alone = chain().lengths_are_guessed;
    const auto made = fits_.find(alone ? joint : 0);
    if (made != fits_.end()) return made->second;
    ArmFitOptions options;
    options.use = use;
    options.smoothing = smoothing_;
    if (alone) options.joints = {joint};
    return fits_.emplace(alone ? joint : 0, fit_arm(chain(), reading_.view(), options)).first->second;
}

const std::vector<SetupFault>& GivenArm::setup_faults(std::size_t joint) {
    const bool alone = chain().lengths_are_guessed;
    const auto known = faults_.find(alone ? joint : 0);
    if (known != faults_.end()) return known->second;
    ArmFitOptions options;
    if (alone) options.joints = {joint};
    return faults_
        .emplace(alone ? joint : 0, suspect_arm(chain(), reading_.view(), fit(joint), options))
        .first->second;
}

GivenTerm GivenArm::term(std::size_t joint, const ArmReading& log) {
    const ArmFit& found = fit(joint);
    const ArmLog view = log.view();
    std::vector<Motion>& motions = motions_[{&log, found.smoothing.value()}];
    if (motions.empty()) motions = arm_motions(view, found.smoothing);
    return arm_term(chain(), found, view, joint, ArmKnowledge::other_joints, {}, motions);
}

ArmAccount GivenArm::stated_account(std::size_t joint, Seconds smoothing) const {
    ArmAccount account;
    account.source = chain().source;
    account.rule = reading_.match.rule;
    account.option = reading_.match.option;
    account.joints = travel_;
    account.values_are_stated = true;
    account.lengths_are_guessed = chain().lengths_are_guessed;
    account.smoothing = smoothing;
    account.gap_before_nm = deviation(reading_.logs[joint].trace.torque_nm);
    account.warnings = reading_.match.warnings;
    account.notes = reading_.match.notes;
    return account;
}

ArmAccount GivenArm::account(std::size_t joint) {
    const ArmFit& found = fit(joint);
    ArmAccount account = stated_account(joint, found.smoothing);
    account.values_are_stated = false;
    account.values_there = found.values_there;
    account.values_told = found.values_told;
    account.all_joints_at_once = found.joints.size() > 1;
    account.pull = found.pull;
    if (const ArmJointFit* const own = found.find(joint)) account.gap_nm = own->error_nm;
    for (std::string& warning : arm_warnings(found, travel_)) account.warnings.push_back(std::move(warning));
    return account;
}

std::string arm_text(const ArmAccount& account) {
    if (account.values_are_stated)
        return fmt::format(
            "arm: {} joints of {} matched {} (-v shows them); its values are the model's, motion smoothed "
            "over "
            "{:g} s\n",
            account.joints.size(), account.source, account.rule, account.smoothing.value());
    return fmt::format(
        "arm: {} joints of {} matched {} (-v shows them); {} of {} combinations of its masses told by this "
        "log, {}, motion smoothed over {:g} s{}\n  {:.3g} -> {:.3g} Nm rms with friction beside it, on "
        "fifths "
        "of the log left out\n",
        account.joints.size(), account.source, account.rule, account.values_told, account.values_there,
        account.all_joints_at_once ? "all joints fitted at once" : "this joint fitted alone",
        account.smoothing.value(), account.lengths_are_guessed ? ", lengths of its links guessed" : "",
        account.gap_before_nm, account.gap_nm);
}

}  // namespace ripplenotch
