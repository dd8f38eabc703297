// SPDX-License-Identifier: MIT
#include "log/messages/mcap_records.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "log/unpack/unpacker.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view magic = "\x89MCAP0\r\n";
constexpr std::size_t head_size = 9, ahead_size = std::size_t{1} << 18;
constexpr std::uint64_t largest_record = std::uint64_t{1} << 28, largest_chunk = std::uint64_t{1} << 27;

std::uint64_t little_endian(std::string_view bytes) {
    std::uint64_t number = 0;
    for (std::size_t i = bytes.size(); i-- > 0;) number = number << 8U | static_cast<unsigned char>(bytes[i]);
    return number;
}

void unpack_chunk(std::string_view packed, const Packing& packing, const std::string& source,
                  std::string& into) {
    if (packing.make == nullptr) {
        raise<UsageError>(
            "{}: chunks are packed by {}, and this build was made without {}; install it and build "
            "again",
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

}  // namespace

std::uint64_t McapFields::number(std::size_t size) { return little_endian(bytes(size)); }

std::string_view McapFields::text() { return bytes(number(4)); }

std::string_view McapFields::bytes(std::uint64_t size) {
    if (size > rest_.size()) raise<DataError>("a record that ends {} bytes early", size - rest_.size());
    const std::string_view taken = rest_.substr(0, static_cast<std::size_t>(size));
    rest_.remove_prefix(taken.size());
    return taken;
}

McapRecords::McapRecords(std::shared_ptr<StoredBytes> file) : file_(std::move(file)) { restart(); }

void McapRecords::fail(const std::string& what) const {
    raise<DataError>("{}: read at byte {} {}; 'mcap recover' saves what can be read", name(), began_, what);
}

void McapRecords::restart() {
    at_ = began_ = 0;
    ahead_.clear();
    in_chunk_ = {};
    if (file_->size() < magic.size() || read_on(magic.size()) != magic) fail("no magic of MCAP");
}

// The next bytes of the file; small ones come out of a piece that was read ahead.
std::string_view McapRecords::read_on(std::uint64_t size) {
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

bool McapRecords::next_in_chunk(McapRecord& record) {
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

bool McapRecords::next(McapRecord& record) {
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

void McapRecords::open_chunk(std::string_view content) {
    McapFields fields(content);
    static_cast<void>(fields.bytes(16));  // first and last time
    const std::uint64_t size = fields.number(8);
    const auto checksum = static_cast<std::uint32_t>(fields.number(4));
    const std::string_view compression = fields.text();
    const std::string_view packed = fields.bytes(fields.number(8));
    if (size > largest_chunk)
        raise<DataError>("a chunk of {} bytes when unpacked, expected {} at most", size, largest_chunk);
    if (compression.empty()) {
        if (packed.size() != size) raise<DataError>("a chunk of {} bytes, expected {}", packed.size(), size);
        chunk_ = packed;
    } else {
        const Packing* const packing = compression == "zstd"  ? &packings::zstd
                                       : compression == "lz4" ? &packings::lz4
                                                              : nullptr;
        if (packing == nullptr)
            raise<DataError>("a chunk packed as '{}', expected zstd, lz4 or none", compression.substr(0, 20));
        chunk_.resize(static_cast<std::size_t>(size));
        unpack_chunk(packed, *packing, name(), chunk_);
    }
    if (const auto found = crc32_of(chunk_); checksum != 0 && found && *found != checksum)
        raise<DataError>("a chunk with the checksum {:08x}, expected {:08x}: its bytes are damaged", *found,
                         checksum);
    in_chunk_ = chunk_;
}

std::string McapRecords::summary() {
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

}  // namespace ripplenotch
