// SPDX-License-Identifier: MIT
#pragma once
// A list of logs, cut into shards that any engine may work on in any order, and the record of a finished
// shard, so that it is not repeated. docs/fleet.md.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

/// One log of a manifest, with the fields of its line.
struct ManifestEntry {
    std::string log;
    std::optional<std::string> date, robot;  ///< date as date_text() gives it
    std::optional<double> temperature_degc;
};

struct Manifest {
    std::vector<ManifestEntry> entries;
    std::string sha256;  ///< digest of the bytes of the list
};

/// A log a line: its path, then fields after tabs: date=2026-01-05, robot=R7, temperature_degc=31.5. Empty
/// lines do not count. Throws DataError with source and line: no log at all, a log listed twice, an unknown
/// field.
[[nodiscard]] Manifest manifest_of(std::string_view text, const std::string& source);

/// Shard `number` of `of`, both counted from 1.
struct Shard {
    std::size_t number = 1, of = 1;
    bool operator==(const Shard&) const = default;
};
inline constexpr std::size_t most_shards = 1'000'000;  ///< chosen, not derived
/// Parses "3/16". Throws UsageError.
[[nodiscard]] Shard shard_of(std::string_view text);
/// The entries of a shard: neighbours in the list, as many in each shard but for one.
[[nodiscard]] std::span<const ManifestEntry> part_of(const Manifest& manifest, const Shard& shard);

/// The record of a complete shard.
struct ShardRecord {
    std::string version;          ///< version of the tool
    std::string manifest_sha256;  ///< digest of the list
    std::string settings;         ///< the command line, without list, shard and output
    Shard shard;
    std::size_t logs = 0, lines = 0, failed = 0;  ///< failed: logs or joints that are a line with an error
    std::string sha256;                           ///< digest of its lines
    bool operator==(const ShardRecord&) const = default;
};

/// "shard-000003-of-000016.ndjson" and the name of its record.
[[nodiscard]] std::string shard_file_name(const Shard& shard);
[[nodiscard]] std::string record_file_name(const Shard& shard);
inline constexpr std::string_view record_ending = ".done.json";

/// Why two records are not of one job; empty where they are.
[[nodiscard]] std::string why_mixed(const ShardRecord& one, const ShardRecord& other);

/// The shards without a record, rising. Throws DataError for records of more than one job, and for two
/// records of one shard; `names` are those of their files.
[[nodiscard]] std::vector<std::size_t> missing_shards(std::span<const ShardRecord> records,
                                                      std::span<const std::string> names, std::size_t of);
/// "3, 7 to 9, 12"
[[nodiscard]] std::string numbers_in_words(std::span<const std::size_t> numbers);

}  // namespace ripplenotch
