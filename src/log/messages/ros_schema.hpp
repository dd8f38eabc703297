// SPDX-License-Identifier: MIT
#pragma once
// Definitions of ROS 2 messages in the language of .msg files, as recordings carry them (encoding ros2msg).

#include <string>
#include <string_view>
#include <vector>

#include "log/messages/message_columns.hpp"

namespace ripplenotch {

struct RosField;

/// What a field holds.
struct RosType {
    enum class Kind { number, text, wide_text, stamp, record };
    Kind kind = Kind::number;
    char number = 'f';     ///< as NpyField::kind
    std::size_t size = 0;  ///< of a number in bytes
    std::vector<RosField> fields;
};

struct RosField {
    enum class Count { one, fixed, any };
    std::string name;
    RosType type;
    Count count = Count::one;
    std::size_t fixed = 1;
};

/// The fields of `type`, defined first in `schema`, with those of the types behind it put in place. Throws
/// DataError, without a source's name, on a type that is not defined, on one that holds itself, and on lines
/// that are no fields.
[[nodiscard]] RosType parse_ros_schema(std::string_view schema, const std::string& type);

/// lay_out_message() of messages in CDR.
[[nodiscard]] MessageLayout lay_out_cdr(const RosType& type, std::string_view message);

/// The definition of a common type, for recordings that carry none; empty where it is not known here.
[[nodiscard]] std::string_view known_ros_schema(std::string_view type);

}  // namespace ripplenotch
