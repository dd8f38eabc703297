// SPDX-License-Identifier: MIT
// rosbag2 recordings in SQLite: the messages of a topic, by path.

#include <array>

#include "log/formats.hpp"
#include "log/messages/message_columns.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 1> extensions = {".db3"};

ColumnLog make_rosbag2(std::unique_ptr<ByteSource> source, std::string first_bytes,
                       const ReadOptions& options) {
    const auto file = store_bytes(std::move(source), std::move(first_bytes));
    return columns_of_messages([file] { return open_rosbag2(file); }, "rosbag2", options);
}

}  // namespace

const LogFormat formats::rosbag2 {
    .name = "rosbag2", .summary = "rosbag2 recordings in SQLite (.db3), as mcap", .extensions = extensions,
    .binary = true,
    .lacks =
#if defined(RIPPLENOTCH_HAS_SQLITE)
        {},
#else
        "libsqlite3",
#endif
    .sniff = [](std::string_view bytes) { return bytes.starts_with("SQLite format 3"); },
    .open = open_as_columns<make_rosbag2>,
};

}  // namespace ripplenotch
