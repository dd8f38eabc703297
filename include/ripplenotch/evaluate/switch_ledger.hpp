// SPDX-License-Identifier: MIT
#pragma once
// The switching ledger: every change of filter on a log with what it did to the output, measured against the
// torque that is known to be true.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/core/units.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

/// Errors are |output - truth|, from the change up to the next one, a gap or the end of the log: its stretch.
/// They hold all that is wrong there, the new filter's lag and the ripple that it leaves included.
struct SwitchEntry {
    Switch change;
    Seconds time;
    Seconds stretch;                        ///< from the change to the last sample before the next one
    std::optional<double> error_before_nm;  ///< at the sample before; empty right after a gap, or no truth
    std::optional<double> peak_error_nm;    ///< the largest; empty without truth
    std::optional<Seconds> peak_after;      ///< when, counted from the change
    /// Per entry of settle_bands_percent (bench.hpp), in per cent of the true torque's range over the log:
    /// from the change until the error stays within; empty when it is still outside at the stretch's end.
    std::array<std::optional<Seconds>, 4> settle;
};

/// Takes a running filter's output block by block, in the order of the log.
class SwitchLedger {
  public:
    /// `truth_nm`: row by row, or empty where it is not known.
    explicit SwitchLedger(std::span<const double> truth_nm);

    /// The next samples: their times and what the filter put out, with all its changes so far.
    void add(std::span<const double> time_s, std::span<const double> out_nm, std::span<const Switch> changes);
    /// Between two samples: a gap ends the stretch.
    void split();

    [[nodiscard]] const std::vector<SwitchEntry>& entries() const { return entries_; }

  private:
    void follow(Seconds time, double error_nm);
    std::span<const double> truth_nm_;
    std::array<double, 4> bands_nm_{};
    std::vector<SwitchEntry> entries_;
    std::size_t done_ = 0;  ///< samples seen
    bool watched_ = false;  ///< the last entry's stretch goes on
    std::array<bool, 4> outside_{};
    std::optional<double> last_error_nm_;
};

}  // namespace ripplenotch
