// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "model/model.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// Torques of polar terms (ripple, tones, gravity) of size 1 along one motion, at phases of 0 and 90 degrees.
// Any size, phase and ripple gain is a sum of the two; finding them takes a cosine and a sine a sample, which
// trials of the same terms need not do again and again.

class Carriers {
  public:
    /// Adds the torque of a joint term, multiplied by the ripple gain; false, and nothing is added, where the
    /// effect has no such parts. The situation has the motion of every other call.
    [[nodiscard]] bool add_torque(const Term& term, const Situation& situation, const Gain& gain,
                                  std::span<double> torque_nm);

  private:
    struct Carrier {
        Term term;  ///< with a size of 1 and a phase of 0
        GearRatio ratio;
        std::vector<double> along_nm, across_nm;
    };

    const Carrier& carrier(const Term& term, const Situation& situation);

    std::vector<Carrier> kept_;  ///< the latest, in turns
    std::size_t next_ = 0;
};

}  // namespace ripplenotch
