// SPDX-License-Identifier: MIT
#pragma once
// Help that names what can be chosen takes the names from the list of records that they are chosen from.

#include <span>
#include <string>

namespace ripplenotch {

/// "csv, npy": the names of a registry's entries, in its order.
template <class Entry>
[[nodiscard]] std::string name_list(std::span<const Entry* const> entries) {
    std::string names;
    for (const Entry* entry : entries)
        names += std::string(names.empty() ? "" : ", ") + std::string(entry->name);
    return names;
}

}  // namespace ripplenotch
