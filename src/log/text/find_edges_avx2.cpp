// SPDX-License-Identifier: MIT
#include "log/text/row_edges.hpp"
#include "log/text/x86_vectors.hpp"

#if defined(RIPPLENOTCH_X86_VECTORS)
#include <bit>

namespace ripplenotch {
namespace {

/// One bit for each byte.
struct EdgeBits {
    std::uint64_t any, line_ends;
};

class EdgeFinder {
  public:
    WITH_AVX2 explicit EdgeFinder(Separators separators)
        : delimiters_(_mm256_set1_epi8(separators.delimiter)),
          line_ends_(_mm256_set1_epi8(separators.line_end)) {}

    /// Of 64 bytes.
    WITH_AVX2 EdgeBits look_at(const char* text) {
        const EdgeBits low = look_at_half(text), high = look_at_half(text + 32);
        return {low.any | high.any << 32, low.line_ends | high.line_ends << 32};
    }
    [[nodiscard]] WITH_AVX2 bool quotes() const { return _mm256_testz_si256(quotes_, quotes_) == 0; }
    [[nodiscard]] WITH_AVX2 bool returns() const { return _mm256_testz_si256(returns_, returns_) == 0; }

  private:
    WITH_AVX2 EdgeBits look_at_half(const char* text) {
        const __m256i bytes = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(text));
        const __m256i quote = _mm256_cmpeq_epi8(bytes, _mm256_set1_epi8('"'));
        const __m256i line_end = _mm256_cmpeq_epi8(bytes, line_ends_);
        const __m256i delimiter = _mm256_cmpeq_epi8(bytes, delimiters_);
        quotes_ = _mm256_or_si256(quotes_, quote);
        returns_ = _mm256_or_si256(returns_, _mm256_cmpeq_epi8(bytes, _mm256_set1_epi8('\r')));
        const __m256i any = _mm256_or_si256(quote, _mm256_or_si256(delimiter, line_end));
        return {static_cast<std::uint32_t>(_mm256_movemask_epi8(any)),
                static_cast<std::uint32_t>(_mm256_movemask_epi8(line_end))};
    }

    __m256i delimiters_, line_ends_, quotes_ = _mm256_setzero_si256(), returns_ = _mm256_setzero_si256();
};

}  // namespace

WITH_AVX2 void find_edges_avx2(const char* text, std::size_t size, Separators separators, Edges& found) {
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
    find_last_edges(text, at, size, separators, found);
}

}  // namespace ripplenotch
#endif
