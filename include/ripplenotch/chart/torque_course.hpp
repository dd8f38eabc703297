// SPDX-License-Identifier: MIT
#pragma once
// Torque before and after a filter along a log of any length, in bounded memory, and the ledger of its
// switches.

#include <span>
#include <string>

#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

class TorqueCourse {
  public:
    /// One sample; time in the order of the log.
    void add(double time_s, double speed_deg_s, double before_nm, double after_nm);

    /// Panels: torque before and after, joint speed, and for a filter that switches the band in force and the
    /// jump of the output at each switch.
    [[nodiscard]] Figure figure(const std::string& source, const std::string& method,
                                const StreamReport& report) const;

  private:
    MinMaxCourse speed_, before_, after_;
    double first_s_ = 0.0, last_s_ = 0.0;
    bool any_ = false;
};

}  // namespace ripplenotch
