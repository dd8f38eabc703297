// SPDX-License-Identifier: MIT
#include "filter/map/ripple_windows.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr Eigen::Index trend_terms = 4;
constexpr double reversal_turns = 0.25;    // chosen, not derived: turns of the motor
constexpr double samples_a_period = 3.0;   // as in ripple_meter.cpp
constexpr double beyond_a_gap = 1e9;       // chosen, not derived: farther than any window
constexpr double trend_terms_reach = 1.5;  ///< cycles a window that a cubic may follow

}  // namespace

void MotorPath::next(double velocity_deg_s, const double* position_deg) noexcept {
    angle_.next(velocity_deg_s, position_deg);
    travelled_ += std::abs(angle_.step_turns());
}

void MotorPath::restart() noexcept {
    angle_.restart();
    travelled_ += beyond_a_gap;
}

RippleWindows::RippleWindows(std::vector<double> orders, double sample_rate_hz, RippleWindowRule rule)
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
    if (turned_back || too_long) {
        close();
        begin(path);
    } else if (std::abs(furthest_) >= rule_.turns) {
        close();
        keep_second_half();
    }
    turned = path.turns() - first_turns_;
    turns_.push_back(turned);
    torque_nm_.push_back(torque_nm);
    if (std::abs(turned) > std::abs(furthest_)) furthest_ = turned;
}

void RippleWindows::keep_second_half() {
    const auto half = std::find_if(turns_.begin(), turns_.end(), [this](double turned) {
        return std::abs(turned) >= 0.5 * std::abs(furthest_);
    });
    const auto cut = half - turns_.begin();
    const double moved = *half;
    turns_.erase(turns_.begin(), half);
    torque_nm_.erase(torque_nm_.begin(), torque_nm_.begin() + cut);
    for (double& turned : turns_) turned -= moved;
    first_turns_ += moved;
    first_travelled_ += std::abs(moved);
    furthest_ -= moved;
}

void RippleWindows::split() {
    close();
    turns_.clear();
}

std::vector<RippleWindow> RippleWindows::finish() {
    split();
    return std::move(windows_);
}

// Mean square of cosine and sine amplitude, as the fit of an order would find it, at half an order to both
// sides; 0 where every such place belongs to another order or to the trend.
double RippleWindows::background(std::size_t order, std::span<const double> residual,
                                 std::span<const double> weight) const {
    double sum = 0.0, places = 0.0;
    for (const double aside : {-0.5, 0.5}) {
        const double place = orders_[order] + aside;
        const bool taken = std::any_of(orders_.begin(), orders_.end(),
                                       [place](double other) { return std::abs(other - place) < 0.35; });
        if (taken || place * rule_.turns < trend_terms_reach) continue;
        std::complex<double> found = 0.0;
        double weights = 0.0;
        for (std::size_t k = 0; k < residual.size(); ++k) {
            const double cycles = place * turns_[k];
            found += weight[k] * residual[k] *
                     portable::polar(1.0, 2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
            weights += weight[k];
        }
        sum += std::norm(2.0 * found / weights);
        places += 1.0;
    }
    return places > 0.0 ? sum / places : 0.0;
}

// Weighted least squares of a cubic in time and every order in the motor angle. The angle is taken as it
// stands, so that phases of all windows are of one angle.
void RippleWindows::close() {
    const auto rows = static_cast<Eigen::Index>(turns_.size());
    const auto columns = trend_terms + static_cast<Eigen::Index>(2 * orders_.size());
    const double highest = *std::max_element(orders_.begin(), orders_.end());
    const bool sampled = static_cast<double>(rows) > samples_a_period * highest * std::abs(furthest_);
    if (std::abs(furthest_) < rule_.fewest_turns || rows < 2 * columns || !sampled) return;
    Eigen::MatrixXd basis(rows, columns);
    Eigen::VectorXd weight(rows);
    for (Eigen::Index k = 0; k < rows; ++k) {
        const auto row = static_cast<std::size_t>(k);
        const double place = (static_cast<double>(k) + 0.5) / static_cast<double>(rows);
        weight(k) = portable::sin(std::numbers::pi * place);
        double power = 1.0;
        for (Eigen::Index i = 0; i < trend_terms; ++i, power *= 2.0 * place - 1.0) basis(k, i) = power;
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const double cycles = orders_[i] * (first_turns_ + turns_[row]);
            const double phase = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
            const std::complex<double> phasor = portable::phasor(phase);
            basis(k, trend_terms + static_cast<Eigen::Index>(2 * i)) = phasor.real();
            basis(k, trend_terms + static_cast<Eigen::Index>(2 * i + 1)) = phasor.imag();
        }
    }
    const Eigen::Map<const Eigen::VectorXd> torque(torque_nm_.data(), rows);
    const Eigen::MatrixXd normal = basis.transpose() * weight.asDiagonal() * basis;
    const Eigen::VectorXd right = basis.transpose() * weight.asDiagonal() * torque;
    const Eigen::VectorXd fit = SymmetricFactors(normal).solve(right);
    if (!fit.allFinite()) return;
    const Eigen::VectorXd residual = torque - basis * fit;
    const double variance = residual.squaredNorm() / static_cast<double>(rows - columns);
    RippleWindow window;
    window.middle = first_travelled_ + 0.5 * std::abs(furthest_);
    window.length = std::abs(furthest_);
    window.speed_turns_s = furthest_ * rate_hz_ / static_cast<double>(rows);
    window.variance = 2.0 * variance * weight.squaredNorm() / portable::pow(weight.sum(), 2);
    window.middle_turns =
        first_turns_ + weight.dot(Eigen::Map<const Eigen::VectorXd>(turns_.data(), rows)) / weight.sum();
    const auto count = static_cast<std::size_t>(rows);
    for (std::size_t i = 0; i < orders_.size(); ++i) {
        const auto at = trend_terms + static_cast<Eigen::Index>(2 * i);
        window.amplitudes.emplace_back(fit(at), fit(at + 1));
        window.background.push_back(background(i, {residual.data(), count}, {weight.data(), count}));
    }
    windows_.push_back(std::move(window));
}

}  // namespace ripplenotch
