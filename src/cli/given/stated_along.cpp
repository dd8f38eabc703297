// SPDX-License-Identifier: MIT
#include "cli/given/stated_along.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::vector<double> stated_torque_along(const GivenOptions& options, const ModelWithGiven& model,
                                        const ReadOptions& reading, const GivenLog& log) {
    if (!options.any() && !model.any_given()) return {};
    GivenSource source(options);
    const GivenTerms given = source.read(model, reading, log, nullptr);
    const auto open = given.open();
    if (!open.empty())
        raise<UsageError>(
            "the model does not state {}; give the value, or fit it to a log first: diagnose -o",
            fmt::join(open, ", "));
    return known_torque_nm(given.log, log.log.trace.size());
}

void settle_simulation(std::vector<GivenTerm>& terms, const Trace& log) {
    for (GivenTerm& term : terms) {
        if (term.name != "simulated") continue;
        if (term.deviation[0] == stated_deviation) continue;
        const std::vector<double> offset(log.size(), 1.0);
        term.mean[0] = least_squares({term.torque_nm[0], offset}, log.torque_nm)[0];
    }
}

}  // namespace ripplenotch
