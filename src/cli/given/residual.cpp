// SPDX-License-Identifier: MIT
#include "cli/given/residual.hpp"

#include <fmt/format.h>

#include "cli/gear/chosen_method.hpp"
#include "cli/given/stated_along.hpp"
#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

ModelWithGiven residual_model(const ResidualOptions& residual, const std::string& joint) {
    // Without a model nothing depends on its ratio.
    if (!residual.model) return {{GearRatio(1.0), {}}};
    const std::string path = with_joint(*residual.model, joint);
    return read_model_with_given(read_all(path), path == "-" ? "standard input" : path);
}

std::vector<double> predicted_torque(const ResidualOptions& residual, const ModelWithGiven& model,
                                     const ReadOptions& reading, const GivenLog& log) {
    GivenOptions options;
    if (residual.simulated) options.simulated = with_joint(*residual.simulated, log.log.trace.joint);
    std::vector<GivenTerm> terms;
    if (options.any() || model.any_given()) {
        GivenTerms given = GivenSource(options).read(model, reading, log, nullptr);
        if (given.fitted_arm)
            raise<UsageError>("--residual {}: the model does not state arm.links; diagnose -o writes them",
                              *residual.model);
        settle_simulation(given.log, log.log.trace);
        terms = std::move(given.log);
    }
    Motion motion = motion_along(log.log.trace.view(), default_smoothing);
    motion.known_nm = known_torque_nm(terms, log.log.trace.size());
    return predict_nm(model.model, motion);
}

}  // namespace

void attach_residual(Options& options, ResidualOptions& residual) {
    options.text("--residual", residual.model, "FILE",
                 "look into measured less predicted torque: of this model.json, along the log");
    options.text("--simulated", residual.simulated, "SPEC",
                 "the same of your own simulation: tau_model (a column) or log,file=sim.csv,column=torque; "
                 "its scale is fitted unless scale=1 keeps it");
}

void take_residual(const ResidualOptions& residual, ReadOptions reading, std::size_t logs,
                   const GivenLog& log, const CommonOptions& common, Provenance& provenance) {
    if (!residual.any()) return;
    if (logs > 1 && residual.simulated && residual.simulated->starts_with("log,"))
        raise<UsageError>("--simulated log,...: it is the simulation of one log, and there are {}", logs);
    if (!log.log.trace.joint.empty()) reading.joint = log.log.trace.joint;
    const ModelWithGiven model = residual_model(residual, log.log.trace.joint);
    if (residual.model && *residual.model != "-")
        provenance.inputs.push_back(input_record(with_joint(*residual.model, log.log.trace.joint)));
    const std::vector<double> predicted = predicted_torque(residual, model, reading, log);
    std::vector<double>& torque_nm = log.log.trace.torque_nm;
    const double before_nm = rms(torque_nm);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) torque_nm[k] -= predicted[k];
    say(common, fmt::format("{}: {:.4g} Nm rms of torque, {:.4g} less what is predicted", log.path, before_nm,
                            rms(torque_nm)));
}

void take_joint_of(const ResidualOptions& residual, std::optional<std::string>& joint) {
    if (!residual.model || joint || *residual.model == "-" || names_joint(*residual.model)) return;
    take_joint_of(read_model_with_given(read_all(*residual.model), *residual.model), joint);
}

}  // namespace ripplenotch
