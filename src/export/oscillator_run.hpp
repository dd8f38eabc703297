// SPDX-License-Identifier: MIT
#pragma once
// The oscillator as its C header computes it, in the header's precision.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "export/method_code_parts.hpp"

namespace ripplenotch {

/// The place of an earlier order that this one is twice of; its own where there is none.
template <class Real>
[[nodiscard]] std::size_t half_of(const std::vector<Real>& orders, std::size_t i) {
    for (std::size_t j = 0; j < i; ++j)
        if (orders[i] == 2 * orders[j]) return j;
    return i;
}

template <class Real>
class OscillatorRun {
  public:
    /// Arrays as in the header.
    OscillatorRun(const std::vector<double>& orders, const std::vector<double>& priors,
                  const std::vector<double>& values, bool minus_ripple)
        : orders_(orders.begin(), orders.end()),
          priors_(priors.begin(), priors.end()),
          c_(values.begin(), values.end()),
          minus_ripple_(minus_ripple),
          m_(2 + 2 * orders.size()),
          x_(m_),
          h_(m_),
          ph_(m_),
          p_(m_ * m_) {}

    double step(double torque_nm, double motor_turns) {
        const Real torque = static_cast<Real>(torque_nm), turns = static_cast<Real>(motor_turns);
        if (!started_) {
            begin(torque, turns);
        } else {
            Real moved = turns - turns_;
            moved -= std::floor(moved + static_cast<Real>(0.5));
            const Real step = moved * (1 + slip_);
            const Real added = moved * slip_ - lost_, slipped = slipped_ + added;
            lost_ = (slipped - slipped_) - added;
            slipped_ = slipped > 1 ? slipped - 1 : slipped < -1 ? slipped + 1 : slipped;
            predict(step);
            look(turns + slipped_, step);
            update((torque - origin_) / c_[1]);
            correct(step);
        }
        turns_ = turns;
        return static_cast<double>(minus_ripple_ ? torque - c_[1] * ripple() : origin_ + c_[1] * x_[0]);
    }

  private:
    Real& p(std::size_t i, std::size_t j) { return p_[i * m_ + j]; }

    void look(Real turns, Real step) {
        const Real none = static_cast<Real>(0.48), full = static_cast<Real>(0.45);
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            if (const std::size_t half = 2 * half_of(orders_, i); half < 2 * i) {
                h_[2 + 2 * i] = 1 - 2 * h_[3 + half] * h_[3 + half];
                h_[3 + 2 * i] = 2 * h_[2 + half] * h_[3 + half];
                continue;
            }
            const Real cycles = orders_[i] * turns;
            const OnCircle<Real> at = on_circle(cycles - std::floor(cycles));
            h_[2 + 2 * i] = at.cosine;
            h_[3 + 2 * i] = at.sine;
        }
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const Real rate = orders_[i] * std::abs(step);
            if (!(rate > full)) continue;
            const Real share = rate < none ? (none - rate) / (none - full) : Real(0);
            h_[2 + 2 * i] *= share;
            h_[3 + 2 * i] *= share;
        }
    }
    [[nodiscard]] Real ripple() const {
        Real sum = 0;
        for (std::size_t i = 2; i < m_; ++i) sum += h_[i] * x_[i];
        return sum;
    }
    void begin(Real torque, Real turns) {
        started_ = true;
        origin_ = torque;
        look(turns, 0);
        Real variance = 1;
        for (std::size_t i = 2; i < m_; ++i) {
            const Real* const prior = priors_.data() + 3 * (i / 2 - 1);
            const Real square = prior[2] * prior[2];
            x_[i] = prior[i % 2];
            p(i, i) = square;
            p(0, i) = -square * h_[i];
            variance += square * h_[i] * h_[i];
        }
        x_[0] = -ripple();
        x_[1] = 0;
        p(0, 0) = variance;
        p(1, 1) = c_[5];
    }
    void predict(Real step) {
        const Real share = step / c_[6], added = 2 * share * share;
        x_[0] += c_[0] * x_[1];
        p(0, 0) += c_[0] * p(0, 1);
        for (std::size_t j = 1; j < m_; ++j) p(0, j) += c_[0] * p(1, j);
        p(0, 0) += c_[0] * p(0, 1);
        p(0, 0) += c_[2];
        p(0, 1) += c_[3];
        p(1, 1) += c_[4];
        for (std::size_t j = 2; j < m_; ++j) p(j, j) += added;
    }
    void update(Real measured) {
        Real expected = x_[0], variance = 1;
        for (std::size_t i = 0; i < m_; ++i) {
            Real sum = p(0, i);
            for (std::size_t j = 2; j < m_; ++j) sum += (i < j ? p(i, j) : p(j, i)) * h_[j];
            ph_[i] = sum;
            if (i == 0) variance += sum;
            if (i >= 2) {
                expected += h_[i] * x_[i];
                variance += h_[i] * sum;
            }
        }
        const Real surprise = measured - expected;
        if (c_[7] > 0 && surprise * surprise > c_[7] * c_[7] * variance) {
            const Real added = surprise * surprise;
            p(0, 0) += added;
            ph_[0] += added;
            variance += added;
        }
        const Real scale = 1 / variance;
        surprise_ = surprise * scale;
        for (std::size_t i = 0; i < m_; ++i) {
            const Real gain = ph_[i] * scale;
            x_[i] += gain * surprise;
            for (std::size_t j = i; j < m_; ++j) p(i, j) -= gain * ph_[j];
        }
    }
    void correct(Real step) {
        const Real most = c_[8], size = std::abs(step);
        if (!(most > 0) || !(size > static_cast<Real>(1e-5))) return;
        const Real share = std::min(size / (4 * c_[6]), static_cast<Real>(0.01));
        slip_ = std::clamp(slip_ + share * ahead() / step, -most, most);
    }
    [[nodiscard]] Real ahead() {
        Real advance = 0, weights = 0;
        for (std::size_t i = 2; i < m_; i += 2) {
            const Real a = x_[i], b = x_[i + 1], n = orders_[i / 2 - 1], square = a * a + b * b;
            if (square <= 9 * (p(i, i) + p(i + 1, i + 1))) continue;
            advance -= n * ((a * ph_[i + 1] - b * ph_[i]) * surprise_);
            weights += n * n * square;
        }
        return weights > 0 ? advance / (static_cast<Real>(6.283185307179586) * weights) : Real(0);
    }

    std::vector<Real> orders_, priors_, c_;
    bool minus_ripple_;
    std::size_t m_;
    std::vector<Real> x_, h_, ph_, p_;  ///< p_: above the diagonal
    Real origin_ = 0, turns_ = 0, slip_ = 0, slipped_ = 0, lost_ = 0, surprise_ = 0;
    bool started_ = false;
};

}  // namespace ripplenotch
