// SPDX-License-Identifier: MIT
#include "core/vectors/bytes.hpp"
#include "log/text/row_edges.hpp"

#if defined(RIPPLENOTCH_BYTE_VECTORS)

namespace ripplenotch {
namespace {

/// One bit for each byte.
struct EdgeBits {
    std::uint64_t any, line_ends;
};

class EdgeFinder {
  public:
    RIPPLENOTCH_WIDE explicit EdgeFinder(Separators separators)
        : delimiters_(all(byte(separators.delimiter))), line_ends_(all(byte(separators.line_end))) {}

    /// Of 64 bytes.
    RIPPLENOTCH_WIDE EdgeBits look_at(const char* text) {
        const EdgeBits low = look_at_half(text), high = look_at_half(text + 32);
        return {low.any | high.any << 32, low.line_ends | high.line_ends << 32};
    }
    [[nodiscard]] RIPPLENOTCH_WIDE bool quotes() const { return bits_of(quotes_) != 0; }
    [[nodiscard]] RIPPLENOTCH_WIDE bool controls() const { return bits_of(controls_) != 0; }
    [[nodiscard]] RIPPLENOTCH_WIDE bool returns() const { return bits_of(returns_) != 0; }

  private:
    static std::uint8_t byte(char character) { return static_cast<std::uint8_t>(character); }

    RIPPLENOTCH_WIDE EdgeBits look_at_half(const char* text) {
        const Bytes bytes = load_bytes(text);
        const Bytes quote = as<std::uint8_t>(bytes == all(byte('"')));
        const Bytes line_end = as<std::uint8_t>(bytes == line_ends_);
        const Bytes delimiter = as<std::uint8_t>(bytes == delimiters_);
        const Bytes carriage_return = as<std::uint8_t>(bytes == all(byte('\r')));
        quotes_ |= quote;
        returns_ |= carriage_return;
        controls_ |= as<std::uint8_t>(bytes < all(byte(' '))) & ~(line_end | delimiter | carriage_return);
        return {bits_of(quote | delimiter | line_end), bits_of(line_end)};
    }

    Bytes delimiters_, line_ends_, quotes_{}, returns_{}, controls_{};
};

}  // namespace

RIPPLENOTCH_WIDE void find_edges(const char* text, std::size_t size, Separators separators, Edges& found) {
    EdgeFinder finder(separators);
    found.place[0] = -1;
    std::int32_t* const first = found.place.data() + 1;
    std::int32_t* into = first;
    std::size_t at = 0;
    int line_ends = 0;
    for (; at + 64 <= size; at += 64) {
        auto [bits, ends] = finder.look_at(text + at);
        line_ends += std::popcount(ends);
        const int count = std::popcount(bits);
        // Eight places without a branch, most often all there are.
        for (int i = 0; i < 8; ++i, bits &= bits - 1)
            into[i] = static_cast<std::int32_t>(at) + std::countr_zero(bits);
        for (int i = 8; i < count; ++i, bits &= bits - 1)
            into[i] = static_cast<std::int32_t>(at) + std::countr_zero(bits);
        into += count;
    }
    found.count = static_cast<std::size_t>(into - first);
    found.line_ends = static_cast<std::size_t>(line_ends);
    found.quotes = finder.quotes();
    found.returns = finder.returns();
    found.controls = finder.controls();
    find_last_edges(text, at, size, separators, found);
}

}  // namespace ripplenotch
#endif
