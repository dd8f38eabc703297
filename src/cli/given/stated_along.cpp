// SPDX-License-Identifier: MIT
#include "cli/given/stated_along.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/linear_algebra.hpp"
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
    using Eigen::Index;
    for (GivenTerm& term : terms) {
        const std::size_t columns = term.torque_nm.size();
        if (term.name != "simulated" || (columns == 1 && term.deviation[0] == stated_deviation)) continue;
        const auto values = static_cast<Index>(columns + 1);
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(values, values);
        Eigen::VectorXd side = Eigen::VectorXd::Zero(values), row(values);
        for (std::size_t k = 0; k < log.size(); ++k) {
            for (std::size_t c = 0; c < columns; ++c) row[static_cast<Index>(c)] = term.torque_nm[c][k];
            row[values - 1] = 1.0;
            matrix += row * row.transpose();
            side += log.torque_nm[k] * row;
        }
        // A scale that is stated stays as it is.
        if (term.deviation[0] == stated_deviation) {
            side -= term.mean[0] * matrix.col(0);
            matrix.row(0).setZero();
            matrix.col(0).setZero();
            matrix(0, 0) = 1.0;
            side[0] = term.mean[0];
        }
        const Eigen::VectorXd found = Eigen::LLT<Eigen::MatrixXd>(matrix).solve(side);
        for (std::size_t c = 0; c < columns; ++c) term.mean[c] = found[static_cast<Index>(c)];
    }
}

}  // namespace ripplenotch
