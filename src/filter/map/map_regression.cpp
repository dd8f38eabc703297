// SPDX-License-Identifier: MIT
#include "filter/map/map_regression.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/factorisations.hpp"

namespace ripplenotch {
namespace {

constexpr double independent_share = 2.0 / 3.0;  ///< of half-overlapping windows, the middle counting most
constexpr double turn_share = 0.5;               ///< of the amplitude, that a turn harmonic may well have
constexpr double any_share = 3.0;                ///< of the amplitude, that none has
constexpr double least_energy_share = 0.05;      ///< of the noise: a ripple that cannot be seen is not 0

}  // namespace

MapRegression::MapRegression(const MapData& data, const RippleMap& frame, std::size_t order)
    : data_(data), order_(order) {
    const auto count = static_cast<Eigen::Index>(data.windows.size());
    const auto columns = static_cast<Eigen::Index>(frame.form.columns());
    columns_ = Matrix::Zero(count, columns);
    blocks_.assign(data.blocks, {Matrix::Zero(columns, columns),
                                 Matrix::Zero(columns, columns),
                                 Vector::Zero(columns),
                                 Vector::Zero(columns),
                                 {}});
    gram_ = penalty(frame);
    right_ = Vector::Zero(columns);
    std::vector<double> row(frame.form.columns());
    for (Eigen::Index i = 0; i < count; ++i) {
        const MapWindow& window = data.windows[static_cast<std::size_t>(i)];
        map_weights(frame, window.state, row);
        const std::complex<double> second = second_comb_phasor(frame, order, window.state.position_deg);
        for (std::size_t c = 0; c < row.size(); ++c)
            columns_(i, static_cast<Eigen::Index>(c)) =
                row[c] * (frame.form.is_second_comb(c) ? second : 1.0);
        // Half of the noise is in each part; that of one window is known from a few numbers only.
        const double weight = 4.0 * independent_share / (window.noise[order] + data.mean_noise[order]);
        weight_.push_back(weight);
        const std::complex<double> value = window.value[order];
        const Vector x = columns_.row(i).adjoint();
        const Matrix square = weight * x * x.adjoint();
        Block& block = blocks_[window.block];
        block.gram += square;
        block.right += weight * value * x;
        if (!window.scored) continue;
        block.scored_gram += square;
        block.scored_right += weight * value * x;
        block.squares.total += weight * std::norm(value);
        block.squares.noise += weight * window.noise[order];
        block.squares.weights += weight;
    }
    for (const Block& block : blocks_) {
        gram_ += block.gram;
        right_ += block.right;
    }
}

Eigen::MatrixXd MapRegression::penalty(const RippleMap& frame) const {
    const MapForm& form = frame.form;
    const auto columns = static_cast<Eigen::Index>(form.columns());
    const auto each = static_cast<Eigen::Index>(form.columns_a_direction());
    const auto knots = static_cast<Eigen::Index>(form.speeds_deg_s.size());
    const auto speeds = static_cast<Eigen::Index>(form.speed_columns());
    const double noise = data_.mean_noise[order_];
    // Of each part.
    const double energy = 0.5 * std::max(data_.energy[order_] - noise, least_energy_share * noise);
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(columns, columns);
    if (!(energy > 0.0)) return Eigen::MatrixXd::Identity(columns, columns);
    const auto alike = [&](Eigen::Index a, Eigen::Index b) {
        p(a, a) += 1.0 / energy;
        p(b, b) += 1.0 / energy;
        p(a, b) -= 1.0 / energy;
        p(b, a) -= 1.0 / energy;
    };
    const auto load_column = static_cast<Eigen::Index>(form.load_column());
    const auto temperature_column = static_cast<Eigen::Index>(form.temperature_column());
    const double load = std::max(std::abs(frame.loads_nm.from), std::abs(frame.loads_nm.to));
    const double warmer = 0.5 * (frame.temperatures_degc.to - frame.temperatures_degc.from);
    for (Eigen::Index c = 0; c < columns; ++c) {
        const Eigen::Index within = c % each;
        const bool at_speed = within < speeds;
        double share = at_speed ? any_share : turn_share;
        if (form.by_load && within == load_column && load > 0.0) share /= load;
        if (form.by_temperature && within == temperature_column && warmer > 0.0) share /= warmer;
        p(c, c) += 1.0 / (share * share * energy);
        if (at_speed && (within + 1) % knots != 0) alike(c, c + 1);
        if (at_speed && c < each && columns > each) alike(c, c + each);
    }
    return p;
}

std::vector<std::complex<double>> MapRegression::values() const {
    const Vector z = HermitianFactors(gram_).solve(right_);
    return {z.begin(), z.end()};
}

std::complex<double> MapRegression::predicted(std::size_t window,
                                              const std::vector<std::complex<double>>& values) const {
    std::complex<double> sum = 0.0;
    for (std::size_t c = 0; c < values.size(); ++c)
        sum += columns_(static_cast<Eigen::Index>(window), static_cast<Eigen::Index>(c)) * values[c];
    return sum;
}

// Sandwich over the blocks (Liang and Zeger 1986), each part by itself.
std::vector<std::complex<double>> MapRegression::errors() const {
    const Matrix inverse = HermitianFactors(gram_).solve(Matrix::Identity(gram_.rows(), gram_.rows()));
    const Vector fit = inverse * right_;
    Eigen::MatrixXd variance = Eigen::MatrixXd::Zero(gram_.rows(), 2);
    for (const Block& block : blocks_) {
        const Vector moved = inverse * (block.right - block.gram * fit);
        variance.col(0) += moved.real().cwiseAbs2();
        variance.col(1) += moved.imag().cwiseAbs2();
    }
    const double blocks = static_cast<double>(blocks_.size());
    if (blocks > 1.0) variance *= blocks / (blocks - 1.0);
    std::vector<std::complex<double>> errors;
    for (Eigen::Index c = 0; c < variance.rows(); ++c) {
        const double by_noise = inverse(c, c).real();
        errors.emplace_back(std::sqrt(std::max(variance(c, 0), by_noise)),
                            std::sqrt(std::max(variance(c, 1), by_noise)));
    }
    return errors;
}

double MapRegression::residual(const Block& block, const Vector& values) {
    const std::complex<double> explained = values.dot(2.0 * block.scored_right - block.scored_gram * values);
    return std::max(block.squares.total - explained.real(), 0.0);
}

Eigen::MatrixXd MapRegression::residuals() const {
    const auto count = static_cast<Eigen::Index>(blocks_.size());
    Eigen::MatrixXd found(count, count);
    for (Eigen::Index a = 0; a < count; ++a) {
        for (Eigen::Index b = a; b < count; ++b) {
            const Block &one = blocks_[static_cast<std::size_t>(a)],
                        &two = blocks_[static_cast<std::size_t>(b)];
            Matrix gram = gram_ - one.gram;
            Vector right = right_ - one.right;
            if (a != b) {
                gram -= two.gram;
                right -= two.right;
            }
            const Vector fit = HermitianFactors(gram).solve(right);
            found(a, b) = residual(two, fit);
            found(b, a) = residual(one, fit);
        }
    }
    return found;
}

Eigen::MatrixXcd MapRegression::reduction() const {
    const auto count = static_cast<Eigen::Index>(blocks_.size());
    Matrix rights(gram_.rows(), count), form = Matrix::Zero(count, count);
    for (Eigen::Index b = 0; b < count; ++b) rights.col(b) = blocks_[static_cast<std::size_t>(b)].right;
    for (Eigen::Index b = 0; b < count; ++b) {
        const Block& block = blocks_[static_cast<std::size_t>(b)];
        Matrix others = rights;
        others.col(b).setZero();
        const Matrix fits = HermitianFactors(gram_ - block.gram).solve(others);
        const Matrix explained = block.scored_right.adjoint() * fits;
        form.row(b) += explained;
        form.col(b) += explained.adjoint();
        form -= fits.adjoint() * block.scored_gram * fits;
    }
    return form;
}

}  // namespace ripplenotch
