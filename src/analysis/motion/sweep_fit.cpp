// SPDX-License-Identifier: MIT
#include "analysis/motion/sweep_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/functions/many_numbers.hpp"
#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

/// The smooth part of a piece (constant, slope, and cosines of m pi u by the recurrence of Chebyshev's
/// polynomials) at some of its samples; a row of `length` numbers each.
class Rows {
  public:
    static constexpr std::size_t length = 256;  // chosen, not derived

    explicit Rows(const Sweep& sweep) : sweep_(sweep), values_(count() * length) {
        const std::size_t n = sweep.turns.size();
        place_.resize((n + length - 1) / length * length);
        for (std::size_t k = 0; k < n; ++k) place_[k] = sweep.progress(k);
        cosine_.resize(place_.size());
        for (std::size_t k = 0; k < place_.size(); ++k) cosine_[k] = std::numbers::pi * place_[k];
        portable::cos(cosine_, cosine_);
    }

    [[nodiscard]] std::size_t count() const { return sweep_.trend_terms; }
    [[nodiscard]] double* row(std::size_t term) { return values_.data() + term * length; }

    /// action(first sample, count) for all samples of the sweep, the rows filled with them.
    template <class Action>
    void in_blocks(const Action& action) {
        for (std::size_t first = 0; first < sweep_.turns.size(); first += length) {
            const std::size_t here = std::min(length, sweep_.turns.size() - first);
            fill_smooth(first);
            action(first, here);
        }
    }

  private:
    // All `length` of them, used or not: a loop of known length goes by vectors.
    void fill_smooth(std::size_t first) {
        const double* const place = place_.data() + first;
        const double* const cosine = cosine_.data() + first;
        std::array<double, length> before{}, now{};
        for (std::size_t i = 0; i < length; ++i) {
            row(0)[i] = before[i] = 1.0;
            row(1)[i] = place[i] - 0.5;
            now[i] = cosine[i];
        }
        for (std::size_t m = 2; m < sweep_.trend_terms; ++m) {
            double* const values = row(m);
            for (std::size_t i = 0; i < length; ++i) {
                values[i] = now[i];
                const double next = 2.0 * cosine[i] * now[i] - before[i];
                before[i] = now[i];
                now[i] = next;
            }
        }
    }

    const Sweep& sweep_;
    std::vector<double> values_;
    std::vector<double> place_, cosine_;  ///< from 0 to 1 along the piece, and cosine of pi times that
};

/// Weighted sums of products of the smooth part's terms. Those of two cosines are half the sums of the cosine
/// of their sum and of their difference, so neighbours determine all others.
class SmoothProducts {
  public:
    explicit SmoothProducts(std::size_t terms)
        : cosines_(terms - 1), neighbours_(2 * cosines_), by_slope_(terms) {}

    [[nodiscard]] std::size_t terms() const { return by_slope_.size(); }

    void add(const std::array<double, Rows::length>& weight, Rows& rows) {
        std::array<double, Rows::length> weighed{};
        const auto weigh = [&](const double* row) {
            for (std::size_t i = 0; i < Rows::length; ++i) weighed[i] = weight[i] * row[i];
        };
        const auto sum_with = [&](std::size_t term) {
            return dot(weighed.data(), rows.row(term), Rows::length);
        };
        weigh(rows.row(slope));
        for (std::size_t term = 0; term < terms(); ++term) by_slope_[term] += sum_with(term);
        for (std::size_t m = 0; m < cosines_; ++m) {
            weigh(rows.row(term_of(m)));
            neighbours_[2 * m] += sum_with(term_of(m));
            if (m + 1 < cosines_) neighbours_[2 * m + 1] += sum_with(term_of(m + 1));
        }
    }

    /// Writes the lower half of their products with each other.
    void put_into(Eigen::MatrixXd& normal) const {
        const auto at = [&](std::size_t a, std::size_t b) -> double& {
            return normal(static_cast<Eigen::Index>(std::max(a, b)),
                          static_cast<Eigen::Index>(std::min(a, b)));
        };
        // The sum for cosine j of pi u, from the products of the cosines of its two halves.
        const auto sum_of = [&](std::size_t j) { return 2.0 * neighbours_[j] - neighbours_[j % 2]; };
        for (std::size_t m = 0; m < cosines_; ++m) {
            for (std::size_t l = 0; l <= m; ++l)
                at(term_of(m), term_of(l)) = 0.5 * (sum_of(m + l) + sum_of(m - l));
        }
        for (std::size_t term = 0; term < terms(); ++term) at(slope, term) = by_slope_[term];
    }

  private:
    static constexpr std::size_t slope = 1;  ///< among the rows
    static std::size_t term_of(std::size_t cosine) { return cosine == 0 ? 0 : cosine + 1; }

    std::size_t cosines_;
    std::vector<double> neighbours_;  ///< cosine m by itself and by cosine m + 1, in turn
    std::vector<double> by_slope_;    ///< every term by the slope
};

}  // namespace

void take_off_smooth_part(Sweep& sweep) {
    sweep.torque_nm.assign(sweep.measured_nm.begin(), sweep.measured_nm.end());
    sweep.value.resize(sweep.torque_nm.size());
    Rows rows(sweep);
    const auto n = static_cast<Eigen::Index>(rows.count());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    SmoothProducts smooth(sweep.trend_terms);
    rows.in_blocks([&](std::size_t first, std::size_t count) {
        std::array<double, Rows::length> weight{}, weighed{};
        for (std::size_t i = 0; i < count; ++i) {
            weight[i] = sweep.weight[first + i];
            weighed[i] = weight[i] * sweep.torque_nm[first + i];
        }
        smooth.add(weight, rows);
        for (Eigen::Index a = 0; a < n; ++a)
            right[a] += dot(weighed.data(), rows.row(static_cast<std::size_t>(a)), count);
    });
    smooth.put_into(normal);
    normal.diagonal().array() *= 1.0 + 1e-10;  // line and first cosine are nearly parallel
    const Eigen::VectorXd found = SymmetricFactors(normal).solve(right);
    rows.in_blocks([&](std::size_t first, std::size_t count) {
        for (std::size_t m = 0; m < rows.count(); ++m)
            add_scaled(-found[static_cast<Eigen::Index>(m)], rows.row(m), sweep.torque_nm.data() + first,
                       count);
    });
    for (std::size_t k = 0; k < sweep.value.size(); ++k)
        sweep.value[k] = sweep.torque_nm[k] * sweep.weight[k];
}

}  // namespace ripplenotch
