// SPDX-License-Identifier: MIT
#pragma once
// The only door to Eigen's dense algebra. Eigen asks the processor for its caches and cuts products into
// blocks by them, so that the last digits of a fit would depend on the machine; here the sizes are the same
// everywhere. The build leaves Eigen's vector instructions out for the same reason (EIGEN_DONT_VECTORIZE):
// each architecture would sum in its own order. docs/decisions/0004-same-bytes.md.

#include <Eigen/Dense>

namespace ripplenotch::linear_algebra_detail {

/// Set before main(), once in a program. 32 KiB, 512 KiB and 4 MiB: what any machine of the last ten years
/// has.
inline const bool caches_are_fixed = (Eigen::setCpuCacheSizes(32 * 1024, 512 * 1024, 4096 * 1024), true);

}  // namespace ripplenotch::linear_algebra_detail
