// SPDX-License-Identifier: MIT
#pragma once
// Shards in a folder: done once, asked about, put together.

#include <string>
#include <vector>

#include "cli/features/feature_request.hpp"
#include "ripplenotch/fleet/shards.hpp"

namespace ripplenotch {

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

/// Does the shard, unless it is complete. Throws DataError where the folder holds another job.
void do_shard(const FeatureRequest& request, const FeatureWork& work, const Manifest& manifest,
              const std::string& settings);

/// A command line without list and shard: what two shards of one job have in common.
[[nodiscard]] std::string shard_settings(const std::string& command_line);

}  // namespace ripplenotch
