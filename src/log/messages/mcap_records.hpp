// SPDX-License-Identifier: MIT
#pragma once
// The records of an MCAP file (mcap.dev, version 0 of the format), chunks unpacked and checked.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "log/containers/stored_bytes.hpp"

namespace ripplenotch {

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
    [[nodiscard]] std::uint64_t number(std::size_t size);
    [[nodiscard]] std::string_view text();  ///< behind its length in four bytes
    [[nodiscard]] std::string_view bytes(std::uint64_t size);
    [[nodiscard]] std::string_view rest() const { return rest_; }

  private:
    std::string_view rest_;
};

class McapRecords {
  public:
    /// Throws DataError, beginning with the file's name, as next() does.
    explicit McapRecords(std::shared_ptr<StoredBytes> file);
    /// Those of the data section, those inside chunks in place of the chunks. False at its end.
    bool next(McapRecord& record);
    void restart();
    /// The whole summary section behind the data; empty where there is none.
    [[nodiscard]] std::string summary();
    [[nodiscard]] const std::string& name() const { return file_->name(); }
    void require_unchanged() const { file_->require_unchanged(); }
    /// What is wrong, with the place in the file.
    [[noreturn]] void fail(const std::string& what) const;

  private:
    bool next_in_chunk(McapRecord& record);
    void open_chunk(std::string_view content);
    std::string_view read_on(std::uint64_t size);

    std::shared_ptr<StoredBytes> file_;
    std::uint64_t at_ = 0, began_ = 0;  ///< of the record in the file
    std::uint64_t ahead_at_ = 0;
    std::string ahead_, chunk_;
    std::string_view in_chunk_;
};

}  // namespace ripplenotch
