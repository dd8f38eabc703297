// SPDX-License-Identifier: MIT
#pragma once
// What features was asked for.

#include <optional>
#include <string>
#include <vector>

#include "cli/gear/gear_choice.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/fleet/log_date.hpp"

namespace ripplenotch {

struct FeatureRequest {
    CommonOptions common;
    LogOptions log;
    GearOptions gear;
    std::vector<std::string> logs;
    std::optional<std::string> manifest, shard, missing;
    int shards = 0;
    std::optional<std::string> date_from_name, temperature;
    bool date_from_file = false, ndjson = false, csv = false;
};

/// A request whose words were understood, for all its logs.
struct FeatureWork {
    CommonOptions common;
    ReadOptions read;
    std::optional<GearAccount> gear;
    std::optional<NamePattern> pattern;
    std::optional<double> temperature_degc;         ///< stated for all logs
    std::optional<std::string> temperature_column;  ///< with {joint} in the place of a joint's name
    bool date_from_file = false;
};

/// Throws UsageError.
[[nodiscard]] FeatureWork work_of(const FeatureRequest& request);

}  // namespace ripplenotch
