// SPDX-License-Identifier: MIT
#pragma once
// How far beyond its logs a map is used.

#include <string_view>

#include "filter/ripple/ripple_keys.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

inline constexpr Key fastest_key{.name = "fastest",
                                 .dimension = Dimension::speed,
                                 .above = 0.0,
                                 .help = "speed up to which the map was made"};
inline constexpr std::array<std::string_view, 2> beyond_choices = {"refuse", "hold"};
inline constexpr Key beyond_key{
    .name = "beyond",
    .kind = KeyKind::choice,
    .default_text = "refuse",
    .choices = beyond_choices,
    .help = "a joint half as fast again: refuse, as another joint; hold: the map's edge"};

/// Watches the mean speed over each motor turn, which noise of the velocity or a single bad row does not
/// move.
class MapReach {
  public:
    /// Watches nothing where `settings` has no `fastest`, or say beyond=hold.
    MapReach(std::string_view method, const Settings& settings, double sample_rate_hz);

    void restart() noexcept { turned_ = samples_ = 0.0; }
    /// Throws DataError, with both speeds, where the joint turns half as fast again as the map's logs did.
    void next(double step_turns) {
        if (!(fastest_deg_s_ > 0.0)) return;
        turned_ += step_turns;
        samples_ += 1.0;
        if (turned_ >= 1.0 || turned_ <= -1.0) judge();
    }

  private:
    void judge();

    std::string_view method_;
    double slowest_deg_s_ = 0.0, fastest_deg_s_ = 0.0;
    double deg_s_a_turn_a_sample_ = 0.0;
    double turned_ = 0.0, samples_ = 0.0;  ///< since the last motor turn
};

}  // namespace ripplenotch
