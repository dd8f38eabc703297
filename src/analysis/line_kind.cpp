// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

std::string_view line_kind_name(LineKind kind) {
    switch (kind) {
        case LineKind::order: return "order";
        case LineKind::tone: return "tone";
        case LineKind::alias: return "alias";
        case LineKind::unknown: return "unknown";
    }
    return "unknown";
}

}  // namespace ripplenotch
