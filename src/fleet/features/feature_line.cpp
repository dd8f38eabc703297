// SPDX-License-Identifier: MIT
#include "ripplenotch/fleet/feature_line.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <string_view>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

struct DescriptorKind {
    std::string_view stem;  ///< "ripple_N_amplitude": with an order in the place of N
    std::string_view unit;
    bool scales_with_torque = false;
    std::string_view what;
};

/// In the order of descriptors.def, which is that of a line.
std::span<const DescriptorKind> descriptor_kinds() {
    static constexpr std::array kinds = {
#define DESCRIPTOR(stem, unit, torque, what) DescriptorKind{stem, unit, torque, what},
#include "fleet/features/descriptors.def"
#undef DESCRIPTOR
    };
    return kinds;
}

// "ripple_2_amplitude" or "ripple_0.5_phase" -> "ripple_N_amplitude"
std::string without_order(const std::string& stem) {
    constexpr std::string_view front = "ripple_";
    if (!stem.starts_with(front)) return stem;
    const std::size_t end = stem.find('_', front.size());
    if (end == std::string::npos || end == front.size()) return stem;
    const auto digits = stem.substr(front.size(), end - front.size());
    const bool number = std::all_of(digits.begin(), digits.end(), [](char c) {
        return c == '.' || std::isdigit(static_cast<unsigned char>(c)) != 0;
    });
    return number ? "ripple_N" + stem.substr(end) : stem;
}

}  // namespace

const Descriptor* FeatureLine::find(const std::string& name) const {
    const auto found = std::find_if(descriptors.begin(), descriptors.end(),
                                    [&](const Descriptor& one) { return one.name() == name; });
    return found == descriptors.end() ? nullptr : &*found;
}

Descriptor descriptor_named(const std::string& name) {
    std::string near;
    for (const DescriptorKind& kind : descriptor_kinds()) {
        const std::string ending = kind.unit.empty() ? "" : "_" + std::string(kind.unit);
        const bool ends = name.ends_with(ending);
        const std::string stem = ends ? name.substr(0, name.size() - ending.size()) : name;
        if (ends && without_order(stem) == kind.stem) return {stem, std::string(kind.unit), {}, {}, {}};
        if (without_order(name).starts_with(std::string(kind.stem) + "_"))
            near = name.substr(0, name.rfind('_')) + ending;
    }
    if (!near.empty()) raise<DataError>("'{}' is in another unit; this tool's lines have {}", name, near);
    raise<DataError>("'{}' is no descriptor of this tool", name);
}

bool scales_with_torque(const Descriptor& descriptor) {
    const std::string stem = without_order(descriptor.stem);
    return std::any_of(descriptor_kinds().begin(), descriptor_kinds().end(), [&](const DescriptorKind& kind) {
        return kind.stem == stem && kind.scales_with_torque;
    });
}

}  // namespace ripplenotch
