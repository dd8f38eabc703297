// SPDX-License-Identifier: MIT
#include "diagnose/search/change_times.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr Eigen::Index changing_columns = 3, all_columns = 4;  // inertia and gravity, beside them an offset
using ProductSums = Eigen::Matrix<double, all_columns + 1, all_columns + 1>;

// Sums of products of the columns and the residual up to each sample, the first none.
class RunningSums {
  public:
    RunningSums(const Case& looked_at, const std::vector<double>& residual_nm, std::size_t most_samples) {
        const Motion& motion = looked_at.motion;
        std::vector<std::size_t> rows;
        for (std::size_t k = 0; k < looked_at.size(); ++k) {
            if (looked_at.use[k] != 0) rows.push_back(k);
        }
        const std::size_t stride = rows.size() / most_samples + 1;
        std::size_t kept = 0;
        for (std::size_t r = 0; r < rows.size(); r += stride) rows[kept++] = rows[r];
        rows.resize(kept);
        double square = 0.0;
        for (const std::size_t k : rows)
            square += motion.acceleration_deg_s2[k] * motion.acceleration_deg_s2[k];
        const double usual = std::sqrt(square / std::max(static_cast<double>(kept), 1.0));
        const double scale = usual > 0.0 ? 1.0 / usual : 0.0;
        ProductSums sum = ProductSums::Zero();
        std::vector<double> angle_deg, cosine(kept), sine(kept);
        for (const std::size_t k : rows) angle_deg.push_back(motion.position_deg[k]);
        portable::cos_degrees(angle_deg, cosine);
        portable::sin_degrees(angle_deg, sine);
        for (std::size_t r = 0; r < kept; ++r) {
            times_s_.push_back(motion.time_s[rows[r]] - motion.time_s.front());
            before_.push_back(sum);
            Eigen::Matrix<double, all_columns + 1, 1> row;
            row << scale * motion.acceleration_deg_s2[rows[r]], cosine[r], sine[r], 1.0, residual_nm[rows[r]];
            sum += row * row.transpose();
        }
        all_ = sum;
        if (kept > 0) factors_.compute(damped(all_.topLeftCorner<all_columns, all_columns>()));
    }

    [[nodiscard]] std::size_t size() const { return times_s_.size(); }
    [[nodiscard]] double time_s(std::size_t place) const { return times_s_[place]; }

    /// Sum of squares above the noise, less what a constant inertia, gravity and offset explain.
    [[nodiscard]] double gap(double noise_nm) const {
        const Eigen::VectorXd along = all_.topRightCorner<all_columns, 1>();
        return all_(all_columns, all_columns) - along.dot(factors_.solve(along)) -
               noise_nm * noise_nm * static_cast<double>(times_s_.size());
    }

    /// Fall of the sum of squares by a change at this place.
    [[nodiscard]] double gain(std::size_t place) const {
        const ProductSums after = all_ - before_[place];
        const Eigen::MatrixXd common = after.topLeftCorner<all_columns, changing_columns>();
        const Eigen::MatrixXd projected = factors_.solve(common);
        const Eigen::MatrixXd outside =
            after.topLeftCorner<changing_columns, changing_columns>() - common.transpose() * projected;
        const Eigen::VectorXd along = after.topRightCorner<changing_columns, 1>() -
                                      projected.transpose() * all_.topRightCorner<all_columns, 1>();
        return along.dot(SymmetricFactors(damped(outside)).solve(along));
    }

  private:
    // Columns that are as good as combinations of others explain nothing.
    [[nodiscard]] Eigen::MatrixXd damped(Eigen::MatrixXd matrix) const {
        constexpr double part = 1e-6;
        for (Eigen::Index c = 0; c < matrix.rows(); ++c)
            matrix(c, c) += part * (all_(c, c) + static_cast<double>(times_s_.size()));
        return matrix;
    }

    std::vector<double> times_s_;
    std::vector<ProductSums> before_;
    ProductSums all_ = ProductSums::Zero();
    SymmetricFactors factors_;
};

}  // namespace

ChangeTimes change_times(const Case& looked_at, const std::vector<double>& residual_nm, double noise_nm,
                         const DiagnosisRules& rules) {
    const std::size_t compared_times = rules.screening.compared_times;
    const RunningSums sums(looked_at, residual_nm, rules.screening.change_samples);
    const std::size_t spacing = sums.size() / (compared_times + 1);
    if (spacing == 0) return {};
    const auto apart_from_ends =
        static_cast<std::size_t>(rules.screening.change_within * static_cast<double>(sums.size()));
    std::vector<double> gains(compared_times, 0.0);
    for (std::size_t i = 0; i < compared_times; ++i) {
        const std::size_t place = (i + 1) * spacing;
        if (place >= apart_from_ends && place + apart_from_ends <= sums.size()) gains[i] = sums.gain(place);
    }
    const double least = std::max(rules.screening.least_change * sums.gap(noise_nm), 0.0);
    ChangeTimes found{{}, static_cast<double>(compared_times)};
    const std::size_t apart = compared_times / 16;
    while (found.times_s.size() < rules.screening.most_change_times) {
        const auto best = static_cast<std::size_t>(std::ranges::max_element(gains) - gains.begin());
        if (!(gains[best] > least)) break;
        std::size_t place = best * spacing;
        const std::size_t end = std::min((best + 2) * spacing, sums.size());
        double most = 0.0;
        const std::size_t step = std::max<std::size_t>(spacing / 16, 1);
        for (std::size_t near = place; near < end; near += step) {
            if (const double gain = sums.gain(near); gain > most) {
                most = gain;
                place = near;
            }
        }
        found.times_s.push_back(sums.time_s(place));
        const std::size_t first = best > apart ? best - apart : 0,
                          last = std::min(best + apart, compared_times);
        std::fill(gains.begin() + static_cast<std::ptrdiff_t>(first),
                  gains.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
    }
    return found;
}

}  // namespace ripplenotch
