// SPDX-License-Identifier: MIT
#pragma once
// The notches that follow the speed, sample by sample, over float or double: the method runs them in double,
// and exported code is measured by them, for its C is these operations in this order
// (src/export/code/tracking_code.cpp).

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {

template <class Real>
class TrackingRun {
  public:
    /// tan(pi centre relative / sample rate): each user has its own way to it.
    using Warped = Real (*)(Real center_hz, Real relative, Real sample_rate_hz);

    TrackingRun(TrackingDesign design, Warped warped)
        : d_(std::move(design)), warped_(warped), lines_(d_.orders.size()) {
        for (Line& line : lines_) line.notches.resize(d_.spread.size());
    }

    /// The torque without ripple.
    Real next(Real torque_nm, Real speed_deg_s) {
        if (!started_) {
            started_ = true;
            origin_nm_ = torque_nm;
            speed_deg_s_ = speed_deg_s;
            follow(true);
        } else {
            // Signed speed is smoothed, so that a joint that turns round goes through zero.
            speed_deg_s_ = speed_deg_s + real(d_.speed_pole) * (speed_deg_s_ - speed_deg_s);
            if (speed_deg_s_ != tuned_for_deg_s_ || !arrived_) follow(false);
        }
        Real y = torque_nm - origin_nm_;
        for (Line& line : lines_) {
            for (Notch& n : line.notches) {
                const Real v3 = y - n.s2;
                const Real v1 = n.a1 * n.s1 + n.a2 * v3;
                const Real v2 = n.s2 + n.a2 * n.s1 + n.a3 * v3;
                n.s1 = v1 + v1 - n.s1;
                n.s2 = v2 + v2 - n.s2;
                y -= line.taken * (n.damping * v1);
            }
        }
        return origin_nm_ + y;
    }
    void restart() { started_ = false; }

    /// Frequency of a line at a joint speed.
    [[nodiscard]] Real hz(std::size_t line, Real speed_deg_s) const {
        return real(d_.orders[line]) * real(d_.gear_ratio) * std::abs(speed_deg_s) / 360;
    }
    /// Where the notch of a line at `hz` is put.
    [[nodiscard]] Real center_hz(Real hz) const {
        return std::clamp(hz, real(d_.min_hz), real(none_above_rate) * real(d_.sample_rate_hz));
    }
    [[nodiscard]] Real q_at(Real center_hz) const {
        return real(d_.q_each) * std::max(real(d_.narrow_hz) / center_hz, Real(1));
    }
    /// The remaining share of the line at the centre, for a line at `hz`.
    [[nodiscard]] Real left_at_center(std::size_t line, Real hz) const {
        const Real none = real(none_above_rate), full = real(full_below_rate);
        Real gain = real(d_.depth_gain);
        Real share = real(d_.weights[line]) * share_of((none - hz / real(d_.sample_rate_hz)) / (none - full));
        if (d_.parks) {
            // The square root of the gain moves linearly, as ArduPilot has it.
            const Real on = share_of((hz / real(d_.min_hz) - real(0.25)) / real(0.75));
            const Real root = 1 - on * (1 - std::sqrt(gain));
            gain = root * root;
        } else if (d_.fade_hz > 0.0) {
            share *= share_of((hz - real(d_.min_hz)) / real(d_.fade_hz));
        } else if (hz < real(d_.min_hz)) {
            share = 0;
        }
        return 1 - share * (1 - gain);
    }

  private:
    struct Notch {
        Real a1 = 0, a2 = 0, a3 = 0, damping = 0, s1 = 0, s2 = 0;
    };
    struct Line {
        Real center_hz = 0;
        Real taken = 0;  ///< share of the band-pass that is subtracted
        std::vector<Notch> notches;
    };

    static Real real(double value) { return static_cast<Real>(value); }
    static Real share_of(Real value) { return std::clamp(value, Real(0), Real(1)); }

    void follow(bool starts) {
        const Real slew = real(d_.slew);
        arrived_ = true;
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            Line& line = lines_[i];
            const Real at_hz = hz(i, speed_deg_s_), wanted = center_hz(at_hz);
            Real center = wanted;
            if (!starts && slew < 1)
                center = std::clamp(wanted, line.center_hz * (1 - slew), line.center_hz / (1 - slew));
            if (center != wanted) arrived_ = false;
            if (starts) std::fill(line.notches.begin(), line.notches.end(), Notch{});
            if (starts || center != line.center_hz) tune(line, center);
            line.taken = 1 - left_at_center(i, at_hz);
        }
        tuned_for_deg_s_ = speed_deg_s_;
    }
    void tune(Line& line, Real center) {
        line.center_hz = center;
        const Real damping = 1 / q_at(center);
        for (std::size_t j = 0; j < line.notches.size(); ++j) {
            const Real warped = warped_(center, real(d_.spread[j]), real(d_.sample_rate_hz));
            const Real a1 = 1 / (1 + warped * (warped + damping));
            Notch& n = line.notches[j];
            n.a1 = a1;
            n.a2 = warped * a1;
            n.a3 = warped * warped * a1;
            n.damping = damping;
        }
    }

    TrackingDesign d_;
    Warped warped_;
    std::vector<Line> lines_;
    Real origin_nm_ = 0, speed_deg_s_ = 0, tuned_for_deg_s_ = 0;
    bool started_ = false, arrived_ = false;
};

}  // namespace ripplenotch
