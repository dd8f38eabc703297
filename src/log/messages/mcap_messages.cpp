// SPDX-License-Identifier: MIT
// The messages of an MCAP file.

#include <fmt/format.h>

#include <map>

#include "log/messages/mcap_records.hpp"
#include "log/messages/message_source.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

class McapMessages final : public MessageSource {
  public:
    explicit McapMessages(std::shared_ptr<StoredBytes> file) : records_(std::move(file)) { read_summary(); }
    [[nodiscard]] const std::vector<MessageChannel>& channels() const override { return channels_; }
    [[nodiscard]] const std::string& name() const override { return records_.name(); }
    [[nodiscard]] std::optional<std::uint64_t> count_of(std::size_t channel) const override {
        for (const auto& [id, index] : index_of_) {
            if (index != channel) continue;
            const auto found = counts_.find(id);
            if (found != counts_.end()) return found->second;
        }
        return std::nullopt;
    }
    void restart(const std::vector<std::size_t>& channels) override {
        records_.restart();
        wanted_.assign(channels_.size(), false);
        for (const std::size_t channel : channels) wanted_[channel] = true;
        all_ = false;
        number_ = 0;
    }
    bool next(RecordedMessage& message) override {
        McapRecord record;
        while (records_.next(record)) {
            try {
                if (take(record, message)) return true;
            } catch (const DataError& error) {
                records_.fail(error.what());
            }
        }
        records_.require_unchanged();
        return false;
    }

  private:
    bool take(const McapRecord& record, RecordedMessage& message) {
        if (record.code == McapOpcode::schema) add_schema(record.content);
        if (record.code == McapOpcode::channel) add_channel(record.content);
        if (record.code != McapOpcode::message) return false;
        ++number_;
        McapFields fields(record.content);
        const auto id = static_cast<std::uint16_t>(fields.number(2));
        if (id != last_id_) {
            const auto found = index_of_.find(id);
            if (found == index_of_.end())
                raise<DataError>("a message of channel {}, which was not announced", id);
            last_id_ = id;
            last_index_ = found->second;
        }
        if (!all_ && (last_index_ >= wanted_.size() || !wanted_[last_index_])) return false;
        static_cast<void>(fields.bytes(4));  // sequence
        message.channel = last_index_;
        message.log_time_ns = static_cast<std::int64_t>(fields.number(8));
        static_cast<void>(fields.bytes(8));  // time of publishing
        message.bytes = fields.rest();
        message.number = number_;
        return true;
    }
    void add_schema(std::string_view content) {
        McapFields fields(content);
        const auto id = static_cast<std::uint16_t>(fields.number(2));
        Schema schema;
        schema.name = fields.text();
        schema.encoding = fields.text();
        schema.text = fields.text();
        schemas_.emplace(id, std::move(schema));
    }
    void add_channel(std::string_view content) {
        McapFields fields(content);
        const auto id = static_cast<std::uint16_t>(fields.number(2));
        const auto schema = schemas_.find(static_cast<std::uint16_t>(fields.number(2)));
        if (index_of_.count(id) > 0) return;
        MessageChannel channel;
        channel.topic = fields.text();
        channel.encoding = fields.text();
        if (schema != schemas_.end()) {
            channel.type = schema->second.name;
            channel.schema_encoding = schema->second.encoding;
            channel.schema = schema->second.text;
        }
        index_of_[id] = channels_.size();
        channels_.push_back(std::move(channel));
    }
    // Channels and counts, where the recording was closed; a summary that is damaged is done without.
    void read_summary() try {
        const std::string summary = records_.summary();
        McapFields all(summary);
        while (!all.rest().empty()) {
            const auto code = static_cast<McapOpcode>(all.number(1));
            const std::string_view content = all.bytes(all.number(8));
            if (code == McapOpcode::schema) add_schema(content);
            if (code == McapOpcode::channel) add_channel(content);
            if (code == McapOpcode::statistics) read_counts(content);
        }
    } catch (const DataError&) {
        counts_.clear();
    }
    void read_counts(std::string_view content) {
        McapFields fields(content);
        static_cast<void>(fields.bytes(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8));
        McapFields pairs(fields.text());
        while (!pairs.rest().empty()) {
            const auto id = static_cast<std::uint16_t>(pairs.number(2));
            counts_[id] = pairs.number(8);
        }
    }

    struct Schema {
        std::string name, encoding, text;
    };
    McapRecords records_;
    std::map<std::uint16_t, Schema> schemas_;
    std::vector<MessageChannel> channels_;
    std::map<std::uint16_t, std::size_t> index_of_;
    std::map<std::uint16_t, std::uint64_t> counts_;
    std::vector<bool> wanted_;
    bool all_ = true;
    int last_id_ = -1;
    std::size_t last_index_ = 0;
    std::uint64_t number_ = 0;
};

}  // namespace

std::unique_ptr<MessageSource> open_mcap(std::shared_ptr<StoredBytes> file) {
    return std::make_unique<McapMessages>(std::move(file));
}

}  // namespace ripplenotch
