// SPDX-License-Identifier: MIT
#include "filter/ripple_kalman.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <utility>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

namespace {

double radians(double cycles) { return 2.0 * std::numbers::pi * (cycles - std::floor(cycles)); }

}  // namespace

// White noise of density q in the second derivative. With measurements of variance 1 every step_s the settled
// filter has the poles of a second-order Butterworth at (q / step_s)^(1/4).
RippleModel::TorqueNoise RippleModel::torque_noise() const noexcept {
    const double density = portable::pow(bandwidth_rad_s, 4) * step_s;
    return {density * portable::pow(step_s, 3) / 3.0, density * step_s * step_s / 2.0, density * step_s};
}

// A hundred times the settled variance: a log may begin amid a motion.
double RippleModel::first_rate_variance() const noexcept {
    return 100.0 * std::numbers::sqrt2 * portable::pow(bandwidth_rad_s, 3) * step_s;
}

// A pair alone settles to the gain step/memory: its amplitude forgets over memory_turns at any speed.
double RippleModel::amplitude_noise(double step_turns) const noexcept {
    const double share = step_turns / memory_turns;
    return 2.0 * share * share;
}

double RippleModel::share(double order, double step_turns) const noexcept {
    return share_below_rate(order * std::abs(step_turns));
}

RippleKalman::RippleKalman(RippleModel model, std::vector<AmplitudePrior> priors, GainSchedule* schedule)
    : model_(std::move(model)),
      priors_(std::move(priors)),
      schedule_(schedule),
      m_(model_.states()),
      torque_noise_(model_.torque_noise()),
      x_(m_),
      p_(m_ * m_),
      h_(m_),
      ph_(m_) {}

void RippleKalman::look(double motor_turns, double step_turns) noexcept {
    h_[0] = 1.0;
    h_[1] = 0.0;
    for (std::size_t i = 0; i < model_.orders.size(); ++i) {
        const double phase = radians(model_.orders[i] * motor_turns);
        const double share = model_.share(model_.orders[i], step_turns);
        const std::complex<double> on_circle = portable::phasor(phase);
        h_[2 + 2 * i] = share * on_circle.real();
        h_[3 + 2 * i] = share * on_circle.imag();
    }
}

double RippleKalman::ripple() const noexcept {
    double sum = 0.0;
    for (std::size_t i = 2; i < m_; ++i) sum += h_[i] * x_[i];
    return sum;
}

// Any torque: its variance is that of noise and ripple, and whatever the ripple turns out to be, the torque
// is the remainder.
void RippleKalman::start(double motor_turns) {
    look(motor_turns, 0.0);
    std::fill(p_.begin(), p_.end(), 0.0);
    double torque_variance = 1.0;
    for (std::size_t i = 2; i < m_; ++i) {
        const AmplitudePrior& prior = priors_[i / 2 - 1];
        const double variance = prior.deviation * prior.deviation;
        x_[i] = i % 2 == 0 ? prior.cosine : prior.sine;
        p_[i * m_ + i] = variance;
        p_[i] = p_[i * m_] = -variance * h_[i];
        torque_variance += variance * h_[i] * h_[i];
    }
    x_[0] = -ripple();
    x_[1] = 0.0;
    p_[0] = torque_variance;
    p_[m_ + 1] = model_.first_rate_variance();
    surprise_ = 0.0;
}

void RippleKalman::start_unloaded(double motor_turns, double measured) {
    start(motor_turns);
    x_[0] = 0.0;
    for (std::size_t i = 0; i < m_; ++i) {
        if (i != 1) p_[i] = p_[i * m_] = 0.0;
    }
    update(measured);
}

AmplitudePrior RippleKalman::amplitude(std::size_t order) const noexcept {
    const std::size_t i = 2 + 2 * order;
    return {x_[i], x_[i + 1], std::sqrt(p_[i * m_ + i] + p_[(i + 1) * m_ + i + 1])};
}

void RippleKalman::count_from(std::size_t order, double cosine, double sine) noexcept {
    x_[2 + 2 * order] -= cosine;
    x_[3 + 2 * order] -= sine;
}

// Amplitudes shrink by the same share, and their covariance with them.
void RippleKalman::forget(double step_turns) noexcept {
    const double kept = std::max(1.0 - std::abs(step_turns) / model_.return_turns, 0.0);
    for (std::size_t i = 2; i < m_; ++i) {
        x_[i] *= kept;
        for (std::size_t j = 0; j < m_; ++j) p_[i * m_ + j] *= kept;
        for (std::size_t j = 0; j < m_; ++j) p_[j * m_ + i] *= kept;
    }
}

void RippleKalman::predict(double step_turns) noexcept {
    const double dt = model_.step_s;
    x_[0] += dt * x_[1];
    // P = F P F' + Q, where F adds dt times row 1 to row 0.
    double* const row0 = p_.data();
    const double* const row1 = row0 + m_;
    for (std::size_t j = 0; j < m_; ++j) row0[j] += dt * row1[j];
    row0[0] += dt * row0[1];
    row0[0] += torque_noise_.torque;
    row0[1] += torque_noise_.cross;
    p_[m_ + 1] += torque_noise_.rate;
    for (std::size_t j = 1; j < m_; ++j) p_[j * m_] = row0[j];
    const double added = model_.amplitude_noise(step_turns);
    for (std::size_t i = 2; i < m_; ++i) p_[i * m_ + i] += added;
}

double RippleKalman::next(double measured, double motor_turns, double step_turns) {
    if (model_.return_turns > 0.0) forget(step_turns);
    if (schedule_ != nullptr) {
        x_[0] += model_.step_s * x_[1];
        look(motor_turns, step_turns);
        update_by_schedule(measured, step_turns);
        return x_[0];
    }
    predict(step_turns);
    look(motor_turns, step_turns);
    update(measured);
    return x_[0];
}

void RippleKalman::update(double measured) noexcept {
    double expected = 0.0, variance = 1.0;
    for (std::size_t i = 0; i < m_; ++i) {
        const double* const row = p_.data() + i * m_;
        double sum = 0.0;
        for (std::size_t j = 0; j < m_; ++j) sum += row[j] * h_[j];
        ph_[i] = sum;
        expected += h_[i] * x_[i];
        variance += h_[i] * sum;
    }
    const double surprise = measured - expected;
    // A sample that is nearly impossible under the model is no sudden growth of the ripple but a torque that
    // jumped.
    if (model_.jump > 0.0 && surprise * surprise > model_.jump * model_.jump * variance) {
        const double added = surprise * surprise;
        p_[0] += added;
        ph_[0] += added;
        variance += added;
    }
    const double scale = 1.0 / variance;
    surprise_ = surprise * scale;
    settled_variance_ = 0.0;
    for (std::size_t i = 0; i < m_; ++i) {
        const double gain = ph_[i] * scale;
        x_[i] += gain * surprise;
        // Both triangles from the same product, so that P stays symmetric to the last bit.
        for (std::size_t j = i; j < m_; ++j) p_[j * m_ + i] = p_[i * m_ + j] -= gain * ph_[j];
    }
}

// The schedule's gains are of the frame that turns with the motor; the amplitudes stand still.
void RippleKalman::update_by_schedule(double measured, double step_turns) {
    schedule_->at(step_turns, ph_);
    double expected = x_[0], taken = ph_[0];
    for (std::size_t i = 2; i < m_; i += 2) {
        const double cosine = h_[i], sine = h_[i + 1], ahead = ph_[i], across = ph_[i + 1];
        ph_[i] = ahead * cosine - across * sine;
        ph_[i + 1] = ahead * sine + across * cosine;
        expected += cosine * x_[i] + sine * x_[i + 1];
        taken += cosine * ph_[i] + sine * ph_[i + 1];
    }
    const double surprise = measured - expected;
    // P h = K (1 + h' P h) = K / (1 - h' K): about the variance of ripple once settled.
    surprise_ = surprise;
    settled_variance_ = 1.0 / std::max(1.0 - taken, 1e-3);
    for (std::size_t i = 0; i < m_; ++i) x_[i] += ph_[i] * surprise;
}

double RippleKalman::phase_advance_turns() const noexcept {
    double advance = 0.0, weights = 0.0;
    for (std::size_t i = 2; i < m_; i += 2) {
        // ripple = Re(z exp(-i n theta)), z = cosine + i sine: a phase that runs ahead turns z backward.
        const double c = x_[i], s = x_[i + 1], square = c * c + s * s;
        const double doubt = schedule_ != nullptr ? 2.0 * settled_variance_ *
                                                        std::sqrt(ph_[i] * ph_[i] + ph_[i + 1] * ph_[i + 1])
                                                  : p_[i * m_ + i] + p_[(i + 1) * m_ + i + 1];
        if (square <= 9.0 * doubt) continue;
        const double turned = (c * ph_[i + 1] - s * ph_[i]) * surprise_;
        const double order = model_.orders[i / 2 - 1];
        advance -= order * turned;
        weights += order * order * square;
    }
    return weights > 0.0 ? advance / (2.0 * std::numbers::pi * weights) : 0.0;
}

RippleRotation ripple_rotation(const RippleModel& model, double step_turns) {
    const std::size_t m = model.states();
    RippleRotation frame{std::vector<double>(m * m), std::vector<double>(m)};
    frame.step[0] = frame.step[m + 1] = frame.seen[0] = 1.0;
    frame.step[1] = model.step_s;
    for (std::size_t i = 2; i < m; i += 2) {
        const double order = model.orders[i / 2 - 1], phase = radians(order * step_turns);
        frame.step[i * m + i] = frame.step[(i + 1) * m + i + 1] = portable::cos(phase);
        frame.step[i * m + i + 1] = portable::sin(phase);
        frame.step[(i + 1) * m + i] = -portable::sin(phase);
        frame.seen[i] = model.share(order, step_turns);
    }
    return frame;
}

std::vector<double> settled_gain(const RippleModel& model, double step_turns) {
    if (step_turns == 0.0) return {};
    const auto m = static_cast<Eigen::Index>(model.states());
    const RippleRotation frame = ripple_rotation(model, step_turns);
    // Doubling for the Riccati equation P = F (P - P h (1 + h' P h)^-1 h' P) F' + Q: A = F', G = h h', S = Q.
    // Read column by column, frame.step is F'.
    Eigen::MatrixXd a = Eigen::Map<const Eigen::MatrixXd>(frame.step.data(), m, m);
    const Eigen::VectorXd h = Eigen::Map<const Eigen::VectorXd>(frame.seen.data(), m);
    Eigen::MatrixXd s = Eigen::MatrixXd::Zero(m, m);
    const auto noise = model.torque_noise();
    s(0, 0) = noise.torque;
    s(0, 1) = s(1, 0) = noise.cross;
    s(1, 1) = noise.rate;
    for (Eigen::Index i = 2; i < m; ++i) s(i, i) = model.amplitude_noise(step_turns);
    Eigen::MatrixXd g = h * h.transpose();
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(m, m);
    for (int round = 0; round < 60; ++round) {
        const SquareFactors solver(one + g * s);
        const Eigen::MatrixXd wa = solver.solve(a), wg = solver.solve(g);
        const Eigen::MatrixXd added = a.transpose() * s * wa;
        g += a * wg * a.transpose();
        s += added;
        s = 0.5 * (s + s.transpose()).eval();
        g = 0.5 * (g + g.transpose()).eval();
        a = a * wa;
        if (!(added.norm() > 1e-15 * s.norm())) break;
    }
    const Eigen::VectorXd ph = s * h;
    const Eigen::VectorXd gain = ph / (1.0 + h.dot(ph));
    if (!gain.allFinite()) return {};
    return {gain.data(), gain.data() + m};
}

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
    // The gain at 0 Hz is 1; rounding of the roots is corrected.
    for (double* b : {&cascade[0].b0, &cascade[0].b1, &cascade[0].b2}) *b *= direct / gain_at_zero;
    return cascade;
}

namespace {

// From a motor turn in 30 000 samples, where the ripple's gain is next to nothing, to half a turn a sample of
// the lowest order.
constexpr double slowest_turns = 0x1p-15;
constexpr std::size_t points_an_octave = 8;  ///< evenly from an octave's beginning to twice it

// Orders beyond half the sample rate are ignored and have no gain.
std::vector<double> gain_of(const RippleModel& model, double step_turns) {
    RippleModel seen = model;
    std::erase_if(seen.orders, [&](double order) { return model.share(order, step_turns) == 0.0; });
    const bool turns = !seen.orders.empty() && step_turns > 0.0;
    if (!turns) seen.orders.clear();
    auto found = settled_gain(seen, turns ? step_turns : 1.0);
    std::vector<double> gain(model.states());
    if (found.empty()) return gain;
    std::copy_n(found.begin(), 2, gain.begin());
    for (std::size_t i = 0, from = 2; i < model.orders.size() && from < found.size(); ++i) {
        if (model.share(model.orders[i], step_turns) == 0.0) continue;
        gain[2 + 2 * i] = found[from];
        gain[3 + 2 * i] = found[from + 1];
        from += 2;
    }
    return gain;
}

}  // namespace

GainSchedule::GainSchedule(RippleModel model) : model_(std::move(model)) {
    const double lowest = *std::min_element(model_.orders.begin(), model_.orders.end());
    const double octaves = std::ceil(std::max(portable::log2(0.5 / lowest / slowest_turns), 1.0));
    gains_.resize(2 + points_an_octave * static_cast<std::size_t>(octaves));
}

void GainSchedule::at(double step_turns, std::span<double> gain) {
    // Between which points the speed lies; before the first one there is standstill.
    double share = std::abs(step_turns) / slowest_turns;
    std::size_t before = 0;
    if (share >= 1.0) {
        // The number's own exponent is its octave, its mantissa the place in it.
        const auto bits = std::bit_cast<std::uint64_t>(share);
        const auto octave = static_cast<std::size_t>((bits >> 52U) - 1023U);
        share = (share / std::bit_cast<double>(bits & (0x7ffULL << 52U)) - 1.0) * points_an_octave;
        const auto point = static_cast<std::size_t>(share);
        const std::size_t at = 1 + octave * points_an_octave + point, last = gains_.size() - 1;
        share = at < last ? share - static_cast<double>(point) : 1.0;
        before = std::min(at, last - 1);
    }
    const auto known = [&](std::size_t i) -> const std::vector<double>& {
        const double within = 1.0 + static_cast<double>((i - 1) % points_an_octave) / points_an_octave;
        const auto octave = static_cast<int>((i - 1) / points_an_octave);
        if (gains_[i].empty())
            gains_[i] = gain_of(model_, i == 0 ? 0.0 : slowest_turns * std::ldexp(within, octave));
        return gains_[i];
    };
    const std::vector<double>&low = known(before), &high = known(before + 1);
    for (std::size_t i = 0; i < low.size(); ++i) gain[i] = low[i] + share * (high[i] - low[i]);
    for (std::size_t i = 3; step_turns < 0.0 && i < low.size(); i += 2) gain[i] = -gain[i];
}

}  // namespace ripplenotch
