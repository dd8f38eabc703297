// SPDX-License-Identifier: MIT
// The compressions, one library each: gzip (RFC 1952) and deflate by zlib, zstd (RFC 8878) by libzstd, lz4
// frames by liblz4. A build without a library knows the files that need it, and refuses them.

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/error.hpp"

#if defined(RIPPLENOTCH_HAS_ZLIB)
#include <zlib.h>
#endif
#if defined(RIPPLENOTCH_HAS_ZSTD)
#include <zstd.h>
#endif
#if defined(RIPPLENOTCH_HAS_LZ4)
#include <lz4frame.h>
#endif

namespace ripplenotch {
namespace {

/// Compressed bytes in whole units, as libzstd and liblz4 ask for them, however they arrive. A call that
/// meets damage does not say what it has given before; with whole units it has given nothing, and what was
/// given before it does not depend on the pieces.
class WholeUnits {
  public:
    /// The next unit, whole or empty; takes from `packed` what it keeps for later and says how much.
    [[nodiscard]] std::string_view next(std::string_view packed, std::size_t& taken) {
        taken = 0;
        from_kept_ = !kept_.empty() || packed.size() < wanted_;
        if (!from_kept_) return packed.substr(0, wanted_);
        if (kept_.size() < wanted_) {
            taken = std::min(packed.size(), wanted_ - kept_.size());
            kept_.append(packed.substr(0, taken));
        }
        return std::string_view(kept_).substr(0, kept_.size() < wanted_ ? 0 : wanted_);
    }

    /// What the library used of the unit, and the size of the one that it wants next.
    void used(std::size_t size, std::size_t wanted, std::size_t& taken) {
        if (from_kept_)
            kept_.erase(0, size);
        else
            taken = size;
        wanted_ = std::max<std::size_t>(1, wanted);
    }

    [[nodiscard]] bool keeps_some() const { return !kept_.empty(); }

  private:
    std::string kept_;
    std::size_t wanted_ = 1;
    bool from_kept_ = false;
};

#if defined(RIPPLENOTCH_HAS_ZLIB)
class GzipUnpacker final : public Unpacker {
  public:
    /// `window_bits` as zlib has them: they say the wrapping, too.
    explicit GzipUnpacker(int window_bits = 16 + MAX_WBITS, std::string_view kind = "gzip") : kind_(kind) {
        if (::inflateInit2(&stream_, window_bits) != Z_OK) raise<DataError>("no memory to unpack gzip");
    }
    ~GzipUnpacker() override { ::inflateEnd(&stream_); }

    Step step(std::string_view packed, std::span<char> into) override {
        std::size_t skipped = 0;
        if (ended_) {
            // Tapes and disks fill the last block with zeros.
            skipped = std::min(packed.find_first_not_of('\0'), packed.size());
            if (skipped == packed.size()) return {skipped, 0, {}};
            ::inflateReset(&stream_);
            ended_ = false;
        }
        const std::string_view rest = packed.substr(skipped);
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest.data()));
        stream_.avail_in = static_cast<uInt>(rest.size());
        stream_.next_out = reinterpret_cast<Bytef*>(into.data());
        stream_.avail_out = static_cast<uInt>(into.size());
        const int result = ::inflate(&stream_, Z_NO_FLUSH);
        Step step{packed.size() - stream_.avail_in, into.size() - stream_.avail_out, {}};
        if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
            step.damage = fmt::format("the {} data are damaged ({})", kind_,
                                      stream_.msg != nullptr ? stream_.msg : "unknown reason");
        ended_ = result == Z_STREAM_END;
        return step;
    }
    [[nodiscard]] bool complete() const override { return ended_; }

  private:
    z_stream stream_{};
    std::string_view kind_;
    bool ended_ = false;
};
#else
using GzipUnpacker = void;
#endif

#if defined(RIPPLENOTCH_HAS_ZSTD)
class ZstdUnpacker final : public Unpacker {
  public:
    ZstdUnpacker() : stream_(::ZSTD_createDStream(), ::ZSTD_freeDStream) {
        constexpr int largest_window_log =
            27;  // 128 MiB, what zstd itself takes without being asked for more
        if (!stream_) raise<DataError>("no memory to unpack zstd");
        ::ZSTD_DCtx_setParameter(stream_.get(), ZSTD_d_windowLogMax, largest_window_log);
    }

    Step step(std::string_view packed, std::span<char> into) override {
        Step step;
        // What waits within libzstd comes out first: with a damaged unit it would be lost.
        const std::string_view unit = room_was_full_ ? std::string_view() : units_.next(packed, step.taken);
        // libzstd takes it for a fault to be called often for nothing.
        if (unit.empty() && !room_was_full_) return step;
        ZSTD_inBuffer in{unit.data(), unit.size(), 0};
        ZSTD_outBuffer out{into.data(), into.size(), 0};
        const std::size_t left = ::ZSTD_decompressStream(stream_.get(), &out, &in);
        if (::ZSTD_isError(left) != 0) {
            step.damage = fmt::format("the zstd data are damaged ({})", ::ZSTD_getErrorName(left));
            return step;
        }
        if (in.pos > 0 || out.pos > 0) complete_ = left == 0;
        room_was_full_ = out.pos == out.size;
        units_.used(in.pos, left > block_header ? left - block_header : left, step.taken);
        step.given = out.pos;
        return step;
    }
    [[nodiscard]] bool complete() const override { return complete_ && !units_.keeps_some(); }

  private:
    static constexpr std::size_t block_header = 3;  // libzstd asks for a block and the header of the next
    std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream_;
    WholeUnits units_;
    bool complete_ = false, room_was_full_ = false;
};
#else
using ZstdUnpacker = void;
#endif

#if defined(RIPPLENOTCH_HAS_LZ4)
class Lz4Unpacker final : public Unpacker {
  public:
    Lz4Unpacker() {
        if (::LZ4F_isError(::LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)) != 0U)
            raise<DataError>("no memory to unpack lz4");
    }
    ~Lz4Unpacker() override { ::LZ4F_freeDecompressionContext(context_); }

    Step step(std::string_view packed, std::span<char> into) override {
        Step step;
        const std::string_view unit = units_.next(packed, step.taken);
        std::size_t given = into.size(), used = unit.size();
        const std::size_t left =
            ::LZ4F_decompress(context_, into.data(), &given, unit.data(), &used, nullptr);
        if (::LZ4F_isError(left) != 0U) {
            step.damage = fmt::format("the lz4 data are damaged ({})", ::LZ4F_getErrorName(left));
            return step;
        }
        if (used > 0 || given > 0) complete_ = left == 0;
        units_.used(used, left > block_ends ? left - block_ends : std::min(left, block_header), step.taken);
        step.given = given;
        return step;
    }
    [[nodiscard]] bool complete() const override { return complete_ && !units_.keeps_some(); }

  private:
    // liblz4 asks for a block, its checksum and the header of the next.
    static constexpr std::size_t block_header = 4, block_ends = 8;
    LZ4F_dctx* context_ = nullptr;
    WholeUnits units_;
    bool complete_ = false;
};
#else
using Lz4Unpacker = void;
#endif

/// `library`: the one behind `OneUnpacker`, which is void where this build lacks it.
template <class OneUnpacker>
constexpr Packing packing(std::string_view name, std::string_view magic, std::string_view program,
                          std::string_view library) {
    if constexpr (std::is_void_v<OneUnpacker>)
        return {name, magic, program, library, nullptr};
    else
        return {name, magic, program, {}, []() -> std::unique_ptr<Unpacker> {
                    return std::make_unique<OneUnpacker>();
                }};
}

}  // namespace

constexpr Packing packings::gzip = packing<GzipUnpacker>("gzip", "\x1f\x8b\x08", "zcat", "zlib");
constexpr Packing packings::zstd = packing<ZstdUnpacker>("zstd", "\x28\xb5\x2f\xfd", "zstdcat", "libzstd");
constexpr Packing packings::lz4 = packing<Lz4Unpacker>("lz4", "\x04\x22\x4d\x18", "lz4cat", "liblz4");

#if defined(RIPPLENOTCH_HAS_ZLIB)
std::unique_ptr<Unpacker> make_inflater(Deflate kind, const std::string& /*source*/) {
    return std::make_unique<GzipUnpacker>(kind == Deflate::wrapped ? MAX_WBITS : -MAX_WBITS, "packed");
}

std::optional<std::uint32_t> crc32_of(std::string_view bytes, std::uint32_t before) {
    return static_cast<std::uint32_t>(
        ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}
#else
std::unique_ptr<Unpacker> make_inflater(Deflate /*kind*/, const std::string& source) {
    raise<UsageError>(
        "{}: what is in there is packed, and this build was made without zlib; install it and build again",
        source);
}

std::optional<std::uint32_t> crc32_of(std::string_view /*bytes*/, std::uint32_t /*before*/) {
    return std::nullopt;
}
#endif

}  // namespace ripplenotch
