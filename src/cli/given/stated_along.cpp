// SPDX-License-Identifier: MIT
#include "cli/given/stated_along.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

// Least squares of a few columns.
class NormalEquations {
  public:
    explicit NormalEquations(std::size_t values)
        : rows_(values, std::vector<double>(values + 1, 0.0)) {}  // the last column: the right side

    void add(const std::vector<double>& row, double value) {
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            for (std::size_t j = 0; j < rows_.size(); ++j) rows_[i][j] += row[i] * row[j];
            rows_[i].back() += row[i] * value;
        }
    }
    // By elimination: the matrix is positive definite unless a column is constant or 0; such a value is 0.
    [[nodiscard]] std::vector<double> solved() const {
        auto m = rows_;
        const std::size_t n = m.size();
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t below = i + 1; below < n && m[i][i] > 0.0; ++below) {
                const double factor = m[below][i] / m[i][i];
                for (std::size_t c = i; c <= n; ++c) m[below][c] -= factor * m[i][c];
            }
        }
        std::vector<double> x(n, 0.0);
        for (std::size_t i = n; i-- > 0;) {
            double side = m[i][n];
            for (std::size_t c = i + 1; c < n; ++c) side -= m[i][c] * x[c];
            x[i] = m[i][i] > 0.0 ? side / m[i][i] : 0.0;
        }
        return x;
    }

  private:
    std::vector<std::vector<double>> rows_;
};

}  // namespace

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
        const bool open_scale = term.deviation[0] != stated_deviation;
        std::vector<std::size_t> open;
        if (open_scale) open.push_back(0);
        if (term.torque_nm.size() > 1) open.push_back(1);
        if (open.empty()) continue;
        NormalEquations equations(open.size() + 1);
        std::vector<double> row(open.size() + 1, 1.0);  // the last is the offset
        for (std::size_t k = 0; k < log.size(); ++k) {
            for (std::size_t i = 0; i < open.size(); ++i) row[i] = term.torque_nm[open[i]][k];
            const double kept_nm = open_scale ? 0.0 : term.mean[0] * term.torque_nm[0][k];
            equations.add(row, log.torque_nm[k] - kept_nm);
        }
        const std::vector<double> found = equations.solved();
        for (std::size_t i = 0; i < open.size(); ++i) term.mean[open[i]] = found[i];
    }
}

}  // namespace ripplenotch
