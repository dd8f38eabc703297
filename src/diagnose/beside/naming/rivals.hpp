// SPDX-License-Identifier: MIT
#pragma once
// Another name in the place of one, and which of the two the log shows.

#include <memory>
#include <optional>
#include <span>

#include "diagnose/beside/naming/evidence.hpp"
#include "diagnose/beside/naming/exchanges.hpp"

namespace ripplenotch {

/// The log once more, in a colour that reaches further back: made when it is first asked for. `lens` and what
/// is given must outlive it.
class LongerLook {
  public:
    LongerLook(const Lens& lens, const Candidate& model, std::span<const GivenTerm> given,
               std::span<const Effect* const> effects);
    ~LongerLook();
    LongerLook(const LongerLook&) = delete;
    LongerLook& operator=(const LongerLook&) = delete;

    [[nodiscard]] Sums& sums();

  private:
    struct Held;
    const Lens& lens_;
    const Candidate& model_;
    std::span<const GivenTerm> given_;
    std::span<const Effect* const> effects_;
    std::unique_ptr<Held> held_;
};

/// The best that may stand in the place of a name, and how far the name is ahead of it out of fold.
struct Rivalry {
    Shape rival;
    OutsideGain ahead;
};
/// `price`: of the name. Where neither is ahead, `longer` is asked, and decides where it shows one ahead.
[[nodiscard]] std::optional<Rivalry> rivalry_of(Sums& sums, const Names& names, std::size_t place,
                                                double price, LongerLook* longer);

}  // namespace ripplenotch
