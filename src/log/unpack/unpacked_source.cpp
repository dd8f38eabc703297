// SPDX-License-Identifier: MIT
#include "log/unpack/unpacked_source.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <future>
#include <vector>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::span<const Packing* const> all_packings() {
    static constexpr std::array all = {&packings::gzip, &packings::zstd, &packings::lz4};
    return all;
}

const Packing* packing_of(std::string_view first_bytes) {
    for (const Packing* packing : all_packings()) {
        if (first_bytes.starts_with(packing->magic)) return packing;
    }
    return nullptr;
}

namespace {

// Throws UsageError, beginning with `source`, where this build cannot unpack it.
std::unique_ptr<Unpacker> unpacker_of(const Packing& packing, const std::string& source) {
    if (packing.make == nullptr) {
        raise<UsageError>(
            "{}: read a {} file, and this build was made without {}; unpack it: {} {} | ripplenotch ... -",
            source, packing.name, packing.lacks, packing.program, source);
    }
    return packing.make();
}

/// Bytes that give more than this many times what they take are no log but a trap; asked only once so much
/// has come out.
constexpr std::uint64_t most_unpacked_for_one = 500, unpacked_unasked = std::uint64_t{64} << 20;

constexpr std::size_t packed_piece = std::size_t{1} << 16;
constexpr std::size_t unpacked_piece = std::size_t{1} << 18;
constexpr std::size_t room_size = std::size_t{1} << 16;

/// In the thread of who reads.
class UnpackedBytes : public ByteSource {
  public:
    UnpackedBytes(std::unique_ptr<ByteSource> packed, std::string first_bytes, const Packing& packing)
        : ByteSource(Name{packed->name()}),
          packed_(std::move(packed)),
          packing_(packing),
          unpacker_(unpacker_of(packing, packed_->name())),
          first_(std::move(first_bytes)),
          left_(first_),
          packed_room_(std::make_unique_for_overwrite<char[]>(packed_piece)),
          room_(std::make_unique_for_overwrite<char[]>(room_size)) {}

    std::size_t read(char* into, std::size_t size) override {
        if (size == 0) return 0;
        try {
            // Into a room of its own: libraries give more or less of what lies before the damage by how much
            // room they have.
            if (waiting_.empty()) waiting_ = {room_.get(), unpack_some({room_.get(), room_size})};
        } catch (const DataError& error) {
            raise<DataError>("{}: read {} bytes out of {}, expected more of the log: {}", name(), given_,
                             packing_.name, error.what());
        }
        const std::size_t count = std::min(size, waiting_.size());
        std::copy_n(waiting_.data(), count, into);
        waiting_.remove_prefix(count);
        return count;
    }

  private:
    std::size_t unpack_some(std::span<char> into) {
        for (;;) {
            if (left_.empty() && !source_ended_) refill();
            if (!damage_.empty()) raise<DataError>("{}", damage_);
            const Unpacker::Step step = unpacker_->step(left_, into);
            damage_ = step.damage;
            left_.remove_prefix(step.taken);
            taken_ += step.taken;
            given_ += step.given;
            refuse_bomb();
            if (step.given > 0) return step.given;
            if (step.taken > 0 || !source_ended_ || !damage_.empty()) continue;
            if (!left_.empty()) raise<DataError>("what follows is no {}; cut it off", packing_.name);
            if (unpacker_->complete()) return 0;
            raise<DataError>(
                "the file is cut off; copy it again, or use what is there: {} FILE | ripplenotch ... -",
                packing_.program);
        }
    }
    void refill() {
        left_ = {packed_room_.get(), packed_->read(packed_room_.get(), packed_piece)};
        source_ended_ = left_.empty();
    }
    void refuse_bomb() const {
        if (given_ < unpacked_unasked || given_ / most_unpacked_for_one < taken_) return;
        raise<DataError>(
            "no log is {} times smaller when packed; if you trust it: {} FILE | ripplenotch ... -",
            most_unpacked_for_one, packing_.program);
    }

    std::unique_ptr<ByteSource> packed_;
    const Packing& packing_;
    std::unique_ptr<Unpacker> unpacker_;
    std::string first_;      ///< of the packed bytes
    std::string_view left_;  ///< of them, or of what was read last
    std::unique_ptr<char[]> packed_room_, room_;
    std::string_view waiting_;  ///< of the room
    bool source_ended_ = false;
    std::string damage_;  ///< behind what was given
    std::uint64_t taken_ = 0, given_ = 0;
};

/// What another source gives, a piece ahead in another thread.
class ReadAhead : public ByteSource {
  public:
    explicit ReadAhead(std::unique_ptr<ByteSource> source)
        : ByteSource(Name{source->name()}), source_(std::move(source)) {
        begin({});
    }

    std::size_t read(char* into, std::size_t size) override {
        if (given_ == current_.bytes.size() && !current_.failure && next_.valid()) {
            Piece piece = next_.get();
            if (!piece.bytes.empty() && !piece.failure) begin(std::move(current_.bytes));
            current_ = std::move(piece);
            given_ = 0;
        }
        const std::size_t count = std::min(size, current_.bytes.size() - given_);
        if (count == 0 && current_.failure) std::rethrow_exception(current_.failure);
        std::copy_n(current_.bytes.data() + given_, count, into);
        given_ += count;
        return count;
    }

  private:
    struct Piece {
        std::vector<char> bytes;
        std::exception_ptr failure;  ///< behind the bytes
    };
    void begin(std::vector<char> room) {
        next_ = std::async(std::launch::async, [this, bytes = std::move(room)]() mutable {
            Piece piece{std::move(bytes), nullptr};
            std::size_t have = 0;
            try {
                piece.bytes.resize(unpacked_piece);
                for (std::size_t got = 1; have < unpacked_piece && got > 0; have += got)
                    got = source_->read(piece.bytes.data() + have, unpacked_piece - have);
            } catch (...) {
                piece.failure = std::current_exception();
            }
            piece.bytes.resize(have);
            return piece;
        });
    }

    std::unique_ptr<ByteSource> source_;
    Piece current_;
    std::size_t given_ = 0;    ///< of the current piece
    std::future<Piece> next_;  ///< last: what it uses is there before it and behind it
};

}  // namespace

std::unique_ptr<ByteSource> unpack(std::unique_ptr<ByteSource> packed, std::string first_bytes,
                                   const Packing& packing) {
    const bool is_file = packed->by_place();
    auto bytes = std::make_unique<UnpackedBytes>(std::move(packed), std::move(first_bytes), packing);
    if (!is_file) return bytes;
    return std::make_unique<ReadAhead>(std::move(bytes));
}

}  // namespace ripplenotch
