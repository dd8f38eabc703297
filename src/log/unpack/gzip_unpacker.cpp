// SPDX-License-Identifier: MIT
// gzip (RFC 1952), by zlib.

#include <fmt/format.h>

#include <algorithm>

#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/error.hpp"

#if defined(RIPPLENOTCH_HAS_ZLIB)
#include <zlib.h>

namespace ripplenotch {
namespace {

class GzipUnpacker final : public Unpacker {
  public:
    /// `window_bits` as zlib has them: they say the wrapping, too.
    explicit GzipUnpacker(int window_bits = 16 + MAX_WBITS, std::string_view kind = "gzip") : kind_(kind) {
        if (::inflateInit2(&stream_, window_bits) != Z_OK) raise<DataError>("no memory to unpack gzip");
    }
    ~GzipUnpacker() override { ::inflateEnd(&stream_); }
    GzipUnpacker(const GzipUnpacker&) = delete;
    GzipUnpacker& operator=(const GzipUnpacker&) = delete;

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

}  // namespace

std::unique_ptr<Unpacker> make_inflater(Deflate kind, const std::string& /*source*/) {
    return std::make_unique<GzipUnpacker>(kind == Deflate::wrapped ? MAX_WBITS : -MAX_WBITS, "packed");
}

std::optional<std::uint32_t> crc32_of(std::string_view bytes, std::uint32_t before) {
    return static_cast<std::uint32_t>(
        ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

const Packing packings::gzip{"gzip", "\x1f\x8b\x08", "zcat", {}, []() -> std::unique_ptr<Unpacker> {
                                 return std::make_unique<GzipUnpacker>();
                             }};

}  // namespace ripplenotch
#else
namespace ripplenotch {

std::unique_ptr<Unpacker> make_inflater(Deflate /*kind*/, const std::string& source) {
    raise<UsageError>(
        "{}: what is in there is packed, and this build was made without zlib; install it and build again",
        source);
}

std::optional<std::uint32_t> crc32_of(std::string_view /*bytes*/, std::uint32_t /*before*/) {
    return std::nullopt;
}

const Packing packings::gzip{"gzip", "\x1f\x8b\x08", "zcat", "zlib", nullptr};
}  // namespace ripplenotch
#endif
