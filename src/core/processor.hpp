// SPDX-License-Identifier: MIT
#pragma once
// Internal: which instruction sets may be used here. Kernels are built for several and choose when they run.

namespace ripplenotch {

/// True on x86-64 processors that can run code for AVX2.
[[nodiscard]] bool has_avx2();

}  // namespace ripplenotch
