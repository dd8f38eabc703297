// SPDX-License-Identifier: MIT
#pragma once
// Between which numbers a value lies.

namespace ripplenotch {

/// 95 % interval, of the errors being normal and the model being linear within it. With
/// FitOptions::error_stretch they need not be white.
struct Interval {
    double low = 0.0, high = 0.0;
};

}  // namespace ripplenotch
