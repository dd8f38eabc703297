// SPDX-License-Identifier: MIT
// lz4 frames, by liblz4.

#include <fmt/format.h>

#include <algorithm>

#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/error.hpp"

#if defined(RIPPLENOTCH_HAS_LZ4)
#include <lz4frame.h>

namespace ripplenotch {
namespace {

class Lz4Unpacker final : public Unpacker {
  public:
    Lz4Unpacker() {
        if (::LZ4F_isError(::LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)) != 0U)
            raise<DataError>("no memory to unpack lz4");
    }
    ~Lz4Unpacker() override { ::LZ4F_freeDecompressionContext(context_); }
    Lz4Unpacker(const Lz4Unpacker&) = delete;
    Lz4Unpacker& operator=(const Lz4Unpacker&) = delete;

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

}  // namespace

const Packing packings::lz4{"lz4", "\x04\x22\x4d\x18", "lz4cat", {}, []() -> std::unique_ptr<Unpacker> {
                                return std::make_unique<Lz4Unpacker>();
                            }};

}  // namespace ripplenotch
#else
namespace ripplenotch {
const Packing packings::lz4{"lz4", "\x04\x22\x4d\x18", "lz4cat", "liblz4", nullptr};
}
#endif
