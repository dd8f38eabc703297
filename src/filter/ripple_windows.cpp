// SPDX-License-Identifier: MIT
#include "filter/ripple_windows.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ripplenotch {
namespace {

constexpr Eigen::Index trend_terms = 4;
constexpr double reversal_turns = 0.25;
constexpr double samples_a_period = 3.0;
constexpr double beyond_a_gap = 1e9;

}  // namespace

void MotorPath::next(double velocity_deg_s, const double* position_deg) noexcept {
    angle_.next(velocity_deg_s, position_deg);
    travelled_ += std::abs(angle_.step_turns());
}

void MotorPath::restart() noexcept {
    angle_.restart();
    travelled_ += beyond_a_gap;
}

RippleWindows::RippleWindows(std::vector<double> orders, double sample_rate_hz, WindowRule rule)
    : orders_(std::move(orders)), rate_hz_(sample_rate_hz), rule_(rule) {}

void RippleWindows::begin(const MotorPath& path) {
    turns_.clear();
    torque_nm_.clear();
    first_turns_ = path.turns();
    first_travelled_ = path.travelled();
    furthest_ = 0.0;
}

void RippleWindows::add(const MotorPath& path, double torque_nm) {
    if (turns_.empty()) begin(path);
    double turned = path.turns() - first_turns_;
    const bool turned_back =
        std::abs(furthest_) - std::abs(turned) > reversal_turns || turned * furthest_ < 0.0;
    const bool too_long = static_cast<double>(turns_.size()) >= rule_.longest_s * rate_hz_;
    if (turned_back || too_long || std::abs(furthest_) >= rule_.turns) {
        close();
        begin(path);
        turned = 0.0;
    }
    turns_.push_back(turned);
    torque_nm_.push_back(torque_nm);
    if (std::abs(turned) > std::abs(furthest_)) furthest_ = turned;
}

void RippleWindows::split() {
    close();
    turns_.clear();
}

std::vector<RippleWindow> RippleWindows::finish() {
    split();
    return std::move(windows_);
}

// Least squares of a cubic in time and every order in the motor angle. The angle is taken as it stands, so
// that phases of all windows are of one angle.
void RippleWindows::close() {
    const auto rows = static_cast<Eigen::Index>(turns_.size());
    const auto columns = trend_terms + static_cast<Eigen::Index>(2 * orders_.size());
    const double highest = *std::max_element(orders_.begin(), orders_.end());
    const bool sampled = static_cast<double>(rows) > samples_a_period * highest * std::abs(furthest_);
    if (std::abs(furthest_) < rule_.fewest_turns || rows < 2 * columns || !sampled) return;
    Eigen::MatrixXd basis(rows, columns);
    for (Eigen::Index k = 0; k < rows; ++k) {
        const auto row = static_cast<std::size_t>(k);
        const double s = 2.0 * static_cast<double>(k) / static_cast<double>(rows - 1) - 1.0;
        double power = 1.0;
        for (Eigen::Index i = 0; i < trend_terms; ++i, power *= s) basis(k, i) = power;
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const double cycles = orders_[i] * (first_turns_ + turns_[row]);
            const double phase = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
            basis(k, trend_terms + static_cast<Eigen::Index>(2 * i)) = std::cos(phase);
            basis(k, trend_terms + static_cast<Eigen::Index>(2 * i + 1)) = std::sin(phase);
        }
    }
    const Eigen::Map<const Eigen::VectorXd> torque(torque_nm_.data(), rows);
    const Eigen::LDLT<Eigen::MatrixXd> solver(basis.transpose() * basis);
    const Eigen::VectorXd fit = solver.solve(basis.transpose() * torque);
    if (!fit.allFinite()) return;
    const double residual = (torque - basis * fit).squaredNorm() / static_cast<double>(rows - columns);
    RippleWindow window;
    window.middle = first_travelled_ + 0.5 * std::abs(furthest_);
    window.speed_turns_s = furthest_ * rate_hz_ / static_cast<double>(rows);
    window.variance = 2.0 * residual / static_cast<double>(rows);
    for (std::size_t i = 0; i < orders_.size(); ++i) {
        const auto at = trend_terms + static_cast<Eigen::Index>(2 * i);
        window.amplitudes.emplace_back(fit(at), fit(at + 1));
    }
    windows_.push_back(std::move(window));
}

}  // namespace ripplenotch
