// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "log/messages/message_records.hpp"
#include "log/messages/ros_schema.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

// Messages in CDR (OMG's Common Data Representation, version 1, as ROS 2 writes it): which numbers are in
// one, and a short program that takes them out of the next million.

/// One step through a message.
struct CdrStep {
    enum class Kind {
        number,    ///< of `size` bytes, kept
        stamp,     ///< of eight bytes, kept
        skip,      ///< `count` numbers of `size` bytes
        skip_any,  ///< as many as stand in front
        text,
        text_is,     ///< `expected`
        length_is,   ///< `count` in front of a sequence
        repeat_any,  ///< `inner`, as many times as stand in front
    };
    Kind kind = Kind::skip;
    std::size_t size = 0, count = 1, leaf = 0;
    std::string path, expected;
    std::vector<CdrStep> inner;
};

/// lay_out_message() of CDR.
[[nodiscard]] MessageLayout lay_out_cdr(const RosType& type, std::string_view message);

/// How messages are read whose way is written down in `steps`.
[[nodiscard]] std::shared_ptr<const MessageProgram> cdr_program(std::vector<CdrStep> steps);

}  // namespace ripplenotch
