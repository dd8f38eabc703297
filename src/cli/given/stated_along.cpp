// SPDX-License-Identifier: MIT
#include "cli/given/stated_along.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

GivenTorque stated_torque_along(const GivenOptions& options, const ModelWithGiven& model,
                                const ReadOptions& reading, const GivenLog& log, Seconds smoothing) {
    if (!options.any() && !model.any_given()) return {};
    GivenSource source(options, smoothing);
    const GivenTerms given = source.read(model, reading, log, nullptr);
    const auto open = given.open();
    if (!open.empty())
        raise<UsageError>(
            "the model does not state {}; give the value, or fit it to a log first: diagnose -o",
            fmt::join(open, ", "));
    return given_torque(given.log, log.log.trace.size());
}

void settle_simulation(std::vector<GivenTerm>& terms, const Trace& log) {
    for (GivenTerm& term : terms) {
        if (term.name != "simulated") continue;
        // A scale that is stated stays as it is; a delay is open when there is a second column.
        std::vector<std::size_t> open;
        if (term.deviation[0] != stated_deviation) open.push_back(0);
        if (term.torque_nm.size() > 1) open.push_back(1);
        if (open.empty()) continue;
        std::vector<double> target = log.torque_nm;
        if (open[0] != 0) add_scaled(-term.mean[0], term.torque_nm[0].data(), target.data(), target.size());
        std::vector<std::vector<double>> columns;
        for (const std::size_t i : open) columns.push_back(term.torque_nm[i]);
        columns.emplace_back(target.size(), 1.0);  // the offset
        const std::vector<double> found = least_squares(columns, target);
        for (std::size_t i = 0; i < open.size(); ++i) term.mean[open[i]] = found[i];
    }
}

}  // namespace ripplenotch
