// SPDX-License-Identifier: MIT
#pragma once
// Internal: the one question which vectors may be used here, and what functions need that are built for them.
//
// Wide vectors are AVX2 on x86-64 and NEON on arm64, where every processor has it. Without them numbers go
// two by two (lanes.hpp) and characters one by one. Contraction is off for the whole build and no fused
// operation is used, so the bytes of a result do not depend on the answer.

#define RIPPLENOTCH_INLINED inline __attribute__((always_inline))
#if defined(__x86_64__) && defined(__GNUC__)
#define RIPPLENOTCH_WIDE __attribute__((target("avx2")))
#else
#define RIPPLENOTCH_WIDE
#endif

namespace ripplenotch {

/// True on processors with wide vectors, unless somebody holds NarrowVectors, or RIPPLENOTCH_VECTORS=none is
/// in the environment.
[[nodiscard]] bool wide_vectors() noexcept;

/// While it lives, all is done as on a processor without wide vectors: tests hold every kernel to its plain
/// form that way. What asks once, when it is made, goes on with the answer.
class NarrowVectors {
  public:
    NarrowVectors() noexcept;
    ~NarrowVectors();
    NarrowVectors(const NarrowVectors&) = delete;
    NarrowVectors& operator=(const NarrowVectors&) = delete;

  private:
    bool before_;
};

}  // namespace ripplenotch
