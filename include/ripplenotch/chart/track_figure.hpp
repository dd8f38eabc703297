// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

// A ripple map: amplitude and phase of each order over speed, by direction.

/// Curves of the mean over the joint's turn, at the middle load; ribbons of 95 % by the errors of the values
/// at the speeds, taken as independent. Two panels, empty for an empty map.
[[nodiscard]] Figure map_figure(const std::string& source, const MapFit& fit);

// Torque before and after a filter along a log of any length, in bounded memory, and the ledger of its
// switches.

/// One sample, before and after a filter.
struct CourseSample {
    double time_s = 0.0, speed_deg_s = 0.0, before_nm = 0.0, after_nm = 0.0;
};

/// The stretch of half a second in which a filter attenuates fast changes most: there ripple is visible,
/// which a picture of a whole log blurs.
class CloseUp {
  public:
    void add(const CourseSample& sample);
    /// Empty while the log is not some times as long as the stretch.
    [[nodiscard]] std::optional<Panel> panel() const;

  private:
    struct Stretch {
        std::vector<double> time_s, before_nm, after_nm;
        double taken_off = 0.0;  ///< squares of the steps of before less after in its median fifth
    };
    void end_stretch();

    Stretch now_, best_;
    std::size_t ended_ = 0;
};

class TorqueCourse {
  public:
    /// In the order of the log.
    void add(const CourseSample& sample);

    /// Panels: a close-up where the log is long enough, torque before and after, joint speed, and for a
    /// filter that switches the active band and the jump of the output at each switch.
    [[nodiscard]] Figure figure(const std::string& source, const std::string& method,
                                const StreamReport& report) const;

  private:
    MinMaxCourse speed_, before_, after_;
    CloseUp close_up_;
    double first_s_ = 0.0, last_s_ = 0.0;
    bool any_ = false;
};

/// A line in the legend, and what gives its colour: an order of the motor, a tone, or neither.
struct TrackName {
    std::string words;
    std::optional<double> order = {};
    bool is_tone = false;
};

/// Amplitude of each line against time with twice its standard error as a ribbon, and its phase.
[[nodiscard]] Figure track_figure(const std::string& source, const OrderTracks& tracks,
                                  std::span<const TrackName> names);

/// The same against signed speed, the ribbon being the spread over the rows of a speed.
[[nodiscard]] Figure track_figure(const std::string& source, const SpeedTrack& tracks,
                                  std::span<const TrackName> names);

}  // namespace ripplenotch
