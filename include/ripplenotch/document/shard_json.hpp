// SPDX-License-Identifier: MIT
#pragma once
// The record that a complete shard leaves beside its lines.

#include <string>
#include <string_view>

#include "ripplenotch/fleet/shards.hpp"

namespace ripplenotch {

/// Schema ripplenotch/shard/1; same record, same bytes.
[[nodiscard]] std::string shard_record_text(const ShardRecord& record);
/// Reads it back. Throws DataError that names `source`, the field, what it holds and what was expected.
[[nodiscard]] ShardRecord shard_record_from_json(std::string_view text, const std::string& source);

}  // namespace ripplenotch
