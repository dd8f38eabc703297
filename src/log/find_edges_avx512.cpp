// SPDX-License-Identifier: MIT
#include "log/row_edges.hpp"
#include "log/x86_vectors.hpp"

#if defined(RIPPLENOTCH_X86_VECTORS)
#include <bit>
#include <numeric>

namespace ripplenotch {
namespace {

constexpr auto from_0_to_63 = [] {
    std::array<std::uint8_t, 64> numbers{};
    std::iota(numbers.begin(), numbers.end(), std::uint8_t{0});
    return numbers;
}();

}  // namespace

WITH_AVX512 void find_edges_avx512(const char* text, std::size_t size, Separators separators, Edges& found) {
    const __m512i delimiters = _mm512_set1_epi8(separators.delimiter),
                  line_ends = _mm512_set1_epi8(separators.line_end), quotes = _mm512_set1_epi8('"'),
                  returns = _mm512_set1_epi8('\r'), numbers = _mm512_loadu_si512(from_0_to_63.data());
    found.place[0] = -1;
    std::int32_t* const first = found.place.data() + 1;
    std::int32_t* into = first;
    std::size_t at = 0;
    int lines = 0;
    std::uint64_t any_quotes = 0, any_returns = 0;
    for (; at + 64 <= size; at += 64) {
        const __m512i bytes = _mm512_loadu_si512(text + at);
        const std::uint64_t quote = _mm512_cmpeq_epi8_mask(bytes, quotes);
        const std::uint64_t line_end = _mm512_cmpeq_epi8_mask(bytes, line_ends);
        const std::uint64_t edge = quote | line_end | _mm512_cmpeq_epi8_mask(bytes, delimiters);
        any_quotes |= quote;
        any_returns |= _mm512_cmpeq_epi8_mask(bytes, returns);
        lines += std::popcount(line_end);
        const int count = std::popcount(edge);
        // The places of the set bits, and as many of them at once as there most often are.
        __m512i places = _mm512_maskz_compress_epi8(edge, numbers);
        for (int done = 0;; done += 16) {
            const __m512i wide = _mm512_cvtepu8_epi32(_mm512_castsi512_si128(places));
            _mm512_storeu_si512(into + done, _mm512_add_epi32(wide, _mm512_set1_epi32(static_cast<int>(at))));
            if (count <= done + 16) break;
            places = _mm512_alignr_epi32(places, places, 4);
        }
        into += count;
    }
    found.count = static_cast<std::size_t>(into - first);
    found.line_ends = static_cast<std::size_t>(lines);
    found.quotes = any_quotes != 0;
    found.returns = any_returns != 0;
    find_last_edges(text, at, size, separators, found);
}

}  // namespace ripplenotch
#endif
