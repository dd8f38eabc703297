// SPDX-License-Identifier: MIT
// zstd (RFC 8878), by libzstd.

#include "log/unpack/unpacker.hpp"
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
        ZSTD_inBuffer in{packed.data(), packed.size(), 0};
        ZSTD_outBuffer out{into.data(), into.size(), 0};
        const std::size_t left = ::ZSTD_decompressStream(stream_.get(), &out, &in);
        if (::ZSTD_isError(left) != 0)
            raise<DataError>("the zstd data are damaged ({})", ::ZSTD_getErrorName(left));
        if (in.pos > 0 || out.pos > 0) complete_ = left == 0;
        return {in.pos, out.pos};
    }
    [[nodiscard]] bool complete() const override { return complete_; }

  private:
    std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream_;
    bool complete_ = false;
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
