// SPDX-License-Identifier: MIT
#pragma once
// Kernels are held to their plain forms on every kind of vectors that this processor has.

#include <optional>
#include <vector>

#include "core/vectors/lanes.hpp"

namespace ripplenotch::testing {

/// Narrow vectors, and wide ones where there are any.
inline std::vector<bool> widths() { return wide_vectors() ? std::vector{false, true} : std::vector{false}; }

/// While it lives, vectors of one width are used.
class Width {
  public:
    explicit Width(bool wide) {
        if (!wide) narrow_.emplace();
    }

  private:
    std::optional<NarrowVectors> narrow_;
};

}  // namespace ripplenotch::testing
