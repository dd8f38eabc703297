// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <unordered_map>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/fleet/shards.hpp"

namespace ripplenotch {

namespace {

void read_field(std::string_view field, const std::string& where, ManifestEntry& entry) {
    const std::size_t equals = field.find('=');
    const std::string_view name = field.substr(0, equals);
    const std::string value(equals == std::string_view::npos ? "" : field.substr(equals + 1));
    if (name == "date") {
        const auto seconds = date_seconds(value);
        if (!seconds)
            raise<DataError>("{}: date '{}' is none such as 2026-01-05 or 2026-01-05T12:30:00Z", where,
                             value);
        entry.date = date_text(*seconds);
    } else if (name == "robot") {
        entry.robot = value;
    } else if (name == "temperature_degc") {
        entry.temperature_degc = parse_number(value);
        if (!entry.temperature_degc ||
            !(*entry.temperature_degc > -274.0 && *entry.temperature_degc < 1000.0))
            raise<DataError>("{}: temperature_degc '{}' is no temperature in degrees Celsius", where, value);
    } else {
        raise<DataError>("{}: '{}' is none of date=, robot=, temperature_degc=", where, std::string(field));
    }
}

ManifestEntry entry_of(std::string_view line, const std::string& where) {
    ManifestEntry entry;
    const std::size_t tab = line.find('\t');
    entry.log = line.substr(0, tab);
    if (entry.log.empty()) raise<DataError>("{}: a line begins with the path of a log", where);
    if (entry.log == "-") raise<DataError>("{}: a log of a list is a file, not standard input", where);
    for (std::size_t at = tab; at != std::string_view::npos;) {
        const std::size_t next = line.find('\t', at + 1);
        read_field(line.substr(at + 1, next == std::string_view::npos ? next : next - at - 1), where, entry);
        at = next;
    }
    return entry;
}

}  // namespace

Manifest manifest_of(std::string_view text, const std::string& source) {
    Manifest manifest;
    Sha256 hash;
    hash.update(text);
    manifest.sha256 = hash.hex();
    std::unordered_map<std::string, std::size_t> seen;
    for (std::size_t at = 0, number = 1; at < text.size(); ++number) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        std::string_view line = text.substr(at, end - at);
        if (line.ends_with('\r')) line.remove_suffix(1);
        at = end + 1;
        if (line.empty()) continue;
        const std::string where = fmt::format("{}:{}", source, number);
        manifest.entries.push_back(entry_of(line, where));
        const auto [before, is_new] = seen.try_emplace(manifest.entries.back().log, number);
        if (!is_new)
            raise<DataError>("{}: '{}' stands in line {} already; a log is done once", where,
                             manifest.entries.back().log, before->second);
    }
    if (manifest.entries.empty()) raise<DataError>("{}: lists no log; expected a path a line", source);
    return manifest;
}

std::span<const ManifestEntry> part_of(const Manifest& manifest, const Shard& shard) {
    const std::size_t all = manifest.entries.size();
    const std::size_t from = all * (shard.number - 1) / shard.of, to = all * shard.number / shard.of;
    return std::span(manifest.entries).subspan(from, to - from);
}

namespace {

std::optional<std::size_t> counted(std::string_view text) {
    const auto number = parse_number(text);
    if (!number || !(*number >= 1.0 && *number <= static_cast<double>(most_shards))) return std::nullopt;
    const auto whole = static_cast<std::size_t>(*number);
    return static_cast<double>(whole) == *number ? std::optional(whole) : std::nullopt;
}

}  // namespace

Shard shard_of(std::string_view text) {
    const std::size_t slash = text.find('/');
    const auto number = counted(text.substr(0, slash));
    const auto of = slash == std::string_view::npos ? std::nullopt : counted(text.substr(slash + 1));
    if (!number || !of || *number > *of)
        raise<UsageError>("--shard '{}' is no number/count such as 3/16, counted from 1", std::string(text));
    return {*number, *of};
}

std::string shard_file_name(const Shard& shard) {
    return fmt::format("shard-{:06}-of-{:06}.ndjson", shard.number, shard.of);
}

std::string record_file_name(const Shard& shard) {
    return fmt::format("shard-{:06}-of-{:06}{}", shard.number, shard.of, record_ending);
}

std::string why_mixed(const ShardRecord& one, const ShardRecord& other) {
    if (one.manifest_sha256 != other.manifest_sha256) return "they are of two lists of logs";
    if (one.shard.of != other.shard.of)
        return fmt::format("one is of {} shards, one of {}", one.shard.of, other.shard.of);
    if (one.version != other.version)
        return fmt::format("one is by version {}, one by {}", one.version, other.version);
    if (one.settings != other.settings)
        return fmt::format("one is by '{}', one by '{}'", one.settings, other.settings);
    return {};
}

std::vector<std::size_t> missing_shards(std::span<const ShardRecord> records,
                                        std::span<const std::string> names, std::size_t of) {
    std::map<std::size_t, std::size_t> by_number;
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (const std::string why = why_mixed(records.front(), records[i]); !why.empty())
            raise<DataError>("{} and {} are not of one job: {}", names.front(), names[i], why);
        const auto [before, is_new] = by_number.try_emplace(records[i].shard.number, i);
        if (!is_new)
            raise<DataError>("{} and {} both are shard {}; keep one of them", names[before->second], names[i],
                             records[i].shard.number);
        if (records[i].shard.of != of)
            raise<DataError>("{}: is one of {} shards, and --shards is {}", names[i], records[i].shard.of,
                             of);
    }
    std::vector<std::size_t> missing;
    for (std::size_t number = 1; number <= of; ++number)
        if (!by_number.contains(number)) missing.push_back(number);
    return missing;
}

std::string numbers_in_words(std::span<const std::size_t> numbers) {
    std::string words;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t last = i;
        while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
        words += words.empty() ? "" : ", ";
        words +=
            last == i ? fmt::format("{}", numbers[i]) : fmt::format("{} to {}", numbers[i], numbers[last]);
        i = last + 1;
    }
    return words;
}

}  // namespace ripplenotch
