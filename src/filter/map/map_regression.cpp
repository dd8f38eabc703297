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
    block_gram_.assign(data.blocks, Matrix::Zero(columns, columns));
    block_right_.assign(data.blocks, Matrix::Zero(columns, 2));
    gram_ = penalty(frame);
    right_ = Matrix::Zero(columns, 2);
    std::vector<double> row(frame.form.columns());
    for (Eigen::Index i = 0; i < count; ++i) {
        const MapWindow& window = data.windows[static_cast<std::size_t>(i)];
        map_weights(frame, window.state, row);
        for (Eigen::Index c = 0; c < columns; ++c) columns_(i, c) = row[static_cast<std::size_t>(c)];
        // Half of the noise is in each part; that of one window is known from a few numbers only.
        weight_.push_back(4.0 * independent_share / (window.noise[order] + data.mean_noise[order]));
        const Eigen::RowVectorXd x = columns_.row(i);
        const std::complex<double> value = window.value[order];
        const Eigen::RowVector2d y(value.real(), value.imag());
        block_gram_[window.block] += weight_.back() * x.transpose() * x;
        block_right_[window.block] += weight_.back() * x.transpose() * y;
    }
    for (std::size_t b = 0; b < data.blocks; ++b) {
        gram_ += block_gram_[b];
        right_ += block_right_[b];
    }
}

MapRegression::Matrix MapRegression::penalty(const RippleMap& frame) const {
    const MapForm& form = frame.form;
    const auto columns = static_cast<Eigen::Index>(form.columns());
    const auto each = static_cast<Eigen::Index>(form.columns_a_direction());
    const auto speeds = static_cast<Eigen::Index>(form.speeds_deg_s.size());
    const double noise = data_.mean_noise[order_];
    // Of each part.
    const double energy = 0.5 * std::max(data_.energy[order_] - noise, least_energy_share * noise);
    Matrix p = Matrix::Zero(columns, columns);
    if (!(energy > 0.0)) return Matrix::Identity(columns, columns);
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
        if (at_speed && within + 1 < speeds) alike(c, c + 1);
        if (at_speed && c < each && columns > each) alike(c, c + each);
    }
    return p;
}

std::vector<std::complex<double>> MapRegression::values() const {
    const Matrix z = SymmetricFactors(gram_).solve(right_);
    std::vector<std::complex<double>> values;
    for (Eigen::Index c = 0; c < z.rows(); ++c) values.emplace_back(z(c, 0), z(c, 1));
    return values;
}

std::complex<double> MapRegression::foretold(std::size_t window,
                                             const std::vector<std::complex<double>>& values) const {
    std::complex<double> sum = 0.0;
    for (std::size_t c = 0; c < values.size(); ++c)
        sum += columns_(static_cast<Eigen::Index>(window), static_cast<Eigen::Index>(c)) * values[c];
    return sum;
}

// Sandwich over the blocks (Liang and Zeger 1986), each part by itself.
std::vector<std::complex<double>> MapRegression::errors() const {
    const auto fit = values();
    const Matrix inverse =
        SymmetricFactors(gram_).solve(Matrix(Matrix::Identity(gram_.rows(), gram_.rows())));
    Matrix variance = Matrix::Zero(gram_.rows(), 2);
    for (std::size_t b = 0; b < data_.blocks; ++b) {
        Matrix score = Matrix::Zero(gram_.rows(), 2);
        for (std::size_t i = 0; i < data_.windows.size(); ++i) {
            if (data_.windows[i].block != b) continue;
            const std::complex<double> left = data_.windows[i].value[order_] - foretold(i, fit);
            score += weight_[i] * columns_.row(static_cast<Eigen::Index>(i)).transpose() *
                     Eigen::RowVector2d(left.real(), left.imag());
        }
        const Matrix moved = inverse * score;
        variance += moved.cwiseProduct(moved);
    }
    const double blocks = static_cast<double>(data_.blocks);
    if (blocks > 1.0) variance *= blocks / (blocks - 1.0);
    std::vector<std::complex<double>> errors;
    for (Eigen::Index c = 0; c < variance.rows(); ++c) {
        const double by_noise = inverse(c, c);
        errors.emplace_back(std::sqrt(std::max(variance(c, 0), by_noise)),
                            std::sqrt(std::max(variance(c, 1), by_noise)));
    }
    return errors;
}

HeldOut MapRegression::held_out() const {
    HeldOut found{std::vector<double>(data_.blocks), std::vector<double>(data_.blocks), 0.0, 0.0};
    double weights = 0.0;
    for (std::size_t b = 0; b < data_.blocks; ++b) {
        const Matrix z = SymmetricFactors(gram_ - block_gram_[b]).solve(Matrix(right_ - block_right_[b]));
        for (std::size_t i = 0; i < data_.windows.size(); ++i) {
            const MapWindow& window = data_.windows[i];
            if (window.block != b || !window.scored) continue;
            const Eigen::RowVectorXd said = columns_.row(static_cast<Eigen::Index>(i)) * z;
            const std::complex<double> left = window.value[order_] - std::complex<double>(said(0), said(1));
            found.there[b] += weight_[i] * std::norm(window.value[order_]);
            found.left[b] += weight_[i] * std::norm(left);
            found.noise += weight_[i] * window.noise[order_];
            weights += weight_[i];
        }
    }
    if (weights > 0.0) found.unit_nm2 = 1.0 / weights;
    return found;
}

}  // namespace ripplenotch
