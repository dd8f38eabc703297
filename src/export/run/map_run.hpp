// SPDX-License-Identifier: MIT
#pragma once
// Amplitudes of a map as its C computes them, operation by operation, in the header's precision.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "export/code/map_code.hpp"
#include "export/code/method_code.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

/// The place of an earlier order that this one is twice of; its own where there is none.
template <class Real>
[[nodiscard]] std::size_t half_of(const std::vector<Real>& orders, std::size_t i) {
    for (std::size_t j = 0; j < i; ++j)
        if (orders[i] == 2 * orders[j]) return j;
    return i;
}

/// How each order shows at an angle: cosine, sine.
template <class Real>
void order_angles(const std::vector<Real>& orders, Real turns, std::vector<Real>& shows) {
    for (std::size_t i = 0; i < orders.size(); ++i) {
        if (const std::size_t half = half_of(orders, i); half < i) {
            const Real c = shows[2 * half], s = shows[2 * half + 1];
            shows[2 * i] = 1 - (s + s) * s;
            shows[2 * i + 1] = (s + s) * c;
        } else {
            const OnCircle<Real> at = on_circle(orders[i] * turns);
            shows[2 * i] = at.cosine;
            shows[2 * i + 1] = at.sine;
        }
    }
}

template <class Real>
class MapRun {
  public:
    MapRun(const RippleMap& map, const MapTables& tables)
        : form_(map.form),
          orders_(map.orders.size()),
          speeds_(tables.speeds.begin(), tables.speeds.end()),
          slopes_(tables.slopes.begin(), tables.slopes.end()),
          offsets_(tables.offsets.begin(), tables.offsets.end()),
          limits_(tables.limits.begin(), tables.limits.end()),
          table_(tables.amplitudes.begin(), tables.amplitudes.end()),
          z_(2 * with_combs_apart(map).orders.size()),
          other_(z_.size()),
          sum_(2 * orders_.size()) {
        for (std::size_t i = 0; i < orders_.size(); ++i)
            orders_[i] = static_cast<Real>(map.orders[i].value());
    }

    /// Cosine and sine amplitude of each order, Nm.
    const std::vector<Real>& at(const CodeInput& in) {
        find_amplitudes(in);
        if (form_.second_comb == 0) return z_;
        const Real turned =
            static_cast<Real>(in.joint_deg) * static_cast<Real>(0.002777777777777778) + limits_[1];
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            const OnCircle<Real> at = on_circle(orders_[i] * turned);
            const Real s = form_.second_comb > 0 ? at.sine : -at.sine;
            const Real* const second = z_.data() + 2 * (orders_.size() + i);
            sum_[2 * i] = z_[2 * i] + (at.cosine * second[0] + s * second[1]);
            sum_[2 * i + 1] = z_[2 * i + 1] + (at.cosine * second[1] - s * second[0]);
        }
        return sum_;
    }

  private:
    void find_amplitudes(const CodeInput& in) {
        const Real speed = static_cast<Real>(in.speed_deg_s);
        find_speed(in);
        if (form_.directions == 1) {
            add_up(table_.data(), z_);
            return;
        }
        const std::size_t half = table_.size() / 2;
        add_up(table_.data() + (speed <= -limits_[0] ? half : 0), z_);
        if (speed >= limits_[0] || speed <= -limits_[0]) return;
        const Real middle = static_cast<Real>(0.5), share = middle - middle * speed / limits_[0];
        add_up(table_.data() + half, other_);
        for (std::size_t i = 0; i < z_.size(); ++i) z_[i] = share * (other_[i] - z_[i]) + z_[i];
    }
    void find_speed(const CodeInput& in) {
        if (speeds_.size() > 1) {
            const Real size = std::abs(static_cast<Real>(in.speed_deg_s));
            at_ = 0;
            while (at_ + 2 < speeds_.size() && speeds_[at_ + 1] < size) ++at_;
            along_ = std::clamp(size * slopes_[at_] + offsets_[at_], static_cast<Real>(-0.5),
                                static_cast<Real>(0.5));
        }
    }
    void add_up(const Real* v, std::vector<Real>& sums) const {
        const std::size_t parts = sums.size();
        const Real* const low = v + 2 * parts * at_;
        for (std::size_t i = 0; i < parts; ++i)
            sums[i] = speeds_.size() > 1 ? along_ * low[i + parts] + low[i] : v[i];
    }

    MapForm form_;
    std::vector<Real> orders_, speeds_, slopes_, offsets_, limits_, table_, z_, other_, sum_;
    std::size_t at_ = 0;
    Real along_ = 0;
};

}  // namespace ripplenotch
