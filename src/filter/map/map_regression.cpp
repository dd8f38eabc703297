// SPDX-License-Identifier: MIT
#include "filter/map/map_regression.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/factorisations.hpp"

namespace ripplenotch {
namespace {

/// Effective share of half-overlapping windows, the middle counting most.
constexpr double independent_share = 2.0 / 3.0;
constexpr double any_share = 3.0;            ///< multiple of the amplitude that no coefficient reaches
constexpr double least_energy_share = 0.05;  ///< share of the noise: a ripple that cannot be seen is not 0
constexpr double least_noise_share = 1e-8;   ///< share of the energy: a simulation without noise has rounding

}  // namespace

Eigen::VectorXcd amplitudes_of(const MapData& data, std::size_t order) {
    Eigen::VectorXcd values(static_cast<Eigen::Index>(data.windows.size()));
    for (std::size_t w = 0; w < data.windows.size(); ++w)
        values(static_cast<Eigen::Index>(w)) = data.windows[w].value[order];
    return values;
}

MapRegression::MapRegression(const MapData& data, const MapForm& form, std::size_t order)
    : MapRegression(data, form, order, amplitudes_of(data, order)) {}

MapRegression::MapRegression(const MapData& data, const MapForm& form, std::size_t order,
                             const Eigen::VectorXcd& values)
    : weighted_(static_cast<Eigen::Index>(form.columns()), values.size()) {
    RippleMap frame = data.frame;
    frame.form = form;
    for (const MapWindow& window : data.windows)
        noise_ += window.noise[order] / static_cast<double>(data.windows.size());
    energy_ = values.squaredNorm() / static_cast<double>(data.windows.size());
    noise_ = std::max(noise_, least_noise_share * energy_);
    const auto columns = static_cast<Eigen::Index>(form.columns());
    const Matrix none = Matrix::Zero(columns, columns);
    blocks_.assign(data.blocks, {none, none, Vector::Zero(columns), Vector::Zero(columns), {}});
    gram_ = penalty(frame);
    right_ = Vector::Zero(columns);
    std::vector<double> row(form.columns());
    Vector x(columns);
    for (Eigen::Index w = 0; w < values.size(); ++w) {
        const MapWindow& window = data.windows[static_cast<std::size_t>(w)];
        map_weights(frame, window.state, row);
        const std::complex<double> second =
            std::conj(second_comb_phasor(frame, order, window.state.position_deg));
        for (std::size_t c = 0; c < row.size(); ++c)
            x(static_cast<Eigen::Index>(c)) = row[c] * (form.is_second_comb(c) ? second : 1.0);
        // Half of the noise is in each part; that of one window is known from a few numbers only.
        const double weight = 4.0 * independent_share / (window.noise[order] + noise_);
        weighted_.col(w) = weight * x;
        const Matrix square = weighted_.col(w) * x.adjoint();
        Block& block = blocks_[window.block];
        block.windows.push_back(w);
        block.gram += square;
        block.right += values(w) * weighted_.col(w);
        if (!window.scored) continue;
        block.scored.push_back(w);
        block.scored_gram += square;
        block.scored_right += values(w) * weighted_.col(w);
        block.squares.total += weight * std::norm(values(w));
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
    // Energy of the cosine part, and of the sine part.
    const double energy = 0.5 * std::max(energy_ - noise_, least_energy_share * noise_);
    if (!(energy > 0.0)) return Eigen::MatrixXd::Identity(columns, columns);
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(columns, columns);
    const auto alike = [&p](Eigen::Index a, Eigen::Index b, double variance) {
        p(a, a) += 1.0 / variance;
        p(b, b) += 1.0 / variance;
        p(a, b) -= 1.0 / variance;
        p(b, a) -= 1.0 / variance;
    };
    const std::size_t knots = form.speeds_deg_s.size(), each = form.columns_a_direction();
    const double share_of_each = 1.0 / static_cast<double>(knots * form.directions);
    const double step = energy / std::max(static_cast<double>(knots) - 1.0, 1.0);
    for (std::size_t k = 0; k < form.columns(); ++k) {
        const auto c = static_cast<Eigen::Index>(k), across = static_cast<Eigen::Index>(each);
        const std::size_t within = k % each;
        p(c, c) += share_of_each / (any_share * any_share * energy);
        if ((within + 1) % knots != 0) alike(c, c + 1, step);
        if (k < each && form.directions > 1) alike(c, c + across, energy * static_cast<double>(knots));
    }
    return p;
}

Eigen::VectorXcd MapRegression::values(const std::vector<bool>& left_out) const {
    Matrix gram = gram_;
    Vector right = right_;
    for (std::size_t b = 0; b < left_out.size(); ++b) {
        if (!left_out[b]) continue;
        gram -= blocks_[b].gram;
        right -= blocks_[b].right;
    }
    return HermitianFactors(gram).solve(right);
}

std::pair<std::complex<double>, double> MapRegression::products(std::size_t block,
                                                                const Eigen::VectorXcd& values) const {
    return {values.dot(blocks_[block].right), values.dot(blocks_[block].gram * values).real()};
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

Eigen::MatrixXd MapRegression::residuals() const {
    const auto count = static_cast<Eigen::Index>(blocks_.size());
    Eigen::MatrixXd found(count, count);
    const auto residual = [](const Block& block, const Vector& values) {
        const auto explained = values.dot(2.0 * block.scored_right - block.scored_gram * values);
        return std::max(block.squares.total - explained.real(), 0.0);
    };
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

Eigen::VectorXd MapRegression::reductions(const Matrix& values) const {
    const Matrix right = weighted_ * values;
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(values.cols());
    for (const Block& block : blocks_) {
        const Matrix own = weighted_(Eigen::all, block.windows) * values(block.windows, Eigen::all);
        const Matrix scored = weighted_(Eigen::all, block.scored) * values(block.scored, Eigen::all);
        const Matrix fits = HermitianFactors(gram_ - block.gram).solve(right - own);
        sums += fits.conjugate().cwiseProduct(2.0 * scored - block.scored_gram * fits).real().colwise().sum();
    }
    return sums;
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
