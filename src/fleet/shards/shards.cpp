// SPDX-License-Identifier: MIT
#include "ripplenotch/fleet/shards.hpp"

#include <map>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
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
            raise<DataError>("{}: is one of {} shards, and --shards says {}", names[i], records[i].shard.of,
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
