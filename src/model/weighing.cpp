// SPDX-License-Identifier: MIT
#include "model/weighing.hpp"

#include <algorithm>

#include "core/linear_algebra.hpp"
#include "core/vectors/dot.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A nuisance of which less than this part lies outside the others brings rounding noise alone.
constexpr double not_new = 1e-9;

}  // namespace

Weighing::Weighing(std::size_t samples, std::span<const unsigned char> use, std::span<const double> color)
    : color_(color.begin(), color.end()) {
    std::size_t since_unused = 0;
    for (std::size_t k = 0; k < samples; ++k) {
        const bool used = use.empty() || use[k] != 0;
        since_unused = used ? since_unused + 1 : 0;
        if (since_unused > color_.size()) rows_.push_back(k);
    }
}

std::vector<double> Weighing::whitened(std::span<const double> torque_nm) const {
    std::vector<double> white(size(), 0.0);
    const std::size_t order = color_.size();
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const double* const now = torque_nm.data() + rows_[r];
        double value = now[0];
        for (std::size_t i = 0; i < order; ++i) value -= color_[i] * now[-static_cast<std::ptrdiff_t>(i) - 1];
        white[r] = value;
    }
    return white;
}

std::vector<double> Weighing::operator()(std::span<const double> torque_nm) const {
    std::vector<double> white = whitened(torque_nm);
    if (basis_.empty()) return white;
    for (std::size_t first = 0; first < basis_.size(); first += size()) {
        const double* const nuisance = basis_.data() + first;
        add_scaled(-dot(nuisance, white.data(), size()), nuisance, white.data(), size());
    }
    return white;
}

void Weighing::set_nuisance(const std::vector<Nuisance>& nuisance, double noise_nm) {
    basis_.clear();
    bounded_ = static_cast<std::size_t>(std::count_if(
        nuisance.begin(), nuisance.end(), [](const Nuisance& entry) { return entry.usual_size > 0.0; }));
    const auto n = static_cast<Index>(size());
    Index bound = static_cast<Index>(rows_.size());
    std::vector<VectorXd> kept;
    for (const Nuisance& entry : nuisance) {
        const std::vector<double> white = whitened(entry.torque_nm);
        VectorXd column = Eigen::Map<const VectorXd>(white.data(), n);
        if (entry.usual_size > 0.0) column[bound++] = noise_nm / entry.usual_size;
        const double length = column.norm();
        for (int pass = 0; pass < 2; ++pass) {  // twice is enough (Kahan, Parlett)
            for (const VectorXd& other : kept) column -= other.dot(column) * other;
        }
        if (column.norm() > not_new * length) kept.push_back(column.normalized());
    }
    for (const VectorXd& column : kept) basis_.insert(basis_.end(), column.data(), column.data() + n);
}

}  // namespace ripplenotch
