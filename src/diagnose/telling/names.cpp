// SPDX-License-Identifier: MIT
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

std::string_view status_name(FindingStatus status) {
    constexpr std::string_view names[] = {"confirmed",        "ambiguous",      "tentative",     "immaterial",
                                          "shape-correction", "unidentifiable", "not-reproduced"};
    return names[static_cast<std::size_t>(status)];
}

std::string_view verdict_name(DiagnosisVerdict verdict) {
    constexpr std::string_view names[] = {"matches", "explained", "partly-explained", "unexplained",
                                          "undecided"};
    return names[static_cast<std::size_t>(verdict)];
}

std::string_view direction_name(Direction direction) {
    constexpr std::string_view names[] = {"", "positive", "negative", "both"};
    return names[static_cast<std::size_t>(direction)];
}

std::string_view region_kind_name(RegionKind kind) {
    constexpr std::string_view names[] = {"time", "tone", "order", "position", "speed"};
    return names[static_cast<std::size_t>(kind)];
}

}  // namespace ripplenotch
