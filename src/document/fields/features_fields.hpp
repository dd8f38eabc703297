// SPDX-License-Identifier: MIT
#pragma once
// Internal: names of a line of features that its writer and its reader share.

#include <array>
#include <string_view>

#include "ripplenotch/fleet/feature_line.hpp"

namespace ripplenotch {

inline constexpr std::string_view features_schema = "ripplenotch/features/1";

struct MixField {
    const char* name;
    double MotionMix::*value;
};
inline constexpr std::array<MixField, 7> mix_fields = {{{"moving_share", &MotionMix::moving_share},
                                                        {"forward_share", &MotionMix::forward_share},
                                                        {"speed_p10_deg_s", &MotionMix::speed_p10_deg_s},
                                                        {"speed_p50_deg_s", &MotionMix::speed_p50_deg_s},
                                                        {"speed_p90_deg_s", &MotionMix::speed_p90_deg_s},
                                                        {"travel_deg", &MotionMix::travel_deg},
                                                        {"torque_rms_nm", &MotionMix::torque_rms_nm}}};

}  // namespace ripplenotch
