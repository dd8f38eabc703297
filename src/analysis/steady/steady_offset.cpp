// SPDX-License-Identifier: MIT
#include "analysis/steady/steady_offset.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/lines/excess_scatter.hpp"
#include "analysis/steady/likely_offset.hpp"
#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

/// NormalEquations of one least squares: a sighting each, whitened with what its stretch's sightings share.
struct NormalEquations {
    Eigen::MatrixXd normal;
    Eigen::VectorXd right;
    double squares = 0.0;
};

struct OffsetRow {
    std::size_t line = 0, stretch = 0;
    double log_order = 0.0, per_deg_s = 0.0, error = 0.0, shared = 0.0;
};

std::vector<OffsetRow> offset_rows(std::span<const SteadyLine> lines) {
    std::vector<OffsetRow> rows;
    std::size_t count = 0;
    for (const SteadyLine& line : lines) {
        if (line.kind != LineKind::order) continue;
        for (const Sighting& seen : line.sightings)
            rows.push_back({count, seen.stretch, portable::log(seen.order_output()),
                            seen.by_velocity ? -1.0 / seen.speed_deg_s : 0.0,
                            std::max(seen.hz_error / seen.hz, 1e-7), seen.speed_share_error});
        ++count;
    }
    std::stable_sort(rows.begin(), rows.end(),
                     [](const OffsetRow& a, const OffsetRow& b) { return a.stretch < b.stretch; });
    return rows;
}

/// Unknowns: the offset, then the logarithm of each line's order. The rows of a stretch have the covariance
/// diag(error^2) + shared^2, whose inverse takes a share of their weighted mean off each (Sherman, Morrison).
NormalEquations normal_equations(std::span<const OffsetRow> rows, std::size_t lines) {
    const auto n = static_cast<Eigen::Index>(lines + 1);
    NormalEquations sum{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0.0};
    for (std::size_t first = 0; first < rows.size();) {
        std::size_t end = first;
        Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
        double weights = 0.0, value = 0.0;
        for (; end < rows.size() && rows[end].stretch == rows[first].stretch; ++end) {
            const OffsetRow& row = rows[end];
            Eigen::VectorXd at = Eigen::VectorXd::Zero(n);
            at(0) = row.per_deg_s;
            at(static_cast<Eigen::Index>(row.line) + 1) = 1.0;
            const double weight = 1.0 / (row.error * row.error);
            sum.normal += weight * at * at.transpose();
            sum.right += weight * row.log_order * at;
            sum.squares += weight * row.log_order * row.log_order;
            mean += weight * at;
            value += weight * row.log_order;
            weights += weight;
        }
        const double square = rows[first].shared * rows[first].shared;
        const double share = square / (1.0 + square * weights);
        sum.normal -= share * mean * mean.transpose();
        sum.right -= share * value * mean;
        sum.squares -= share * value * value;
        first = end;
    }
    return sum;
}

}  // namespace

std::optional<SteadyOffset> steady_offset(std::span<const SteadyLine> lines, DegPerSec likely) {
    const std::vector<OffsetRow> rows = offset_rows(lines);
    std::vector<double> speeds;
    std::size_t count = 0;
    double fastest = 0.0;
    for (const OffsetRow& row : rows) {
        count = std::max(count, row.line + 1);
        if (row.per_deg_s == 0.0) continue;
        speeds.push_back(-1.0 / row.per_deg_s);
        fastest = std::max(fastest, std::abs(speeds.back()));
    }
    if (!speeds_tell_offset(std::move(speeds))) return std::nullopt;
    NormalEquations sum = normal_equations(rows, count);
    const Eigen::Index n = sum.normal.rows();
    const SymmetricFactors without_offset(sum.normal.bottomRightCorner(n - 1, n - 1));
    const double alone = without_offset.solve(Eigen::VectorXd(Eigen::VectorXd::Unit(n - 1, 0)))(0);
    const double prior = 1.0 / (likely_offset_share * fastest * likely_offset_share * fastest);
    sum.normal(0, 0) += prior;
    sum.right(0) -= prior * likely.value();
    sum.squares += prior * likely.value() * likely.value();
    const SymmetricFactors factors(sum.normal);
    const Eigen::VectorXd found = factors.solve(sum.right);
    const Eigen::VectorXd of_offset = factors.solve(Eigen::VectorXd(Eigen::VectorXd::Unit(n, 0)));
    const Eigen::VectorXd of_order = factors.solve(Eigen::VectorXd(Eigen::VectorXd::Unit(n, 1)));
    const double freedom = static_cast<double>(rows.size()) - static_cast<double>(count);
    const double scale = excess_scatter(std::max(sum.squares - found.dot(sum.right), 0.0), freedom);
    SteadyOffset told;
    told.offset = DegPerSec(likely.value() + found(0));
    told.offset_error = DegPerSec(scale * std::sqrt(of_offset(0)));
    told.order_share_error = scale * std::sqrt(std::max(0.0, of_order(1) - alone));
    return told;
}

void take_off(DegPerSec offset, std::vector<Sighting>& sightings) {
    for (Sighting& seen : sightings) {
        const double least = 3.0 * std::abs(offset.value());
        if (seen.by_velocity && std::abs(seen.speed_deg_s) > least) seen.speed_deg_s -= offset.value();
    }
}

}  // namespace ripplenotch
