// SPDX-License-Identifier: MIT
#include "analysis/lines/line_removal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/linear_algebra.hpp"
#include "core/many_numbers.hpp"
#include "core/vectors/dot.hpp"

namespace ripplenotch {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;
// Under a Hann window lines so many cycles apart have a thousandth of each other in them.
constexpr double clear_cycles = 10.0;

/// The smooth part of a piece (constant, slope, and cosines of m pi u by the recurrence of Chebyshev's
/// polynomials) and cosine and sine of lines, at some of its samples; a row of `length` numbers each.
class Rows {
  public:
    static constexpr std::size_t length = 256;

    Rows(const Sweep& sweep, std::span<const KnownLine> lines)
        : sweep_(sweep), lines_(lines), values_(count() * length) {}

    [[nodiscard]] std::size_t count() const { return sweep_.trend_terms + 2 * lines_.size(); }
    [[nodiscard]] double* row(std::size_t term) { return values_.data() + term * length; }

    /// action(first sample, count) for all samples of the sweep, the rows filled with them.
    template <class Action>
    void in_blocks(const Action& action) {
        for (std::size_t first = 0; first < sweep_.turns.size(); first += length) {
            const std::size_t here = std::min(length, sweep_.turns.size() - first);
            fill_smooth(first, here);
            for (std::size_t i = 0; i < lines_.size(); ++i) fill_line(i, first, here);
            action(first, here);
        }
    }

  private:
    void fill_smooth(std::size_t first, std::size_t here) {
        std::array<double, length> cosine{}, before{}, now{};
        for (std::size_t i = 0; i < here; ++i) {
            const double place =
                std::abs(sweep_.turns[first + i] - sweep_.turns.front()) / sweep_.length_turns;
            row(0)[i] = 1.0;
            row(1)[i] = place - 0.5;
            cosine[i] = std::numbers::pi * place;
            before[i] = 1.0;
        }
        portable::cos(std::span(cosine).first(here), cosine);
        now = cosine;
        for (std::size_t m = 2; m < sweep_.trend_terms; ++m) {
            for (std::size_t i = 0; i < here; ++i) {
                row(m)[i] = now[i];
                const double next = 2.0 * cosine[i] * now[i] - before[i];
                before[i] = now[i];
                now[i] = next;
            }
        }
    }

    void fill_line(std::size_t line, std::size_t first, std::size_t here) {
        std::array<double, length> angle{};
        const auto at = places(sweep_, lines_[line].axis).subspan(first, here);
        for (std::size_t i = 0; i < here; ++i) angle[i] = tau * lines_[line].place * at[i];
        double* const cosine = row(sweep_.trend_terms + 2 * line);
        portable::phasors(std::span(angle).first(here), std::span(cosine, length),
                          std::span(cosine + length, length));
    }

    const Sweep& sweep_;
    std::span<const KnownLine> lines_;
    std::vector<double> values_;
};

void subtract_from(Sweep& sweep, const KnownLine& line) {
    const auto at = places(sweep, line.axis);
    std::vector<double> angle(at.size()), cosine(at.size()), sine(at.size());
    for (std::size_t k = 0; k < at.size(); ++k) angle[k] = tau * line.place * at[k];
    portable::phasors(angle, cosine, sine);
    double cc = 0.0, cs = 0.0, ss = 0.0, xc = 0.0, xs = 0.0;
    for (std::size_t k = 0; k < at.size(); ++k) {
        cc += sweep.weight[k] * cosine[k] * cosine[k];
        cs += sweep.weight[k] * cosine[k] * sine[k];
        ss += sweep.weight[k] * sine[k] * sine[k];
        xc += sweep.value[k] * cosine[k];
        xs += sweep.value[k] * sine[k];
    }
    const double determinant = cc * ss - cs * cs;
    if (!(determinant > 1e-6 * cc * ss)) return;
    const double a = (xc * ss - xs * cs) / determinant, b = (xs * cc - xc * cs) / determinant;
    for (std::size_t k = 0; k < at.size(); ++k) {
        const double there = a * cosine[k] + b * sine[k];
        sweep.torque_nm[k] -= there;
        sweep.value[k] -= sweep.weight[k] * there;
    }
}

/// True where each line is clear of the smooth part and of the lines of its own axis.
bool clear(const Sweep& sweep, std::span<const KnownLine> lines) {
    const double smooth_cycles = 0.5 * static_cast<double>(sweep.trend_terms);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const double length = length_of(sweep, lines[i].axis);
        if (lines[i].place * length < smooth_cycles + clear_cycles) return false;
        for (std::size_t j = 0; j < i; ++j) {
            const bool near = std::abs(lines[i].place - lines[j].place) * length < clear_cycles;
            if (lines[i].axis == lines[j].axis && near) return false;
        }
    }
    return true;
}

}  // namespace

void fit_out(Sweep& sweep, std::span<const KnownLine> lines) {
    sweep.torque_nm.assign(sweep.measured_nm.begin(), sweep.measured_nm.end());
    sweep.value.resize(sweep.torque_nm.size());
    Rows rows(sweep, lines);
    const auto n = static_cast<Eigen::Index>(rows.count());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    rows.in_blocks([&](std::size_t first, std::size_t count) {
        std::array<double, Rows::length> weighed{};
        for (Eigen::Index a = 0; a < n; ++a) {
            const double* const row = rows.row(static_cast<std::size_t>(a));
            for (std::size_t i = 0; i < count; ++i) weighed[i] = sweep.weight[first + i] * row[i];
            for (Eigen::Index b = 0; b <= a; ++b)
                normal(a, b) += dot(weighed.data(), rows.row(static_cast<std::size_t>(b)), count);
            right[a] += dot(weighed.data(), sweep.torque_nm.data() + first, count);
        }
    });
    normal.diagonal().array() *= 1.0 + 1e-10;  // line and first cosine are nearly parallel
    const Eigen::VectorXd found = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    rows.in_blocks([&](std::size_t first, std::size_t count) {
        for (std::size_t m = 0; m < rows.count(); ++m)
            add_scaled(-found[static_cast<Eigen::Index>(m)], rows.row(m), sweep.torque_nm.data() + first,
                       count);
    });
    for (std::size_t k = 0; k < sweep.value.size(); ++k)
        sweep.value[k] = sweep.torque_nm[k] * sweep.weight[k];
}

void subtract(std::vector<Sweep>& sweeps, const KnownLine& line) {
    for (Sweep& sweep : sweeps) subtract_from(sweep, line);
}

void take_out_last(std::vector<Sweep>& sweeps, std::span<const KnownLine> lines) {
    for (Sweep& sweep : sweeps) {
        if (clear(sweep, lines)) {
            subtract_from(sweep, lines.back());
        } else {
            fit_out(sweep, lines);
        }
    }
}

}  // namespace ripplenotch
