// SPDX-License-Identifier: MIT
#pragma once
// The numbers of exported code (design/runtime/real_float.h, real_double.h), as the tool runs it: with the
// functions that are the same on every machine, and without what a processor fuses.

#include <cmath>

#include "export/text.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

#define RN_INLINE static
#define RN_UNFUSED

struct FloatMath {
#include "design/runtime/real_float.h"
#include "design/runtime/tangent.h"
};

struct DoubleMath {
    static double cos(double angle) { return portable::phasor(angle).real(); }
    static double sin(double angle) { return portable::phasor(angle).imag(); }
#include "design/runtime/real_double.h"
#include "design/runtime/tangent.h"
};

#undef RN_UNFUSED
#undef RN_INLINE

/// make(FloatMath()) or make(DoubleMath()): what runs in the target's own numbers.
template <class Make>
auto in_precision(Precision precision, const Make& make) {
    return precision == Precision::float32 ? make(FloatMath()) : make(DoubleMath());
}

}  // namespace ripplenotch
