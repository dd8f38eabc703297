// SPDX-License-Identifier: MIT
#include "cli/diagnose/given_terms.hpp"

#include <cmath>

#include "cli/arm/given_arm.hpp"
#include "cli/options/simulated_option.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

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

void add_arm(GivenTerms& terms, const std::string& words, const ReadOptions& reading, const GivenLog& log,
             const GivenLog* validation) {
    if (log.path == "-")
        raise<UsageError>("--arm: standard input cannot be read twice; give the log as a file");
    GivenArm arm(read_arm_option(words), log.path, reading);
    const std::size_t joint = arm.find(log.log.trace.joint);
    terms.log.push_back(at_rows_of(log.log, arm.reading().logs[joint], arm.term(joint, arm.reading())));
    terms.arm = arm.account(joint);
    if (validation == nullptr) return;
    const ArmReading other = arm.read_other(validation->path, reading);
    terms.validation.push_back(at_rows_of(validation->log, other.logs[joint], arm.term(joint, other)));
}

}  // namespace

void attach_given(Options& options, GivenOptions& given) {
    options.text(
        "--simulated", given.simulated, "SPEC",
        "torque of your own simulation, beside which is searched: a column of the log, "
        "column,name=tau_model, or of another file, log,file=sim.csv,column=torque; scale=1 keeps it "
        "as it is, delay=2ms or delay=fit says how much later it is");
    options.text("--arm", given.arm, "SPEC", std::string(arm_option_help));
}

GivenTerms read_given(const GivenOptions& options, const std::optional<SimulatedTerm>& stated,
                      const ReadOptions& reading, const GivenLog& log, const GivenLog* validation) {
    if (options.simulated && stated)
        raise<UsageError>("--simulated: the model states it already; change it there");
    GivenTerms terms;
    if (options.simulated || stated) {
        const SimulatedOption simulated =
            stated ? SimulatedOption(*stated) : SimulatedOption(*options.simulated);
        terms.log.push_back(simulated.read(reading, log.path, log.log));
        if (validation != nullptr)
            terms.validation.push_back(simulated.read_validation(reading, validation->path, validation->log));
        terms.simulated = simulated.term();
    }
    if (options.arm) add_arm(terms, *options.arm, reading, log, validation);
    return terms;
}

}  // namespace ripplenotch
