// SPDX-License-Identifier: MIT
#pragma once
// Recorded messages, whatever they are recorded in.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/containers/stored_bytes.hpp"
#include "log/records/open_records.hpp"

namespace ripplenotch {

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
    /// Begins again, with the messages of these channels only.
    virtual void restart(const std::vector<std::size_t>& channels) = 0;
    /// Messages of a channel in the whole recording, where it says so itself.
    [[nodiscard]] virtual std::optional<std::uint64_t> count_of(std::size_t /*channel*/) const {
        return std::nullopt;
    }
    [[nodiscard]] virtual const std::string& name() const = 0;
};

[[nodiscard]] std::unique_ptr<MessageSource> open_mcap(std::shared_ptr<StoredBytes> file);
[[nodiscard]] std::unique_ptr<MessageSource> open_rosbag2(std::shared_ptr<StoredBytes> file);

/// The same recording from its beginning, as often as it is asked for.
using OpenMessages = std::function<std::unique_ptr<MessageSource>()>;

/// The records of one topic: of that which --columns names, else of the one whose fields say most. What
/// --columns names of other topics stands beside them, joined by time (ReadOptions::join). Throws DataError
/// where no topic has numbers, UsageError where --columns or --clock ask for what is not there.
[[nodiscard]] Records records_of_messages(const OpenMessages& open, const std::string& format,
                                          const ReadOptions& options);

}  // namespace ripplenotch
