// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/containers/stored_array.hpp"
#include "log/npy/npy_header.hpp"
#include "log/numbers/columns.hpp"

namespace ripplenotch {

// Recorded messages, whatever they are recorded in.

/// One topic, as a recording names it.
struct MessageChannel {
    std::string topic, type;      ///< "/joint_states", "sensor_msgs/msg/JointState"
    std::string encoding;         ///< of the messages: "cdr"
    std::string schema_encoding;  ///< "ros2msg"
    std::string schema;           ///< the definition of the type, with those of the types inside it
};

struct RecordedMessage {
    std::size_t channel = 0;  ///< index of MessageSource::channels()
    std::int64_t log_time_ns = 0;
    std::string_view bytes;    ///< until the next message is asked for
    std::uint64_t number = 0;  ///< in the recording, from 1
};

class MessageSource {
  public:
    virtual ~MessageSource() = default;
    /// Grows while messages are read.
    [[nodiscard]] virtual const std::vector<MessageChannel>& channels() const = 0;
    /// False at the end. Throws DataError, beginning with the source's name.
    virtual bool next(RecordedMessage& message) = 0;
    /// Begins again, with the messages of this channel only.
    virtual void restart(std::size_t channel) = 0;
    /// Messages of a channel in the whole recording, where it says so itself.
    [[nodiscard]] virtual std::optional<std::uint64_t> count_of(std::size_t channel) const = 0;
    [[nodiscard]] virtual const std::string& name() const = 0;
};

/// The same recording from its beginning, as often as it is asked for.
using OpenMessages = std::function<std::unique_ptr<MessageSource>()>;

/// The messages of one topic, a row each: of that which --columns names, else of the one whose fields say
/// most. What
/// --columns names of other topics stands beside them, joined by time (ReadOptions::join). Throws DataError
/// where no topic has numbers, UsageError where --columns or --clock ask for what is not there.
[[nodiscard]] ColumnLog columns_of_messages(const OpenMessages& open, const std::string& format,
                                            const ReadOptions& options);

// Which numbers the messages of a topic hold, and how they are read from the next million, whatever the
// encoding.

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

/// The number of a leaf in a message; of types that are whole(), as it is.
struct LeafNumber {
    double value = 0.0;
    std::int64_t count = 0;
};

/// How the numbers of a message are read, by leaf: what is not `wanted` is left as it is. Throws DataError,
/// without a source's name, where a message is not as the first one was: shorter, a list of another length, a
/// joint of another name.
using ReadMessage = std::function<void(std::string_view message, const std::vector<bool>& wanted,
                                       std::vector<LeafNumber>& into)>;

/// What reading throws of a list and of a joint's name.
[[noreturn]] void refuse_length(std::size_t count, const std::string& path, std::size_t expected);
[[noreturn]] void refuse_name(std::string_view name, const std::string& path, const std::string& expected);

struct MessageLayout {
    std::vector<MessageLeaf> leaves;
    ReadMessage read;
};

// Messages are laid out by the first of a topic: lists of numbers have the lengths that they have in it, and
// keep them. Lists longer than 64 and what is empty give no leaves. Throw DataError, without a source's name,
// where the message does not fit its type.

/// In CDR; the type `name` is defined first in `schema`.
[[nodiscard]] MessageLayout lay_out_cdr(std::string_view schema, const std::string& name,
                                        std::string_view message);
/// The definition of a common type, for recordings that carry none; empty where it is not known here.
[[nodiscard]] std::string_view known_ros_schema(std::string_view type);
/// In JSON, an object each. Whether a schema says more about them makes no
/// difference: numbers say that they are. They are 64-bit floats, but for whole ones beyond 2^53.
[[nodiscard]] MessageLayout lay_out_json(std::string_view first);

}  // namespace ripplenotch
