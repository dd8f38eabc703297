// SPDX-License-Identifier: MIT
#include "log/messages/topic_contents.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "log/containers/stored_array.hpp"

namespace ripplenotch {
namespace {

std::optional<double> rate_of(const Topic& topic) {
    if (topic.seen < 2 || topic.to_ns <= topic.from_ns) return std::nullopt;
    // A damaged recording may hold any two times: their distance fits an unsigned number only.
    const auto ns = static_cast<std::uint64_t>(topic.to_ns) - static_cast<std::uint64_t>(topic.from_ns);
    return 1e9 * static_cast<double>(topic.seen - 1) / static_cast<double>(ns);
}

// Elements of an array are one thing, position[0..6]: the last of those that begin with this one.
std::size_t last_element(const std::vector<MessageLeaf>& leaves, std::size_t first) {
    const std::string& path = leaves[first].path;
    if (!path.ends_with("[0]")) return first;
    const std::string stem = path.substr(0, path.size() - 2);
    std::size_t last = first;
    while (last + 1 < leaves.size() && leaves[last + 1].path == fmt::format("{}{}]", stem, last + 1 - first))
        ++last;
    return last;
}

}  // namespace

std::vector<ContentEntry> topic_contents(
    const MessageSource& source, const std::vector<Topic>& topics,
    const std::function<bool(std::size_t channel, const std::string& path)>& is_read) {
    std::vector<ContentEntry> entries;
    for (std::size_t c = 0; c < topics.size(); ++c) {
        const Topic& topic = topics[c];
        const MessageChannel& channel = source.channels()[c];
        const auto count = source.count_of(c);
        ContentEntry entry;
        entry.path = channel.topic;
        entry.shape =
            count ? fmt::format("{} messages", *count) : fmt::format("{} messages and more", topic.seen);
        entry.type = fmt::format("{}, {}", channel.type, topic.refusal);
        entry.rate_hz = rate_of(topic);
        if (!topic.refusal.empty()) {
            entries.push_back(entry);
            continue;
        }
        const auto& leaves = topic.layout.leaves;
        for (std::size_t l = 0, last = 0; l < leaves.size(); l = last + 1) {
            last = last_element(leaves, l);
            const std::string first = fmt::format("{}.{}", channel.topic, leaves[l].path);
            entry.path =
                last > l ? fmt::format("{}0..{}]", first.substr(0, first.size() - 2), last - l) : first;
            entry.type = leaves[l].stamp ? "stamp" : type_name(leaves[l].type);
            entry.unit = leaves[l].stamp ? "ns" : "";
            entry.read = false;
            for (std::size_t e = l; e <= last; ++e)
                entry.read = entry.read || is_read(c, fmt::format("{}.{}", channel.topic, leaves[e].path));
            entries.push_back(entry);
        }
    }
    return entries;
}

}  // namespace ripplenotch
