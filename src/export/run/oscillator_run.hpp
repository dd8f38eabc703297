// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "export/code/method_code.hpp"
#include "export/run/map_run.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {

// The oscillator as its C header computes it, in the header's precision.
//
// It is the filter of filter/ripple_kalman.hpp in other coordinates. There the first state is the
// torque; here it is torque and ripple together, the measured value. A sample then measures one state alone,
// and a cold start has no prior on how the two share it: its covariance is diagonal, and no digits are lost
// to cancelling large correlations. The decay of the amplitudes is applied to their measurement weights, one
// number for all of them, and to the amplitudes themselves where that has sunk to a half.

/// Places in the header's array of values. The torque's rate is per sample.
struct OscillatorValue {
    enum : std::size_t {
        noise_nm,
        seen_noise,  ///< variance of the sensor's noise, which is 1, plus the torque's increment in a sample
        cross_noise,
        rate_noise,
        first_rate_variance,
        amplitude_noise,  ///< deviation that a turn of the motor adds to an amplitude
        quarter_memory,   ///< 0.25 / memory in turns
        jump,
        largest_slip,
        turns_to_return,  ///< 1 / return, 0 for never
        in_noise,         ///< 1 / noise
        count
    };
};

/// Periods of the lowest order in a sample above which the angle's rate is corrected.
inline constexpr double slowest_corrected_periods = 1e-5;

template <class Real>
class OscillatorRun {
    using Value = OscillatorValue;

  public:
    /// Arrays as in the header; `waits`: OscillatorDesign::waits.
    OscillatorRun(const std::vector<double>& orders, const std::vector<double>& priors,
                  const std::vector<double>& values, bool minus_ripple, bool waits,
                  std::optional<MapRun<Real>> map)
        : orders_(orders.begin(), orders.end()),
          priors_(priors.begin(), priors.end()),
          c_(values.begin(), values.end()),
          minus_ripple_(minus_ripple),
          waits_(waits),
          map_(std::move(map)),
          m_(2 + 2 * orders.size()),
          x_(m_),
          h_(m_ - 2),
          before_(m_ - 2),
          v_(m_),
          p_(m_ * m_),
          slowest_fade_(static_cast<Real>(full_below_rate / *std::max_element(orders.begin(), orders.end()))),
          lowest_(static_cast<Real>(*std::min_element(orders.begin(), orders.end()))),
          slowest_corrected_(static_cast<Real>(slowest_corrected_periods /
                                               *std::min_element(orders.begin(), orders.end()))) {}

    double step(const CodeInput& in) {
        const Real turns = static_cast<Real>(in.motor_turns);
        Real torque = static_cast<Real>(in.torque_nm);
        if (!started_) turns_ = turns;
        Real moved = turns - turns_;
        moved = beside_whole(moved);
        const Real step = moved * slip_ + moved;
        if (started_) follow_slip(moved);
        look(turns + slipped_, std::abs(step));
        torque -= mapped(in);
        if (started_) {
            waited_ += std::abs(step) * lowest_;
            forget(std::abs(step));
            predict(std::abs(step));
            update((torque - origin_) * c_[Value::in_noise]);
            correct(step);
        } else {
            begin(torque);
        }
        before_ = h_;
        turns_ = turns;
        Real ripple = 0;
        for (std::size_t i = 2; i < m_; ++i) ripple += h_[i - 2] * x_[i];
        const Real clean = minus_ripple_ ? torque - c_[Value::noise_nm] * ripple
                                         : c_[Value::noise_nm] * (x_[0] - ripple) + origin_;
        return static_cast<double>(faded_in(torque, clean));
    }

  private:
    Real& p(std::size_t i, std::size_t j) { return i < j ? p_[i * m_ + j] : p_[j * m_ + i]; }

    // Added up with what rounding took off before (Kahan).
    void follow_slip(Real moved) {
        const Real added = moved * slip_ - lost_, slipped = slipped_ + added;
        lost_ = (slipped - slipped_) - added;
        slipped_ = slipped - static_cast<Real>(static_cast<int>(slipped));
    }
    void look(Real turns, Real size) {
        const Real none = static_cast<Real>(none_above_rate), full = static_cast<Real>(full_below_rate);
        order_angles(orders_, turns, h_);
        squares_ = static_cast<Real>(orders_.size());
        if (!(size > slowest_fade_)) return;
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const Real rate = orders_[i] * size;
            if (!(rate > full)) continue;
            const Real share = rate < none ? (none - rate) / (none - full) : Real(0);
            h_[2 * i] *= share;
            h_[2 * i + 1] *= share;
            squares_ -= 1 - share * share;
        }
    }
    Real mapped(const CodeInput& in) {
        if (!map_) return 0;
        const auto& z = map_->at(in);
        Real sum = 0;
        for (std::size_t i = 0; i < z.size(); ++i) sum += z[i] * h_[i];
        return sum;
    }
    // What is learnt counts once the motor has turned far enough to tell it from the torque.
    Real faded_in(Real torque, Real clean) {
        constexpr Real from = static_cast<Real>(OscillatorWait::from),
                       until = static_cast<Real>(OscillatorWait::until);
        if (!waits_ || !(waited_ < until)) return clean;
        const Real share = (waited_ - from) / (until - from);
        return share > 0 ? share * (clean - torque) + torque : torque;
    }
    void begin(Real torque) {
        started_ = true;
        origin_ = torque;
        x_[0] = x_[1] = 0;
        p(0, 0) = 1;
        p(1, 1) = c_[Value::first_rate_variance];
        for (std::size_t i = 2; i < m_; ++i) {
            const Real* const prior = priors_.data() + 3 * (i / 2 - 1);
            x_[i] = prior[i % 2];
            p(i, i) = prior[2] * prior[2];
        }
    }
    void forget(Real size) {
        if (!(c_[Value::turns_to_return] > 0)) return;
        left_ *= 1 - size * c_[Value::turns_to_return];
        if (left_ < static_cast<Real>(0.5)) bring_back();
        for (Real& shows : h_) shows *= left_;
    }
    void bring_back() {
        for (std::size_t i = 2; i < m_; ++i) {
            x_[i] *= left_;
            before_[i - 2] /= left_;
            p(0, i) *= left_;
            p(1, i) *= left_;
            for (std::size_t j = i; j < m_; ++j) p(i, j) *= left_ * left_;
        }
        left_ = 1;
    }
    // First state += rate + how much each amplitude shows now less how much it showed before.
    void predict(Real size) {
        const Real strays = size * c_[Value::amplitude_noise], strays_here = strays / left_;
        const Real added = strays * strays, more = strays_here * strays_here;
        for (std::size_t k = 0; k < before_.size(); ++k) before_[k] = h_[k] - before_[k];
        for (std::size_t i = 0; i < m_; ++i) {
            v_[i] = p(0, i) + p(1, i);
            for (std::size_t k = 2; k < m_; ++k) v_[i] += before_[k - 2] * p(k, i);
        }
        Real first = v_[0] + v_[1], expected = x_[0] + x_[1];
        for (std::size_t k = 2; k < m_; ++k) first += before_[k - 2] * v_[k];
        for (std::size_t k = 2; k < m_; ++k) expected += before_[k - 2] * x_[k];
        variance_ = added * squares_ + first + c_[Value::seen_noise];
        v_[1] += c_[Value::cross_noise];
        x_[0] = expected;
        p(1, 1) += c_[Value::rate_noise];
        for (std::size_t i = 2; i < m_; ++i) {
            v_[i] += more * h_[i - 2];
            p(i, i) += more;
        }
    }
    void update(Real measured) {
        const Real surprise = measured - x_[0];
        if (c_[Value::jump] > 0 && surprise * surprise > c_[Value::jump] * c_[Value::jump] * variance_)
            variance_ += surprise * surprise;
        const Real scale = 1 / variance_;
        surprise_ = surprise * scale;
        for (std::size_t i = 0; i < m_; ++i) {
            const Real gain = i == 0 ? 1 - scale : v_[i] * scale;
            x_[i] += gain * surprise;
            // The updated covariance of the first state is the gain itself.
            p(0, i) = gain;
            for (std::size_t j = std::max<std::size_t>(i, 1); i > 0 && j < m_; ++j) p(i, j) -= gain * v_[j];
        }
    }
    // Corrects the angle's rate from the ripple's phase.
    void correct(Real step) {
        const Real most = c_[Value::largest_slip], size = std::abs(step);
        if (!(most > 0) || !(size > slowest_corrected_)) return;
        Real ahead = 0, weights = 0;
        for (std::size_t i = 2; i < m_; i += 2) {
            const Real a = x_[i], b = x_[i + 1], n = orders_[i / 2 - 1], square = a * a + b * b;
            if (square <= 9 * (p(i, i) + p(i + 1, i + 1))) continue;
            ahead -= n * (a * v_[i + 1] - b * v_[i]);
            weights += n * n * square;
        }
        if (!(weights > 0)) return;
        const Real share = std::min(size * c_[Value::quarter_memory], static_cast<Real>(0.01));
        slip_ += share * (ahead * surprise_) / (static_cast<Real>(6.283185307179586) * weights * step);
        slip_ = std::clamp(slip_, -most, most);
    }

    std::vector<Real> orders_, priors_, c_;
    bool minus_ripple_, waits_;
    std::optional<MapRun<Real>> map_;
    std::size_t m_;
    std::vector<Real> x_, h_, before_, v_, p_;  ///< p_: above the diagonal; v_: its first row before a sample
    Real slowest_fade_;                         ///< turns a sample at which the first order begins to fade
    Real lowest_;                               ///< order
    Real waited_ = 0;                           ///< periods of OscillatorWait
    Real slowest_corrected_;                    ///< turns a sample above which the angle's rate is corrected
    Real left_ = 1;  ///< remaining share of the amplitudes, since they were last rescaled
    Real origin_ = 0, turns_ = 0, slip_ = 0, slipped_ = 0, lost_ = 0, surprise_ = 0, squares_ = 0,
         variance_ = 0;
    bool started_ = false;
};

/// The body of the oscillator's step, as export/run/oscillator_run.hpp computes it; fields as CodeStyle fills
/// them.
[[nodiscard]] std::string oscillator_step_code(const OscillatorDesign& design);

}  // namespace ripplenotch
