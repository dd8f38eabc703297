// SPDX-License-Identifier: MIT
// zstd (RFC 8878), by libzstd.

#include <fmt/format.h>

#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/error.hpp"

#if defined(RIPPLENOTCH_HAS_ZSTD)
#include <zstd.h>

namespace ripplenotch {
namespace {

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

}  // namespace

const Packing packings::zstd{"zstd", "\x28\xb5\x2f\xfd", "zstdcat", {}, []() -> std::unique_ptr<Unpacker> {
                                 return std::make_unique<ZstdUnpacker>();
                             }};

}  // namespace ripplenotch
#else
namespace ripplenotch {
const Packing packings::zstd{"zstd", "\x28\xb5\x2f\xfd", "zstdcat", "libzstd", nullptr};
}
#endif
