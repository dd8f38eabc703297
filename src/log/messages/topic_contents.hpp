// SPDX-License-Identifier: MIT
#pragma once
// The topics of a recording, as `info` lists them.

#include <functional>
#include <string>
#include <vector>

#include "log/messages/message_layout.hpp"
#include "log/messages/message_source.hpp"

namespace ripplenotch {

/// What the first messages tell of a topic.
struct Topic {
    std::string first;  ///< its first message; empty where none was seen
    std::uint64_t seen = 0;
    std::int64_t from_ns = 0, to_ns = 0;
    MessageLayout layout;
    std::string refusal;  ///< why it has no numbers; empty where it has
};

/// A line a number that messages have, or a list of numbers; a line for a topic that is not read, with why. A
/// path stands for a column where `is_read` says so.
[[nodiscard]] std::vector<ContentEntry> topic_contents(
    const MessageSource& source, const std::vector<Topic>& topics,
    const std::function<bool(std::size_t channel, const std::string& path)>& is_read);

}  // namespace ripplenotch
