// SPDX-License-Identifier: MIT
#pragma once
// Messages in CDR (OMG's Common Data Representation, version 1, as ROS 2 writes it): which numbers are in
// one, and a short program that takes them out of the next million.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "log/messages/ros_schema.hpp"
#include "log/npy/npy_field.hpp"

namespace ripplenotch {

/// A number that every message of a topic has.
struct CdrLeaf {
    std::string path;     ///< in the message: "effort[3]"
    std::string read_as;  ///< "elbow effort" where the message names its joints
    NpyField type;        ///< without a place
    bool stamp = false;   ///< seconds and nanoseconds, given as nanoseconds in 64 bits
    bool clock = false;   ///< the stamp of the message's header
};

/// One step through a message.
struct CdrStep {
    enum class Kind {
        number,    ///< of `size` bytes, kept
        stamp,     ///< of eight bytes, kept
        skip,      ///< `count` numbers of `size` bytes
        skip_any,  ///< as many as stand in front
        text,
        texts,       ///< as many as stand in front
        text_is,     ///< `expected`
        length_is,   ///< `count` in front of a sequence
        repeat_any,  ///< `inner`, as many times as stand in front
    };
    Kind kind = Kind::skip;
    std::size_t size = 0, count = 1, leaf = 0;
    std::string path, expected;
    std::vector<CdrStep> inner;
};

/// What a first message tells of all of a topic.
struct CdrLayout {
    std::vector<CdrLeaf> leaves;
    std::vector<CdrStep> steps;
};

/// Of the first message: sequences of numbers have the lengths that they have in it, and keep them. Sequences
/// longer than 64 and what is empty give no leaves. Throws DataError, without a source's name, where the
/// message does not fit its type.
[[nodiscard]] CdrLayout lay_out_cdr(const RosType& type, std::string_view message);

/// The numbers of a message, each in the processor's byte order at its offset; a negative offset leaves one
/// out. Throws DataError, without a source's name, where the message is shorter, a sequence has another
/// length or a joint another name.
void run_cdr(std::span<const CdrStep> steps, std::string_view message,
             const std::vector<std::ptrdiff_t>& offsets, char* into);

}  // namespace ripplenotch
