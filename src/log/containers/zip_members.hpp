// SPDX-License-Identifier: MIT
#pragma once
// The members of a ZIP archive (PKWARE APPNOTE 6.3), stored or deflated, as bytes that are read here and
// there.

#include <memory>
#include <string>
#include <vector>

#include "log/containers/stored_array.hpp"

namespace ripplenotch {

struct ZipMember {
    std::string name;
    std::uint64_t size = 0;              ///< unpacked
    std::shared_ptr<StoredBytes> bytes;  ///< of the whole archive, or unpacked
    std::uint64_t offset = 0;            ///< of the member in them
    std::uint32_t checksum = 0;          ///< CRC-32
    bool packed = false;                 ///< and checked when it is unpacked
};

/// In the order of the archive's directory. Throws DataError on a damaged one, and on members that are
/// encrypted or packed in another way.
[[nodiscard]] std::vector<ZipMember> zip_members(const std::shared_ptr<StoredBytes>& archive);

}  // namespace ripplenotch
