// SPDX-License-Identifier: MIT
#include "log/unpack/unpacker.hpp"

#include <array>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::span<const Packing* const> all_packings() {
    static constexpr std::array all = {&packings::gzip, &packings::zstd, &packings::lz4, &packings::xz};
    return all;
}

const Packing* packing_of(std::string_view first_bytes) {
    for (const Packing* packing : all_packings()) {
        if (first_bytes.starts_with(packing->magic)) return packing;
    }
    return nullptr;
}

std::unique_ptr<Unpacker> unpacker_of(const Packing& packing, const std::string& source) {
    if (packing.make == nullptr) {
        raise<UsageError>(
            "{}: read a {} file, and this build was made without {}; unpack it: {} {} | "
            "ripplenotch ... -",
            source, packing.name, packing.lacks, packing.program, source);
    }
    return packing.make();
}

}  // namespace ripplenotch
