// SPDX-License-Identifier: MIT
#pragma once
// Which numbers the messages of a topic hold, and how they are read from the next million, whatever the
// encoding.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "log/messages/message_source.hpp"
#include "log/npy/npy_field.hpp"

namespace ripplenotch {

/// Longer lists of numbers are no columns.
inline constexpr std::size_t most_listed_elements = 64;

/// A number that every message of a topic has.
struct MessageLeaf {
    std::string path;     ///< in the message: "effort[3]"
    std::string read_as;  ///< "elbow effort" where the message names its joints
    NpyField type;        ///< without a place
    bool stamp = false;   ///< seconds and nanoseconds, given as nanoseconds in 64 bits
    bool clock = false;   ///< the stamp of the message itself
};

/// Where the numbers of a message go in a record: the offset of each leaf; negative: it is left out.
using LeafOffsets = std::vector<std::ptrdiff_t>;

class MessageReader {
  public:
    virtual ~MessageReader() = default;
    /// Each number in the processor's byte order at its offset. Throws DataError, without a source's name,
    /// where a message is not as the first one was: shorter, a list of another length, a joint of another
    /// name.
    virtual void read(std::string_view message, char* into) = 0;
};

/// How to read the messages of a topic.
class MessageProgram {
  public:
    virtual ~MessageProgram() = default;
    [[nodiscard]] virtual std::unique_ptr<MessageReader> reader(const LeafOffsets& offsets) const = 0;
};

struct MessageLayout {
    std::vector<MessageLeaf> leaves;
    std::shared_ptr<const MessageProgram> program;
};

/// Why messages of a channel cannot be read; empty where they can, as far as the channel tells.
[[nodiscard]] std::string refusal_of(const MessageChannel& channel);

/// Of the first message of a channel: lists of numbers have the lengths that they have in it, and keep them.
/// Lists longer than 64 and what is empty give no leaves. Throws DataError, without a source's name, where
/// the message does not fit its type.
[[nodiscard]] MessageLayout lay_out_message(const MessageChannel& channel, std::string_view first);

}  // namespace ripplenotch
