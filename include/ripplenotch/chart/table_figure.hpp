// SPDX-License-Identifier: MIT
#pragma once
// Figures of designs: the candidate table over speed, and a filter over frequency.

#include <span>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// The centres of every band over the speed, with the ripple that they are for (Kim, Kim, Song 2011, fig. 4),
/// the worst attenuation in each band, and its delay and settling time.
[[nodiscard]] Figure table_figure(const CandidateTable& table);

/// A cascade at these frequencies.
struct FilterResponse {
    std::vector<double> hz;
    std::vector<double> magnitude_db;  ///< at least lowest_magnitude_db
    std::vector<double> phase_deg;     ///< sum over sections, not folded; nan at a null, like the delay
    std::vector<double> group_delay_ms;
};
inline constexpr double lowest_magnitude_db = -120.0;
/// From 1e-4 of the sample rate to just below its half, even on a logarithmic axis; the nulls of every
/// section and `also_hz` are among the frequencies, so that none is missed between two points.
[[nodiscard]] FilterResponse filter_response(std::span<const Biquad> cascade, Hertz sample_rate,
                                             std::span<const double> also_hz);

}  // namespace ripplenotch
