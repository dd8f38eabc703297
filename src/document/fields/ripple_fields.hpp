// SPDX-License-Identifier: MIT
#pragma once
// Internal: a ripple estimate as every document writes it.

#include "document/json/json.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"

namespace ripplenotch {

inline Json ripple_to_json(const RippleEstimate& one) {
    const auto searched = [&](double value) { return one.searched() ? Json(value) : Json(nullptr); };
    return {{"order", one.order},
            {"amplitude_nm", searched(one.amplitude_nm)},
            {"standard_error_nm", searched(one.standard_error_nm)},
            {"detectable_nm", searched(one.detectable_nm)},
            {"false_alarm", searched(one.false_alarm)},
            {"phase_deg", one.phase_deg ? Json(*one.phase_deg) : Json(nullptr)},
            {"present", one.searched() ? Json(one.present()) : Json(nullptr)},
            {"slowest_deg_s", searched(one.slowest_deg_s)},
            {"fastest_deg_s", searched(one.fastest_deg_s)},
            {"cycles", one.cycles},
            {"insufficient", one.searched() ? Json(nullptr) : Json(one.insufficient)}};
}

}  // namespace ripplenotch
