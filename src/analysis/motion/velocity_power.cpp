// SPDX-License-Identifier: MIT
#include "analysis/motion/velocity_power.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

// So many of a sweep turn less than a tenth of a cycle each where the whole is wrong by five cycles.
constexpr std::size_t cells_per_sweep = 48;

void centre(DemodulatedSweep& cells) {
    for (std::vector<double>& column : cells.column) {
        double mean = 0.0;
        for (std::size_t i = 0; i < column.size(); ++i) mean += cells.weight[i] * column[i] / cells.weights;
        for (double& one : column) one -= mean;
    }
}

struct PowerMoments {
    Complex value;
    std::array<Complex, 3> first{};
    std::array<std::array<Complex, 3>, 3> second{};
};

/// The sum and its derivatives by the three unknowns that move it.
PowerMoments power_moments(const DemodulatedSweep& cells, const std::array<double, 3>& moved) {
    PowerMoments sum;
    const double rate = full_turn * cells.cycles;
    for (std::size_t i = 0; i < cells.value.size(); ++i) {
        const double off =
            moved[0] * cells.column[0][i] + moved[1] * cells.column[1][i] + moved[2] * cells.column[2][i];
        const Complex z = cells.value[i] * portable::polar(1.0, -rate * off);
        sum.value += z;
        for (std::size_t a = 0; a < 3; ++a) {
            const Complex by_a = Complex(0.0, -rate * cells.column[a][i]) * z;
            sum.first[a] += by_a;
            for (std::size_t b = 0; b <= a; ++b)
                sum.second[a][b] += Complex(0.0, -rate * cells.column[b][i]) * by_a;
        }
    }
    return sum;
}

/// Sums of weight * column a * column b over the cells.
double spread_of_cells(const DemodulatedSweep& cells, const std::vector<double>& weight, std::size_t a,
                       std::size_t b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < weight.size(); ++i)
        sum += weight[i] * cells.column[a][i] * cells.column[b][i];
    return sum;
}

}  // namespace

DemodulatedSweep demodulated(const TraceView& log, const Sweep& sweep, double cycles_per_turn) {
    const std::size_t n = sweep.turns.size(), count = std::min(n, cells_per_sweep);
    DemodulatedSweep cells;
    cells.cycles = cycles_per_turn;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t first = n * i / count, end = n * (i + 1) / count;
        Complex sum;
        double weight = 0.0, squares = 0.0, turns = 0.0, time = 0.0, speed = 0.0;
        for (std::size_t k = first; k < end; ++k) {
            sum += sweep.value[k] * portable::polar(1.0, -full_turn * cycles_per_turn * sweep.turns[k]);
            weight += sweep.weight[k];
            squares += sweep.weight[k] * sweep.weight[k];
            turns += sweep.turns[k];
            time += sweep.time_s[k];
            speed += log.velocity_deg_s[sweep.first + k];
        }
        const auto samples = static_cast<double>(end - first);
        cells.value.push_back(sum);
        cells.weight.push_back(weight);
        cells.weight_square.push_back(squares);
        cells.weights += weight;
        cells.weight_squares += squares;
        cells.seconds.push_back(samples / sweep.rate_hz);
        cells.column[0].push_back(turns / samples);
        const bool summed = !log.has_position();
        cells.column[1].push_back(summed ? -time / samples / 360.0 : 0.0);
        cells.column[2].push_back(summed ? speed / samples / 360.0 : 0.0);
    }
    centre(cells);
    return cells;
}

void RipplePower::add(const DemodulatedSweep& cells, const VectorXd& unknown, At& sum) const {
    const auto place = places_of(cells);
    const PowerMoments m = power_moments(cells, {unknown[place[0]], unknown[place[1]], unknown[place[2]]});
    const double power = std::norm(m.value) / cells.noise;
    sum.value += 0.5 * power;
    const double rate = full_turn * cells.cycles;
    const double stiff = power / cells.weights * rate * rate;
    for (std::size_t a = 0; a < 3; ++a) {
        sum.slope[place[a]] += std::real(std::conj(m.value) * m.first[a]) / cells.noise;
        for (std::size_t b = 0; b <= a; ++b) {
            const double curve =
                std::real(std::conj(m.first[a]) * m.first[b] + std::conj(m.value) * m.second[a][b]) /
                cells.noise;
            const double expected = stiff * spread_of_cells(cells, cells.weight, a, b);
            sum.curve(place[a], place[b]) += curve;
            sum.expected(place[a], place[b]) += expected;
            if (a == b) continue;
            sum.curve(place[b], place[a]) += curve;
            sum.expected(place[b], place[a]) += expected;
        }
    }
}

double RipplePower::most_cycles(const VectorXd& unknown) const {
    double most = 0.0;
    for (const DemodulatedSweep& cells : all_) {
        for (std::size_t i = 0; i < cells.value.size(); ++i) {
            const double off = unknown[offset()] * cells.column[1][i] + unknown[delay()] * cells.column[2][i];
            most = std::max(most, cells.cycles * std::abs(off));
        }
    }
    return most;
}

RipplePower::SlopeVariance RipplePower::slope_variance(const VectorXd& unknown) const {
    SlopeVariance variance{MatrixXd::Zero(unknowns(), unknowns()), MatrixXd(certainty_.asDiagonal())};
    std::vector<VectorXd> after;  // by cell, how much of the slope one turn of angle from there on makes
    const DemodulatedSweep* before = nullptr;
    const auto settle = [&] {
        if (before == nullptr) return;
        for (std::size_t i = 0; i < after.size(); ++i)
            variance.common += before->variance_per_s * before->seconds[i] * after[i] * after[i].transpose();
        after.clear();
    };
    for (const DemodulatedSweep& cells : all_) {
        // The orders of one sweep follow each other, and share its angle.
        if (before != nullptr && before->sweep != cells.sweep) settle();
        before = &cells;
        after.resize(cells.value.size(), VectorXd::Zero(unknowns()));
        const auto place = places_of(cells);
        const PowerMoments m =
            power_moments(cells, {unknown[place[0]], unknown[place[1]], unknown[place[2]]});
        const double power = std::max(0.0, std::norm(m.value) / cells.noise - 1.0);
        const double rate = full_turn * cells.cycles, stiff = power / cells.weights * rate * rate;
        for (std::size_t a = 0; a < 3; ++a) {
            double tail = 0.0;
            for (std::size_t i = cells.value.size(); i-- > 0;) {
                tail += cells.weight[i] * cells.column[a][i];
                after[i][place[a]] += stiff * tail;
            }
            for (std::size_t b = 0; b < 3; ++b) {
                variance.own(place[a], place[b]) += 0.5 * power * rate * rate *
                                                    spread_of_cells(cells, cells.weight_square, a, b) /
                                                    cells.weight_squares;
            }
        }
    }
    settle();
    return variance;
}

}  // namespace ripplenotch
