// SPDX-License-Identifier: MIT
#include "fleet/trend/regression.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/least_squares.hpp"

namespace ripplenotch {
namespace {

constexpr double least_left = 0.05;  // of the squares of a column, beside the others

double dot_product(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

}  // namespace

Regression::Regression(std::span<const double> value, std::span<const double> weights,
                       const std::vector<std::vector<double>>& columns)
    : weights_(weights.begin(), weights.end()) {
    std::vector<std::vector<double>> kept;
    for (const auto& column : columns) {
        std::vector<double> weighed(column);
        for (std::size_t i = 0; i < weighed.size(); ++i) weighed[i] *= weights_[i];
        const double before = dot_product(weighed, weighed);
        std::vector<double> left = weighed;
        project(left);
        project(left);  // once more, for what rounding left
        const double size = std::sqrt(dot_product(left, left));
        if (!(size * size > 1e-6 * before)) continue;
        for (double& number : left) number /= size;
        basis_.push_back(std::move(left));
        kept.push_back(std::move(weighed));
    }
    residual_.assign(value.begin(), value.end());
    for (std::size_t i = 0; i < residual_.size(); ++i) residual_[i] *= weights_[i];
    if (!kept.empty()) {
        const std::vector<double> values = least_squares(kept, residual_);
        first_value_ = values.front();
    }
    project(residual_);
    project(residual_);
}

void Regression::project(std::vector<double>& weighed) const {
    for (const auto& axis : basis_) {
        const double along = dot_product(axis, weighed);
        for (std::size_t i = 0; i < weighed.size(); ++i) weighed[i] -= along * axis[i];
    }
}

double Regression::freedom() const {
    return static_cast<double>(residual_.size()) - static_cast<double>(basis_.size());
}

double Regression::deviation() const {
    return std::sqrt(dot_product(residual_, residual_) / std::max(freedom(), 1.0));
}

std::vector<double> Regression::beside(std::span<const double> column) const {
    std::vector<double> left(column.begin(), column.end());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] *= weights_[i];
    project(left);
    return left;
}

std::optional<Extra> Regression::extra(std::span<const double> column) const {
    double whole = 0.0, mean = 0.0;
    for (const double number : column) mean += number / static_cast<double>(column.size());
    for (std::size_t i = 0; i < column.size(); ++i)
        whole += (column[i] - mean) * (column[i] - mean) * weights_[i] * weights_[i];
    const std::vector<double> left = beside(column);
    const double squares = dot_product(left, left);
    if (!(squares > least_left * whole) || !(freedom() > 1.5)) return std::nullopt;
    const double along = dot_product(left, residual_), rss = dot_product(residual_, residual_);
    const double rest = std::max(rss - along * along / squares, 1e-12 * rss);
    Extra found;
    found.size = along / squares;
    found.error = std::sqrt(rest / (freedom() - 1.0) / squares);
    found.t_squared = rest > 0.0 ? along * along / squares / (rest / (freedom() - 1.0)) : 0.0;
    return found;
}

}  // namespace ripplenotch
