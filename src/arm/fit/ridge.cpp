// SPDX-License-Identifier: MIT
#include "arm/fit/arm_fit.hpp"

#include <cmath>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Links of an arm of 100 Nm weigh some kilograms, some decimetres from their joint.
constexpr double mass_kg = 5.0, moment_kgm = 0.5, inertia_kgm2 = 0.1, rotor_kgm2 = 1.0;
// Friction is not drawn anywhere.
constexpr double beside_nm = 1000.0;

double geometric_mean(const std::vector<double>& numbers) {
    double sum = 0.0;
    for (const double number : numbers) sum += portable::log(std::max(number, 1e-300));
    return portable::exp(sum / static_cast<double>(numbers.size()));
}

}  // namespace

double ArmRidge::Errors::smoothed_mean() const { return geometric_mean(smoothed_nm); }
double ArmRidge::Errors::logged_mean() const { return geometric_mean(logged_nm); }

ArmRidge::ArmRidge(std::size_t links, const std::vector<JointSums>& joints, double size)
    : links_(links), joints_(joints), size_(size) {
    for (const JointSums& joint : joints) {
        auto& sums = without_.emplace_back();
        for (std::size_t out = 0; out <= arm_folds; ++out) {
            FoldSums& sum = sums.emplace_back(links + values_of_a_joint);
            for (std::size_t fold = 0; fold < arm_folds; ++fold)
                if (fold != out) sum.add(joint.smoothed[fold]);
        }
    }
}

double ArmRidge::reach(std::size_t value) const {
    if (value < links_) {
        const std::size_t kind = value % values_of_a_link;
        return size_ * (kind == 0 ? mass_kg : kind < 4 ? moment_kgm : inertia_kgm2);
    }
    return (value - links_) % values_of_a_joint == 0 ? size_ * rotor_kgm2 : beside_nm;
}

std::vector<VectorXd> ArmRidge::solve(double pull, std::span<const double> noise_nm,
                                      std::optional<std::size_t> left_out) const {
    const auto links = static_cast<Index>(links_), own = static_cast<Index>(values_of_a_joint);
    const Index all = links + own * static_cast<Index>(joints_.size());
    MatrixXd matrix = MatrixXd::Zero(all, all);
    VectorXd side = VectorXd::Zero(all);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const FoldSums& sums = without_[j][left_out.value_or(arm_folds)];
        const double weight = 1.0 / (noise_nm[j] * noise_nm[j]);
        const Index at = links + own * static_cast<Index>(j);
        matrix.topLeftCorner(links, links) += weight * sums.rows_by_rows.topLeftCorner(links, links);
        matrix.block(0, at, links, own) = weight * sums.rows_by_rows.topRightCorner(links, own);
        matrix.block(at, 0, own, links) = weight * sums.rows_by_rows.bottomLeftCorner(own, links);
        matrix.block(at, at, own, own) = weight * sums.rows_by_rows.bottomRightCorner(own, own);
        side.head(links) += weight * sums.rows_by_torque.head(links);
        side.segment(at, own) = weight * sums.rows_by_torque.tail(own);
    }
    for (Index v = 0; v < all; ++v) {
        const double far = reach(static_cast<std::size_t>(v));
        matrix(v, v) += pull / (far * far);
    }
    const VectorXd values = ScaledDefiniteFactors(std::move(matrix), rounding_of_definite).solve(side);
    std::vector<VectorXd> by_joint;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        VectorXd joined(links + own);
        joined << values.head(links), values.segment(links + own * static_cast<Index>(j), own);
        by_joint.push_back(std::move(joined));
    }
    return by_joint;
}

ArmRidge::Errors ArmRidge::left_out_errors(double pull, std::span<const double> noise_nm) const {
    Errors errors{std::vector<double>(joints_.size()), std::vector<double>(joints_.size())};
    for (std::size_t fold = 0; fold < arm_folds; ++fold) {
        const auto values = solve(pull, noise_nm, fold);
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            errors.smoothed_nm[j] += joints_[j].smoothed[fold].left(values[j]);
            errors.logged_nm[j] += joints_[j].logged[fold].left(values[j]);
        }
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        double smoothed = 0.0, logged = 0.0;
        for (std::size_t fold = 0; fold < arm_folds; ++fold) {
            smoothed += joints_[j].smoothed[fold].count;
            logged += joints_[j].logged[fold].count;
        }
        errors.smoothed_nm[j] = std::sqrt(errors.smoothed_nm[j] / smoothed);
        errors.logged_nm[j] = std::sqrt(errors.logged_nm[j] / logged);
    }
    return errors;
}

ArmRidge::Word ArmRidge::word_of(std::size_t j, double noise_nm) const {
    const auto links = static_cast<Index>(links_), own = static_cast<Index>(values_of_a_joint);
    const FoldSums& sums = without_[j][arm_folds];
    const double weight = 1.0 / (noise_nm * noise_nm);
    MatrixXd of_own = weight * sums.rows_by_rows.bottomRightCorner(own, own);
    for (Index v = 0; v < own; ++v) {
        const double far = reach(links_ + static_cast<std::size_t>(v));
        of_own(v, v) += 1.0 / (far * far);
    }
    const MatrixXd between = weight * sums.rows_by_rows.topRightCorner(links, own);
    const DefiniteFactors factored(of_own);
    // Projecting out the joint's own values can leave rounding below 0 for a link's values.
    MatrixXd of_links = weight * sums.rows_by_rows.topLeftCorner(links, links);
    of_links.diagonal() *= 1.0 + rounding_of_definite;
    return {of_links - between * factored.solve(MatrixXd(between.transpose())),
            weight * sums.rows_by_torque.head(links) -
                between * factored.solve(VectorXd(weight * sums.rows_by_torque.tail(own)))};
}

}  // namespace ripplenotch
