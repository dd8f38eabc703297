// SPDX-License-Identifier: MIT
#include "log/messages/message_layout.hpp"

#include <fmt/format.h>

#include "log/messages/cdr_program.hpp"
#include "log/messages/field_tree.hpp"
#include "log/messages/json_message.hpp"
#include "log/messages/protobuf_message.hpp"
#include "log/messages/ros_schema.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::string refusal_of(const MessageChannel& channel) {
    if (channel.encoding == "json") return {};
    if (channel.encoding == "protobuf")
        return channel.schema_encoding == "protobuf" && !channel.schema.empty()
                   ? ""
                   : "not defined in the recording";
    if (channel.encoding != "cdr") return fmt::format("{} messages, which are not read", channel.encoding);
    if (!channel.schema.empty() && channel.schema_encoding != "ros2msg")
        return fmt::format("defined in {}, which is not read", channel.schema_encoding);
    if (channel.schema.empty() && known_ros_schema(channel.type).empty())
        return "not defined in the recording";
    return {};
}

MessageLayout lay_out_message(const MessageChannel& channel, std::string_view first) {
    if (channel.encoding == "json") return lay_out_fields(json_walk(), first);
    if (channel.encoding == "protobuf")
        return lay_out_fields(protobuf_walk(channel.schema, channel.type), first);
    const std::string_view schema =
        channel.schema.empty() ? known_ros_schema(channel.type) : std::string_view(channel.schema);
    return lay_out_cdr(parse_ros_schema(schema, channel.type), first);
}

}  // namespace ripplenotch
