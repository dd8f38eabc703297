// SPDX-License-Identifier: MIT
// MCAP recordings: the messages of a topic, by path.

#include <array>

#include "log/formats.hpp"
#include "log/messages/message_columns.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 1> extensions = {".mcap"};

ColumnLog make_mcap(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    const auto file = store_bytes(std::move(source), std::move(first_bytes));
    return columns_of_messages([file] { return open_mcap(file); }, "mcap", options);
}

}  // namespace

const LogFormat formats::mcap{
    .name = "mcap",
    .summary = "MCAP recordings of ROS 2: JointState, and every message of numbers by path",
    .extensions = extensions,
    .binary = true,
    .sniff = [](std::string_view bytes) { return bytes.starts_with("\x89MCAP"); },
    .open = open_as_columns<make_mcap>,
};

}  // namespace ripplenotch
