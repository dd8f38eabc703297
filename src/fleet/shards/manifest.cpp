// SPDX-License-Identifier: MIT
#include <algorithm>
#include <unordered_map>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/fleet/log_date.hpp"
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

}  // namespace ripplenotch
