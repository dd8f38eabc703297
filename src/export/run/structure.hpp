// SPDX-License-Identifier: MIT
#pragma once
// The three structures in which targets compute a section, over float or double: the same operations in the
// same order as the code that is exported, so that both give the same bits where nothing is contracted.

#include "ripplenotch/export/arithmetic.hpp"

namespace ripplenotch {

template <class Real>
struct DirectForm1 {
    struct Coefficients {
        Real b0, b1, b2, a1, a2;
    };
    struct State {
        Real x1{}, x2{}, y1{}, y2{};
    };
    static Coefficients coefficients(const LoadedSection& s) {
        return {static_cast<Real>(s.biquad.b0), static_cast<Real>(s.biquad.b1),
                static_cast<Real>(s.biquad.b2), static_cast<Real>(s.biquad.a1),
                static_cast<Real>(s.biquad.a2)};
    }
    static State settled(const Coefficients&, Real x) { return {x, x, x, x}; }
    static Real step(const Coefficients& c, State& s, Real x) {
        const Real y = c.b0 * x + c.b1 * s.x1 + c.b2 * s.x2 - c.a1 * s.y1 - c.a2 * s.y2;
        s.x2 = s.x1;
        s.x1 = x;
        s.y2 = s.y1;
        s.y1 = y;
        return y;
    }
};

template <class Real>
struct TransposedForm2 {
    using Coefficients = typename DirectForm1<Real>::Coefficients;
    struct State {
        Real s1{}, s2{};
    };
    static Coefficients coefficients(const LoadedSection& s) { return DirectForm1<Real>::coefficients(s); }
    static State settled(const Coefficients& c, Real x) {
        const Real s2 = (c.b2 - c.a2) * x;
        return {(c.b1 - c.a1) * x + s2, s2};
    }
    static Real step(const Coefficients& c, State& s, Real x) {
        const Real y = c.b0 * x + s.s1;
        s.s1 = c.b1 * x - c.a1 * y + s.s2;
        s.s2 = c.b2 * x - c.a2 * y;
        return y;
    }
};

template <class Real>
struct StateVariable {
    struct Coefficients {
        Real a1, a2, a3, m0, m1, m2;
    };
    struct State {
        Real s1{}, s2{};
    };
    static Coefficients coefficients(const LoadedSection& s) {
        return {static_cast<Real>(s.svf.a1), static_cast<Real>(s.svf.a2), static_cast<Real>(s.svf.a3),
                static_cast<Real>(s.svf.m0), static_cast<Real>(s.svf.m1), static_cast<Real>(s.svf.m2)};
    }
    static State settled(const Coefficients&, Real x) { return {Real{}, x}; }
    static Real step(const Coefficients& c, State& s, Real x) {
        const Real v3 = x - s.s2;
        const Real v1 = c.a1 * s.s1 + c.a2 * v3;
        const Real v2 = s.s2 + c.a2 * s.s1 + c.a3 * v3;
        s.s1 = v1 + v1 - s.s1;
        s.s2 = v2 + v2 - s.s2;
        return c.m0 * x + c.m1 * v1 + c.m2 * v2;
    }
};

}  // namespace ripplenotch
