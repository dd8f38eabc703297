// SPDX-License-Identifier: MIT
#pragma once
// The messages of one topic as the bytes of records: a row a message.

#include <cstring>
#include <string>
#include <vector>

#include "log/messages/message_layout.hpp"
#include "log/messages/message_source.hpp"
#include "log/records/record_table.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

/// The clock, then the leaves but for the one that is it.
[[nodiscard]] inline std::vector<std::size_t> leaves_beside_clock(const MessageLayout& layout,
                                                                  bool header_clock) {
    std::vector<std::size_t> leaves;
    for (std::size_t l = 0; l < layout.leaves.size(); ++l)
        if (!(layout.leaves[l].clock && header_clock)) leaves.push_back(l);
    return leaves;
}

/// Field 0 is the clock, in nanoseconds; behind it stand leaves_beside_clock().
class MessageRecords final : public RecordSource {
  public:
    /// `header_clock`: the layout has a leaf that is the clock, and it is taken; else the time of recording.
    MessageRecords(std::unique_ptr<MessageSource> source, std::size_t channel, MessageLayout layout,
                   bool header_clock)
        : RecordSource(Name{source->name()}, sizes_of(layout, header_clock)),
          source_(std::move(source)),
          topic_(source_->channels()[channel].topic),
          layout_(std::move(layout)),
          header_clock_(header_clock) {
        source_->restart({channel});
        settle();
    }

  private:
    static constexpr std::size_t buffered_rows = std::size_t{1} << 18;  // bytes

    static std::vector<std::size_t> sizes_of(const MessageLayout& layout, bool header_clock) {
        std::vector<std::size_t> sizes = {sizeof(std::int64_t)};
        for (const std::size_t leaf : leaves_beside_clock(layout, header_clock))
            sizes.push_back(layout.leaves[leaf].type.size);
        return sizes;
    }
    void chosen() override { settle(); }
    void settle() {
        const auto beside = leaves_beside_clock(layout_, header_clock_);
        offsets_.assign(layout_.leaves.size(), -1);
        clock_offset_ = -1;
        std::ptrdiff_t at = 0;
        for (const std::size_t field : kept()) {
            if (field > 0) {
                offsets_[beside[field - 1]] = at;
                at += static_cast<std::ptrdiff_t>(layout_.leaves[beside[field - 1]].type.size);
                continue;
            }
            if (!header_clock_) clock_offset_ = at;
            for (std::size_t l = 0; header_clock_ && l < layout_.leaves.size(); ++l)
                if (layout_.leaves[l].clock) offsets_[l] = at;
            at += sizeof(std::int64_t);
        }
        reader_ = layout_.program->reader(offsets_);
    }
    void refill(std::string& bytes) override {
        RecordedMessage message;
        while (!ended_ && bytes.size() < buffered_rows) {
            ended_ = !source_->next(message);
            if (ended_) return;
            const std::size_t at = bytes.size();
            bytes.resize(at + record_size());
            try {
                reader_->read(message.bytes, bytes.data() + at);
            } catch (const DataError& error) {
                raise<DataError>("{}: message {}, {}: read {}", name(), message.number, topic_, error.what());
            }
            if (clock_offset_ >= 0) std::memcpy(bytes.data() + at + clock_offset_, &message.log_time_ns, 8);
        }
    }

    std::unique_ptr<MessageSource> source_;
    std::string topic_;
    MessageLayout layout_;
    bool header_clock_;
    LeafOffsets offsets_;
    std::ptrdiff_t clock_offset_ = -1;
    std::unique_ptr<MessageReader> reader_;
    bool ended_ = false;  ///< behind it some sources would begin again
};

}  // namespace ripplenotch
