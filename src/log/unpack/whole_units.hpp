// SPDX-License-Identifier: MIT
#pragma once
// Internal: packed bytes in whole units, as a library asks for them, however they arrive. A call that meets
// damage does not say what it has given before; with whole units it has given nothing, and what was given
// before it does not depend on the pieces.

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace ripplenotch {

class WholeUnits {
  public:
    /// The next unit, whole or empty; takes from `packed` what it keeps for later and says how much.
    [[nodiscard]] std::string_view next(std::string_view packed, std::size_t& taken) {
        taken = 0;
        from_kept_ = !kept_.empty() || packed.size() < wanted_;
        if (!from_kept_) return packed.substr(0, wanted_);
        if (kept_.size() < wanted_) {
            taken = std::min(packed.size(), wanted_ - kept_.size());
            kept_.append(packed.substr(0, taken));
        }
        return std::string_view(kept_).substr(0, kept_.size() < wanted_ ? 0 : wanted_);
    }

    /// What the library used of the unit, and the size of the one that it wants next.
    void used(std::size_t size, std::size_t wanted, std::size_t& taken) {
        if (from_kept_)
            kept_.erase(0, size);
        else
            taken = size;
        wanted_ = std::max<std::size_t>(1, wanted);
    }

    [[nodiscard]] bool keeps_some() const { return !kept_.empty(); }

  private:
    std::string kept_;
    std::size_t wanted_ = 1;
    bool from_kept_ = false;
};

}  // namespace ripplenotch
