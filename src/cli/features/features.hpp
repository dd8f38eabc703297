// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/fleet/shards.hpp"

namespace ripplenotch {

// Shards in a folder: done once, asked about, put together.

/// Records of complete shards, and the files that they were read from, by name.
struct ShardFolder {
    std::vector<ShardRecord> records;
    std::vector<std::string> names;
};

/// All records in these folders. Throws FileError for a folder that cannot be read, DataError for a record
/// that is none.
[[nodiscard]] ShardFolder read_shard_folders(const std::vector<std::string>& folders);

/// The lines that belong to a record. Throws DataError where they are not those that it tells of.
[[nodiscard]] std::string lines_of_record(const ShardRecord& record, const std::string& record_name);

}  // namespace ripplenotch
