// SPDX-License-Identifier: MIT
#include "cli/diagnose/given_terms.hpp"

#include "cli/options/simulated_option.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

void attach_given(Options& options, GivenOptions& given) {
    options.text(
        "--simulated", given.simulated, "SPEC",
        "torque of your own simulation, beside which is searched: a column of the log, "
        "column,name=tau_model, or of another file, log,file=sim.csv,column=torque; scale=1 keeps it "
        "as it is, delay=2ms or delay=fit says how much later it is");
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
    return terms;
}

}  // namespace ripplenotch
