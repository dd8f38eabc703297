// SPDX-License-Identifier: MIT
// The messages of a rosbag2 recording in SQLite (storage sqlite3: tables topics, messages,
// message_definitions), by libsqlite3.

#if defined(RIPPLENOTCH_HAS_SQLITE)
#include <sqlite3.h>
#endif

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "log/messages/message_columns.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 1> rosbag2_extensions = {".db3"};

#if defined(RIPPLENOTCH_HAS_SQLITE)

class Statement {
  public:
    Statement(sqlite3* database, const std::string& sql, const std::string& source)
        : database_(database), source_(source) {
        if (::sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK) fail();
    }
    ~Statement() { ::sqlite3_finalize(statement_); }
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;
    bool step() {
        const int result = ::sqlite3_step(statement_);
        if (result != SQLITE_ROW && result != SQLITE_DONE) fail();
        return result == SQLITE_ROW;
    }
    [[nodiscard]] std::int64_t number(int column) const { return ::sqlite3_column_int64(statement_, column); }
    [[nodiscard]] std::string_view bytes(int column) const {
        const void* const data = ::sqlite3_column_blob(statement_, column);
        const auto size = static_cast<std::size_t>(::sqlite3_column_bytes(statement_, column));
        return data == nullptr ? std::string_view() : std::string_view(static_cast<const char*>(data), size);
    }

  private:
    [[noreturn]] void fail() const {
        raise<DataError>("{}: read an SQLite file, expected a whole recording of rosbag2: {}", source_,
                         ::sqlite3_errmsg(database_));
    }
    sqlite3* database_;
    const std::string& source_;
    sqlite3_stmt* statement_ = nullptr;
};

class Rosbag2Messages final : public MessageSource {
  public:
    explicit Rosbag2Messages(std::shared_ptr<StoredBytes> file)
        : file_(std::move(file)), database_(nullptr, ::sqlite3_close) {
        require_all_pages();
        file_->with_name([this](const std::string& path) { open(path); });
        // What lies in a stranger's schema is not run.
        ::sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
        ::sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
        // A cell that reaches beyond its page is a fault, not whatever lies in memory there.
        ::sqlite3_exec(database_.get(), "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
        for (const char* const table : {"topics", "messages"}) {
            if (is_table(table)) continue;
            raise<DataError>(
                "{}: read an SQLite file without the table {}, expected a recording of rosbag2 (.db3)",
                name(), table);
        }
        read_channels();
        restart_all("");
    }
    [[nodiscard]] const std::vector<MessageChannel>& channels() const override { return channels_; }
    [[nodiscard]] const std::string& name() const override { return file_->name(); }
    [[nodiscard]] std::optional<std::uint64_t> count_of(std::size_t channel) const override {
        Statement count(database_.get(),
                        fmt::format("SELECT count(*) FROM messages WHERE topic_id = {}", ids_[channel]),
                        name());
        return count.step() ? std::optional<std::uint64_t>(static_cast<std::uint64_t>(count.number(0)))
                            : std::nullopt;
    }
    void restart(std::size_t channel) override {
        restart_all(fmt::format("WHERE topic_id = {}", ids_[channel]));
    }
    bool next(RecordedMessage& message) override {
        while (messages_->step()) {
            const auto found = index_of_.find(messages_->number(0));
            if (found == index_of_.end()) continue;
            message.channel = found->second;
            message.log_time_ns = messages_->number(1);
            message.bytes = messages_->bytes(2);
            message.number = static_cast<std::uint64_t>(messages_->number(3));
            return true;
        }
        file_->require_unchanged();
        return false;
    }

  private:
    // What is cut off would read as zeros. The head (SQLite's file format) says the size of a page, and how
    // many.
    void require_all_pages() const {
        constexpr std::uint64_t head_size = 100, largest_page = 65536;
        const std::string head = file_->text_at(0, head_size);
        const auto number = [&](std::size_t at, std::size_t size) {
            std::string bytes = head.substr(at, size);
            std::ranges::reverse(bytes);  // the most significant byte first
            return little_endian(bytes);
        };
        const std::uint64_t page = number(16, 2) == 1 ? largest_page : number(16, 2), pages = number(28, 4);
        const bool counted = pages > 0 && number(24, 4) == number(92, 4);
        if (page > 0 && file_->size() % page == 0 && (!counted || file_->size() / page >= pages)) return;
        raise<DataError>(
            "{}: read an SQLite file of {} bytes, expected {} pages of {}; it is cut off, copy it again",
            name(), file_->size(), counted ? std::to_string(pages) : "whole", page);
    }
    void open(const std::string& path) {
        std::string uri = "file:";
        for (const char c : path)
            uri += c == '?' || c == '#' || c == '%' ? fmt::format("%{:02X}", c) : std::string(1, c);
        sqlite3* database = nullptr;
        const int result = ::sqlite3_open_v2((uri + "?immutable=1").c_str(), &database,
                                             SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
        database_.reset(database);
        if (result != SQLITE_OK)
            raise<DataError>("{}: cannot be opened as an SQLite file: {}", name(),
                             ::sqlite3_errmsg(database));
    }
    bool is_table(const std::string& table) {
        Statement found(
            database_.get(),
            fmt::format("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = '{}'", table), name());
        return found.step();
    }
    void read_channels() {
        std::map<std::string, std::pair<std::string, std::string>> definitions;
        if (is_table("message_definitions")) {
            Statement rows(database_.get(),
                           "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions",
                           name());
            while (rows.step())
                definitions[std::string(rows.bytes(0))] = {std::string(rows.bytes(1)),
                                                           std::string(rows.bytes(2))};
        }
        Statement rows(database_.get(), "SELECT id, name, type, serialization_format FROM topics ORDER BY id",
                       name());
        while (rows.step()) {
            MessageChannel channel{std::string(rows.bytes(1)), std::string(rows.bytes(2)),
                                   std::string(rows.bytes(3)), "", ""};
            if (const auto found = definitions.find(channel.type); found != definitions.end())
                std::tie(channel.schema_encoding, channel.schema) = found->second;
            if (channel.schema_encoding != "ros2msg" && channel.schema_encoding != "ros2idl")
                channel.schema.clear();
            index_of_[rows.number(0)] = channels_.size();
            ids_.push_back(rows.number(0));
            channels_.push_back(std::move(channel));
        }
    }
    void restart_all(const std::string& where) {
        messages_.emplace(
            database_.get(),
            fmt::format("SELECT topic_id, timestamp, data, id FROM messages {} ORDER BY id", where), name());
    }

    std::shared_ptr<StoredBytes> file_;
    std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
    std::vector<MessageChannel> channels_;
    std::vector<std::int64_t> ids_;
    std::map<std::int64_t, std::size_t> index_of_;
    std::optional<Statement> messages_;
};

ColumnLog make_rosbag2(std::unique_ptr<ByteSource> source, std::string first_bytes,
                       const ReadOptions& options) {
    const auto file = store_bytes(std::move(source), std::move(first_bytes));
    return columns_of_messages([file] { return std::make_unique<Rosbag2Messages>(file); }, "rosbag2",
                               options);
}

#endif

}  // namespace

const LogFormat formats::rosbag2 {
    .name = "rosbag2", .summary = "rosbag2 recordings in SQLite (.db3), as mcap",
    .extensions = rosbag2_extensions, .binary = true,
#if !defined(RIPPLENOTCH_HAS_SQLITE)
    .lacks = "libsqlite3",
#endif
    .sniff = [](std::string_view bytes) { return bytes.starts_with("SQLite format 3"); },
#if defined(RIPPLENOTCH_HAS_SQLITE)
    .columns = make_rosbag2,
#endif
};

}  // namespace ripplenotch
