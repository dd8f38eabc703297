// SPDX-License-Identifier: MIT
#include "log/text/row_edges.hpp"

#include "core/vectors/bytes.hpp"

#if defined(RIPPLENOTCH_BYTE_VECTORS)

#include <cstring>

#include "log/text/text_cells.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

/// How many rows from the first on end where they should.
std::size_t ended_rows(const char* text, const Edges& edges, std::size_t columns) {
    const std::size_t most = edges.count / columns;
    const std::int32_t* edge = edges.place.data() + columns;
    for (std::size_t row = 0; row < most; ++row, edge += columns) {
        if (text[*edge] != '\n') return row;
    }
    return most;
}

// Adds the bytes from `at` on, one by one, behind those that the vectors have looked at.
void find_last_edges(const char* text, std::size_t at, std::size_t size, char delimiter, Edges& found) {
    for (; at < size; ++at) {
        const bool quote = text[at] == '"', line_end = text[at] == '\n';
        if (quote || line_end || text[at] == delimiter)
            found.place[++found.count] = static_cast<std::int32_t>(at);
        found.quotes |= quote;
        found.returns |= text[at] == '\r';
        found.controls |= is_control(text[at]);
        found.line_ends += line_end ? 1 : 0;
    }
}

/// One bit for each byte.
struct EdgeBits {
    std::uint64_t any, line_ends;
};

class EdgeFinder {
  public:
    RIPPLENOTCH_WIDE explicit EdgeFinder(char delimiter) : delimiters_(all(byte(delimiter))) {}

    /// The separators among 64 bytes, a bit each.
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
        const Bytes line_end = as<std::uint8_t>(bytes == all(byte('\n')));
        const Bytes delimiter = as<std::uint8_t>(bytes == delimiters_);
        const Bytes carriage_return = as<std::uint8_t>(bytes == all(byte('\r')));
        quotes_ |= quote;
        returns_ |= carriage_return;
        controls_ |= as<std::uint8_t>(bytes < all(byte(' '))) & ~(line_end | delimiter | carriage_return);
        return {bits_of(quote | delimiter | line_end), bits_of(line_end)};
    }

    Bytes delimiters_, quotes_{}, returns_{}, controls_{};
};

constexpr std::uint64_t most_lane_digits = 10000000000000000U;  // 1e16

/// On its way down a column.
struct CellCursor {
    CellCursor(const CellColumn& column, std::size_t row)
        : text(column.text),
          before(column.before + row * column.before_stride),
          end(column.end + row * column.end_stride),
          before_stride(column.before_stride),
          end_stride(column.end_stride) {}

    void advance(std::size_t rows) {
        before += rows * before_stride;
        end += rows * end_stride;
    }
    /// How many characters the cell has, with its sign.
    [[nodiscard]] std::size_t length() const { return static_cast<std::size_t>(*end - *before - 1); }

    const char* text;
    const std::int32_t *before, *end;
    std::size_t before_stride, end_stride;
};

// Two cells at a time, each from one load that ends where the cell ends: no step waits for the length of the
// number before it.

using TwoNumbers = HalfRegister<std::uint64_t>;

constexpr std::uint8_t zero_byte = '0';
constexpr std::uint64_t two_to_52_bits = 0x4330000000000000;  // of a double

/// Where the marks of two numbers are.
struct Places {
    Bytes offset, most, spare, close;
    Two powers;
};

RIPPLENOTCH_WIDE inline Places places_of(std::size_t low, std::size_t high, char decimal_mark) {
    Places places;
    const Bytes apart = load_halves(cell_masks.apart[low].data(), cell_masks.apart[high].data());
    places.spare = load_halves(cell_masks.spare[low].data(), cell_masks.spare[high].data());
    places.most = load_halves(cell_masks.most[low].data(), cell_masks.most[high].data());
    places.close = load_halves(cell_masks.close[low].data(), cell_masks.close[high].data());
    places.offset = choose(apart, all(zero_byte), all(static_cast<std::uint8_t>(decimal_mark)));
    places.powers = Two{cell_masks.power[low], cell_masks.power[high]};
    return places;
}

/// The cells of two rows, and which of their bytes belong to the numbers.
struct Pair {
    Bytes text, keep;
    std::size_t low_minus, high_minus;
};

/// False where one of two numbers is empty or longer than a lane.
template <bool plain>
RIPPLENOTCH_WIDE inline bool load_pair(const CellCursor& at, Pair& pair) {
    const std::int32_t* const end = plain ? at.before + 1 : at.end;
    const std::size_t end_stride = plain ? at.before_stride : at.end_stride;
    const std::int64_t low_before = at.before[0], high_before = at.before[at.before_stride];
    const std::int64_t low_end = end[0], high_end = end[end_stride];
    pair.low_minus = at.text[low_before + 1] == '-' ? 1 : 0;
    pair.high_minus = at.text[high_before + 1] == '-' ? 1 : 0;
    // With the separator before it.
    const auto low = static_cast<std::size_t>(low_end - low_before) - pair.low_minus;
    const auto high = static_cast<std::size_t>(high_end - high_before) - pair.high_minus;
    if (!plain && ((low - 2) | (high - 2)) >= lane_bytes) return false;
    pair.keep = load_halves(cell_masks.keep[low - 1].data(), cell_masks.keep[high - 1].data());
    pair.text = load_halves(at.text + low_end - lane_bytes, at.text + high_end - lane_bytes);
    return true;
}

/// True where every byte that belongs to a number is a digit, or the mark in its place, and it has what it
/// needs. Leaves the values of the digits.
RIPPLENOTCH_WIDE inline bool all_known(const Pair& pair, const Places& places, Bytes& values) {
    const Bytes rest = pair.text - places.offset;
    const Bytes known = as<std::uint8_t>(rest <= places.most);
    values = rest & pair.keep;
    return every(choose(pair.keep, known, places.spare));
}

/// Most columns have the decimal mark in the same place, counted from the end, all the way down: pairs of
/// rows are read as long as it is there.
class Pairs {
  public:
    explicit Pairs(char decimal_mark)
        : decimal_mark_(decimal_mark), places_(places_of(lane_bytes, lane_bytes, decimal_mark)) {}

    /// For the marks of two rows; false where these cannot be read: junk, more than one mark, long numbers,
    /// or nothing behind a mark, which could stand alone in the next cell.
    RIPPLENOTCH_WIDE bool find_places(const CellColumn& column, std::size_t row) {
        Pair pair;
        if (!load_pair<false>(CellCursor(column, row), pair)) return false;
        const Bytes is_mark = as<std::uint8_t>(pair.text == all(static_cast<std::uint8_t>(decimal_mark_)));
        const std::uint32_t marks = bits_of(is_mark & pair.keep);
        const auto low = static_cast<std::size_t>(std::countr_zero((marks & 0xFFFFU) | 0x10000U));
        const auto high = static_cast<std::size_t>(std::countr_zero((marks >> 16) | 0x10000U));
        if (low == lane_bytes - 1 || high == lane_bytes - 1) return false;
        places_ = places_of(low, high, decimal_mark_);
        Bytes values;
        return all_known(pair, places_, values);
    }

    /// From `row` on; returns where the marks are elsewhere, or where it is not sure.
    std::size_t read(const CellColumn& column, std::size_t row, double* numbers) const {
        return column.plain ? read_as<true>(column, row, numbers) : read_as<false>(column, row, numbers);
    }

  private:
    // Not inlined: all that it needs of vectors stays in registers.
    template <bool plain>
    [[gnu::noinline]] RIPPLENOTCH_WIDE std::size_t read_as(const CellColumn& column, std::size_t row,
                                                           double* numbers) const {
        const Places places = places_;
        CellCursor at(column, row);
        for (const std::size_t end = column.rows; row + 1 < end; row += 2, at.advance(2)) {
            Pair pair;
            Bytes values;
            if (!load_pair<plain>(at, pair) || !all_known(pair, places, values)) break;
            const TwoNumbers both = sixteen_digits(shuffle(values, places.close));
            const Two mantissas = reinterpret_cast<Two>(both | two_to_52_bits) - 0x1p52;
            TwoNumbers signs, results = reinterpret_cast<TwoNumbers>(mantissas / places.powers);
            std::memcpy(&signs, cell_masks.signs[2 * pair.high_minus + pair.low_minus].data(), sizeof signs);
            results ^= signs;
            std::memcpy(numbers + row, &results, sizeof results);
        }
        return row;
    }

    char decimal_mark_;
    Places places_;
};

/// Reads one cell with up to 32 characters and 19 digits; false where it is not sure.
RIPPLENOTCH_WIDE bool read_long_cell(const CellCursor& at, char decimal_mark, double& value) {
    const char* const begin = at.text + at.before[0] + 1;
    const char* const end = at.text + at.end[0];
    const bool negative = *begin == '-';
    const std::size_t length = static_cast<std::size_t>(end - begin) - (negative ? 1 : 0);
    if (length - 1 >= 32) return false;
    const Bytes keep = load_bytes(cell_masks.keep_long[length].data());
    const Bytes text = load_bytes(end - 32), digits = text - all(zero_byte);
    const Bytes is_mark = as<std::uint8_t>(text == all(static_cast<std::uint8_t>(decimal_mark)));
    const Bytes is_digit = as<std::uint8_t>(digits <= all(std::uint8_t{9}));
    const std::uint32_t marks = bits_of(is_mark & keep);
    if (!every(is_digit | is_mark | ~keep)) return false;
    if ((marks & (marks - 1)) != 0 || (marks != 0 && length == 1)) return false;
    // What stands before the mark moves up by one: taken from a load one byte earlier.
    const std::size_t decimals = marks == 0 ? 0 : 31 - static_cast<std::size_t>(std::countr_zero(marks));
    const Bytes behind = load_bytes(cell_masks.keep_long[marks == 0 ? 32 : decimals].data());
    const Bytes before = load_bytes(cell_masks.keep_long[length - 1].data()) & ~behind;
    const Bytes moved = (load_bytes(end - 33) - all(zero_byte)) & before;
    const TwoNumbers both = sixteen_digits((digits & keep & behind) | moved);
    const std::uint64_t high = both[0], low = both[1];
    if (high > 999) return false;  // more than 19 digits may not fit
    const auto magnitude = decimal_number(high * most_lane_digits + low, -static_cast<int>(decimals));
    if (!magnitude) return false;
    value = negative ? -*magnitude : *magnitude;
    return true;
}

}  // namespace

std::int32_t longest_cell(const std::int32_t* place, std::size_t count) {
    std::int32_t longest = 0;
    for (std::size_t i = 0; i < count; ++i) longest = std::max(longest, place[i + 1] - place[i] - 1);
    return longest;
}

std::size_t regular_rows(const char* text, const Edges& edges, char delimiter, std::size_t columns) {
    const std::size_t ended = ended_rows(text, edges, columns);
    // Then there is no line end but the last of each row.
    if (!edges.quotes && !edges.controls && ended == edges.line_ends) return ended;
    const std::int32_t* edge = edges.place.data() + 1;
    for (std::size_t row = 0; row < ended; ++row, edge += columns) {
        for (std::size_t c = 0; c + 1 < columns; ++c) {
            if (text[edge[c]] != delimiter) return row;
        }
        if (edges.controls && std::any_of(text + edge[-1] + 1, text + edge[columns - 1], is_control))
            return row;
    }
    return ended;
}

RIPPLENOTCH_WIDE void find_edges(const char* text, std::size_t size, char delimiter, Edges& found) {
    EdgeFinder finder(delimiter);
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
    find_last_edges(text, at, size, delimiter, found);
}

bool read_cells(const CellColumn& column, double* numbers, std::uint8_t* odd) {
    Pairs pairs(column.decimal_mark);
    bool any_odd = false;
    std::size_t row = 0;
    while (row < column.rows) {
        row = pairs.read(column, row, numbers);
        if (row + 1 < column.rows && pairs.find_places(column, row)) continue;
        // Numbers that are too long for pairs seldom come alone.
        CellCursor at(column, row);
        for (int alone = 0; row < column.rows && (alone < 2 || at.length() > lane_bytes); ++alone) {
            if (!read_long_cell(at, column.decimal_mark, numbers[row])) {
                odd[row] = 1;
                any_odd = true;
            }
            ++row;
            at.advance(1);
        }
    }
    return any_odd;
}

}  // namespace ripplenotch
#endif
