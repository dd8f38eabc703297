// SPDX-License-Identifier: MIT
// xz, by liblzma.

#include <fmt/format.h>

#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/error.hpp"

#if defined(RIPPLENOTCH_HAS_LZMA)
#include <lzma.h>

namespace ripplenotch {
namespace {

constexpr std::uint64_t most_memory = std::uint64_t{128} << 20;  // xz -9 needs 65 MiB

const char* reason_of(lzma_ret result) {
    switch (result) {
        case LZMA_MEMLIMIT_ERROR:
            return "it asks for more than 128 MiB of memory";
        case LZMA_FORMAT_ERROR:
            return "what follows is no xz";
        case LZMA_OPTIONS_ERROR:
            return "it is packed in a way that liblzma does not know";
        case LZMA_DATA_ERROR:
            return "a checksum or a code does not fit";
        default:
            return "unknown reason";
    }
}

class XzUnpacker final : public Unpacker {
  public:
    XzUnpacker() {
        if (::lzma_stream_decoder(&stream_, most_memory, LZMA_CONCATENATED) != LZMA_OK)
            raise<DataError>("no memory to unpack xz");
    }
    ~XzUnpacker() override { ::lzma_end(&stream_); }
    XzUnpacker(const XzUnpacker&) = delete;
    XzUnpacker& operator=(const XzUnpacker&) = delete;

    Step step(std::string_view packed, std::span<char> into) override {
        stream_.next_in = reinterpret_cast<const std::uint8_t*>(packed.data());
        stream_.avail_in = packed.size();
        stream_.next_out = reinterpret_cast<std::uint8_t*>(into.data());
        stream_.avail_out = into.size();
        // Streams may follow each other: only an empty piece says that all have come.
        const lzma_ret result = ::lzma_code(&stream_, packed.empty() ? LZMA_FINISH : LZMA_RUN);
        complete_ = result == LZMA_STREAM_END;
        Step step{packed.size() - stream_.avail_in, into.size() - stream_.avail_out, {}};
        if (result != LZMA_OK && result != LZMA_BUF_ERROR && !complete_)
            step.damage = fmt::format("the xz data are damaged ({})", reason_of(result));
        return step;
    }
    [[nodiscard]] bool complete() const override { return complete_; }

  private:
    lzma_stream stream_ = LZMA_STREAM_INIT;
    bool complete_ = false;
};

constexpr std::string_view xz_magic(
    "\xfd"
    "7zXZ\0",
    6);

}  // namespace

const Packing packings::xz{"xz", xz_magic, "xzcat", {}, []() -> std::unique_ptr<Unpacker> {
                               return std::make_unique<XzUnpacker>();
                           }};

}  // namespace ripplenotch
#else
namespace ripplenotch {
const Packing packings::xz{"xz",
                           {"\xfd"
                            "7zXZ\0",
                            6},
                           "xzcat",
                           "liblzma",
                           nullptr};
}
#endif
