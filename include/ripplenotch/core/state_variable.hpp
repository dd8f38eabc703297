// SPDX-License-Identifier: MIT
#pragma once
// A second-order band-pass in trapezoidal state-variable form. Its memory is two integrators, which keep
// their meaning when the centre moves, so that it can be retuned at every sample without a transient.

namespace ripplenotch {

/// H(s) = (w0/Q) s / (s^2 + (w0/Q) s + w0^2), 1 at the centre; at a fixed centre the same sampled filter as
/// the bilinear transform prewarped there. Source: V. Zavalishin, The Art of VA Filter Design, 2018, ch. 4;
/// stable for any course of the centre (J. Laroche, J. Audio Eng. Soc. 55, 2007: the trapezoidal rule applied
/// to a passive network).
struct BandPassTuning {
    double a1 = 1.0, a2 = 0.0, a3 = 0.0, damping = 1.0;
    bool operator==(const BandPassTuning&) const = default;

    struct Shape {
        double warped = 0.0;  ///< tan(pi * centre / sample rate), above 0
        double q = 0.0;       ///< above 0
    };
    static BandPassTuning at(const Shape& shape) noexcept {
        const double warped = shape.warped, damping = 1.0 / shape.q;
        const double a1 = 1.0 / (1.0 + warped * (warped + damping));
        return {a1, warped * a1, warped * warped * a1, damping};
    }
};

/// Memory of one band-pass; all zero is the settled state of the input 0.
struct BandPassState {
    double s1 = 0.0, s2 = 0.0;
};

inline double step(const BandPassTuning& f, BandPassState& s, double x) noexcept {
    const double v3 = x - s.s2;
    const double v1 = f.a1 * s.s1 + f.a2 * v3;
    const double v2 = s.s2 + f.a2 * s.s1 + f.a3 * v3;
    s.s1 = 2.0 * v1 - s.s1;
    s.s2 = 2.0 * v2 - s.s2;
    return f.damping * v1;
}

}  // namespace ripplenotch
