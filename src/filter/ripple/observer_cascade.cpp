// SPDX-License-Identifier: MIT
#include "filter/ripple/observer_cascade.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/matrices/factorisations.hpp"

namespace ripplenotch {
namespace {

// (1 + c1/z + c2/z^2) for each pair of roots: conjugates together, real ones two by two.
std::vector<std::pair<double, double>> quadratics(const Eigen::MatrixXd& matrix) {
    const Eigen::VectorXcd roots = eigenvalues(matrix);
    std::vector<std::pair<double, double>> factors;
    std::vector<double> real;
    for (const std::complex<double>& root : roots) {
        if (root.imag() > 0.0) factors.emplace_back(-2.0 * root.real(), std::norm(root));
        if (root.imag() == 0.0) real.push_back(root.real());
    }
    std::sort(real.begin(), real.end());
    for (std::size_t i = 0; i + 1 < real.size(); i += 2)
        factors.emplace_back(-(real[i] + real[i + 1]), real[i] * real[i + 1]);
    // By rising angle, so that zeros and poles of one order meet in one section.
    std::sort(factors.begin(), factors.end());
    return factors;
}

}  // namespace

Cascade settled_cascade(const RippleModel& model, double step_turns, std::vector<double> gain,
                        bool minus_ripple) {
    RippleModel used = model;
    if (gain.empty()) {
        if (minus_ripple) return {};
        used.orders.clear();
        gain = settled_gain(used, 1.0);
    }
    const auto m = static_cast<Eigen::Index>(used.states());
    const Eigen::Map<const Eigen::VectorXd> k(gain.data(), m);
    const RippleRotation frame = ripple_rotation(used, step_turns);
    const Eigen::Map<const Eigen::VectorXd> h(frame.seen.data(), m);
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> f(
        frame.step.data(), m, m);
    // z = A z + k y, out = c z + d y.
    const Eigen::MatrixXd a = (Eigen::MatrixXd::Identity(m, m) - k * h.transpose()) * f;
    Eigen::RowVectorXd c = Eigen::RowVectorXd::Zero(m);
    double direct = 0.0;
    if (minus_ripple) {
        c.tail(m - 2) = -h.tail(m - 2).transpose();
        direct = 1.0;
    } else {
        c(0) = 1.0;
    }
    direct += c.dot(k);
    const auto poles = quadratics(a);
    const auto zeros = quadratics(a - k * (c * a) / direct);
    Cascade cascade;
    double gain_at_zero = direct;
    for (std::size_t i = 0; i < poles.size(); ++i) {
        cascade.push_back({1.0, zeros[i].first, zeros[i].second, poles[i].first, poles[i].second});
        gain_at_zero *= dc_gain(cascade.back());
    }
    // The gain at 0 Hz is 1; rounding of the roots is taken out.
    for (double* b : {&cascade[0].b0, &cascade[0].b1, &cascade[0].b2}) *b *= direct / gain_at_zero;
    return cascade;
}

}  // namespace ripplenotch
