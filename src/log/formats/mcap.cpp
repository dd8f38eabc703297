// SPDX-License-Identifier: MIT
// MCAP recordings: the messages of a topic, by path.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "log/containers/stored_array.hpp"
#include "log/messages/message_columns.hpp"
#include "log/open.hpp"
#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

// The records of an MCAP file (mcap.dev, version 0 of the format), chunks unpacked and checked.

/// What a record is.
enum class McapOpcode : unsigned char {
    footer = 0x02,
    schema = 0x03,
    channel = 0x04,
    message = 0x05,
    chunk = 0x06,
    statistics = 0x0b,
    data_end = 0x0f,
};

struct McapRecord {
    McapOpcode code{};
    std::string_view content;  ///< until the next record is asked for
};

/// Numbers and texts at the front of a record, taken off it. Throw DataError, without a source's name, where
/// it ends.
class McapFields {
  public:
    explicit McapFields(std::string_view content) : rest_(content) {}
    [[nodiscard]] std::uint64_t number(std::size_t size) { return little_endian(bytes(size)); }
    [[nodiscard]] std::string_view text() { return bytes(number(4)); }  ///< behind its length in four bytes
    [[nodiscard]] std::string_view bytes(std::uint64_t size) {
        if (size > rest_.size()) raise<DataError>("a record that ends {} bytes early", size - rest_.size());
        const std::string_view taken = rest_.substr(0, static_cast<std::size_t>(size));
        rest_.remove_prefix(taken.size());
        return taken;
    }
    [[nodiscard]] std::string_view rest() const { return rest_; }

  private:
    std::string_view rest_;
};

constexpr std::string_view magic = "\x89MCAP0\r\n";
constexpr std::size_t head_size = 9, ahead_size = std::size_t{1} << 18;
constexpr std::uint64_t largest_record = std::uint64_t{1} << 28, largest_chunk = std::uint64_t{1} << 27;

void unpack_chunk(std::string_view packed, const Packing& packing, const std::string& source,
                  std::string& into) {
    if (packing.make == nullptr) {
        raise<UsageError>(
            "{}: chunks are packed by {}, and this build was made without {}; install it and build again",
            source, packing.name, packing.lacks);
    }
    const auto unpacker = packing.make();
    std::size_t have = 0;
    while (have < into.size()) {
        const Unpacker::Step step = unpacker->step(packed, std::span(into).subspan(have));
        if (!step.damage.empty()) raise<DataError>("{}", step.damage);
        packed.remove_prefix(step.taken);
        have += step.given;
        if (step.taken == 0 && step.given == 0) break;
    }
    if (have < into.size())
        raise<DataError>("a chunk of {} bytes when unpacked, expected {}", have, into.size());
}

class McapRecords {
  public:
    /// Throws DataError, beginning with the file's name, as next() does.
    explicit McapRecords(std::shared_ptr<StoredBytes> file) : file_(std::move(file)) { restart(); }
    [[nodiscard]] const std::string& name() const { return file_->name(); }
    void require_unchanged() const { file_->require_unchanged(); }
    void restart() {
        at_ = began_ = 0;
        ahead_.clear();
        in_chunk_ = {};
        if (file_->size() < magic.size() || read_on(magic.size()) != magic) fail("no magic of MCAP");
    }
    /// Those of the data section, those inside chunks in place of the chunks. False at its end.
    bool next(McapRecord& record) {
        while (!next_in_chunk(record)) {
            began_ = at_;
            if (at_ == file_->size()) fail("no end of the data; the recording was not closed");
            const std::string_view head = read_on(head_size);
            record.code = static_cast<McapOpcode>(head[0]);
            const std::uint64_t size = little_endian(head.substr(1));
            if (size > largest_record && record.code != McapOpcode{0x09})
                fail(fmt::format("a record of {} bytes, expected {} at most", size, largest_record));
            if (record.code == McapOpcode::data_end || record.code == McapOpcode::footer) return false;
            if (record.code == McapOpcode{0x09} && size > ahead_size) {  // an attachment is no log
                if (size > file_->size() - at_) fail("an attachment that is cut off");
                at_ += size;
                continue;
            }
            record.content = read_on(size);
            if (record.code != McapOpcode::chunk) return true;
            try {
                open_chunk(record.content);
            } catch (const DataError& error) {
                fail(error.what());
            }
        }
        return true;
    }
    /// The whole summary section behind the data; empty where there is none.
    [[nodiscard]] std::string summary() {
        constexpr std::uint64_t footer_size = head_size + 20, tail = footer_size + magic.size();
        const std::uint64_t total = file_->size();
        if (total < tail + magic.size()) return {};
        const std::string footer = file_->text_at(total - tail, tail);
        if (footer.substr(footer_size) != magic || footer[0] != '\x02') return {};
        const std::uint64_t start = little_endian(std::string_view(footer).substr(head_size, 8)),
                            end = total - tail;
        if (start == 0 || start >= end || end - start > largest_record) return {};
        return file_->text_at(start, static_cast<std::size_t>(end - start));
    }
    /// What is wrong, with the place in the file.
    [[noreturn]] void fail(const std::string& what) const {
        raise<DataError>("{}: read at byte {} {}; 'mcap recover' saves what can be read", name(), began_,
                         what);
    }

  private:
    bool next_in_chunk(McapRecord& record) {
        if (in_chunk_.empty()) return false;
        McapFields fields(in_chunk_);
        try {
            record.code = static_cast<McapOpcode>(fields.number(1));
            record.content = fields.bytes(fields.number(8));
        } catch (const DataError& error) {
            fail(fmt::format("a chunk with {}", error.what()));
        }
        in_chunk_ = fields.rest();
        return true;
    }
    void open_chunk(std::string_view content) {
        McapFields fields(content);
        static_cast<void>(fields.bytes(16));  // first and last time
        const std::uint64_t size = fields.number(8);
        const auto checksum = static_cast<std::uint32_t>(fields.number(4));
        const std::string_view compression = fields.text();
        const std::string_view packed = fields.bytes(fields.number(8));
        if (size > largest_chunk)
            raise<DataError>("a chunk of {} bytes when unpacked, expected {} at most", size, largest_chunk);
        if (compression.empty()) {
            if (packed.size() != size)
                raise<DataError>("a chunk of {} bytes, expected {}", packed.size(), size);
            chunk_ = packed;
        } else {
            const Packing* const packing = compression == "zstd"  ? &packings::zstd
                                           : compression == "lz4" ? &packings::lz4
                                                                  : nullptr;
            if (packing == nullptr)
                raise<DataError>("a chunk packed as '{}', expected zstd, lz4 or none",
                                 compression.substr(0, 20));
            chunk_.resize(static_cast<std::size_t>(size));
            unpack_chunk(packed, *packing, name(), chunk_);
        }
        if (const auto found = crc32_of(chunk_); checksum != 0 && found && *found != checksum)
            raise<DataError>("a chunk with the checksum {:08x}, expected {:08x}: its bytes are damaged",
                             *found, checksum);
        in_chunk_ = chunk_;
    }
    // The next bytes of the file; small ones come out of a piece that was read ahead.
    std::string_view read_on(std::uint64_t size) {
        const std::uint64_t total = file_->size();
        if (size > total || at_ > total - size)
            fail(fmt::format("a record of {} bytes, of which {} are there; the file is cut off", size,
                             total - std::min(at_, total)));
        const bool there = at_ >= ahead_at_ && at_ + size <= ahead_at_ + ahead_.size();
        if (!there) {
            const std::uint64_t piece = std::min(std::max<std::uint64_t>(size, ahead_size), total - at_);
            ahead_.resize(static_cast<std::size_t>(piece));
            file_->read_at(at_, ahead_.data(), ahead_.size());
            ahead_at_ = at_;
        }
        const auto part = std::string_view(ahead_).substr(static_cast<std::size_t>(at_ - ahead_at_),
                                                          static_cast<std::size_t>(size));
        at_ += size;
        return part;
    }

    std::shared_ptr<StoredBytes> file_;
    std::uint64_t at_ = 0, began_ = 0;  ///< of the record in the file
    std::uint64_t ahead_at_ = 0;
    std::string ahead_, chunk_;
    std::string_view in_chunk_;
};

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
    void restart(std::size_t channel) override {
        records_.restart();
        wanted_ = channel;
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
        if (wanted_.value_or(last_index_) != last_index_) return false;
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
    std::optional<std::size_t> wanted_;  ///< the one channel whose messages are; else all
    int last_id_ = -1;
    std::size_t last_index_ = 0;
    std::uint64_t number_ = 0;
};

constexpr std::array<std::string_view, 1> mcap_extensions = {".mcap"};

ColumnLog make_mcap(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    const auto file = store_bytes(std::move(source), std::move(first_bytes));
    return columns_of_messages([file] { return std::make_unique<McapMessages>(file); }, "mcap", options);
}

}  // namespace

const LogFormat formats::mcap{
    .name = "mcap",
    .summary = "MCAP recordings of ROS 2: JointState, and every message of numbers by path",
    .extensions = mcap_extensions,
    .binary = true,
    .sniff = [](std::string_view bytes) { return bytes.starts_with("\x89MCAP"); },
    .columns = make_mcap,
};

}  // namespace ripplenotch
