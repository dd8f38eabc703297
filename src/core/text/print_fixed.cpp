// SPDX-License-Identifier: MIT
// Four numbers at a time: scaled and rounded to whole numbers, these split into digits by multiplications,
// all of them in place before and behind the mark, and what comes before the first digit made minus signs:
// the text begins at the last of these, or behind it.

#include "core/text/print_fixed.hpp"

#include <algorithm>

#include "core/functions/powers_of_ten.hpp"
#include "core/vectors/bytes.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

constexpr int most_decimals_side_by_side = 13;

}  // namespace

#if defined(RIPPLENOTCH_BYTE_VECTORS)

namespace {

constexpr double two_to_52 = 4503599627370496.0;
constexpr double most_short = 99999999.0, most_long = 99999999999999.0;  // eight digits, fourteen

using Half = std::array<std::uint8_t, 16>;

/// Where the bytes of a slot come from: the last eight digits, those before them, and what is no digit.
struct Places {
    Half low{}, high{};
    Half beside_low{}, beside_both{};  ///< the mark, and what a sign may overwrite nothing of
    Half low_stop{}, high_stop{};      ///< a one at the digit before the mark, which is always there
    constexpr Places() = default;
    explicit constexpr Places(int decimals) {
        for (int from_right = 0; from_right < 16; ++from_right) {
            const auto at = static_cast<std::size_t>(15 - from_right);
            const bool mark = decimals > 0 && from_right == decimals;
            const int digit = from_right - (decimals > 0 && from_right > decimals ? 1 : 0);
            low[at] = byte(!mark && digit < 8 ? 7 - digit : nothing);
            high[at] = byte(!mark && digit >= 8 && digit < most_digits ? 15 - digit : nothing);
            beside_low[at] = byte(mark ? '.' : digit >= 8 ? '-' : 0);
            beside_both[at] = byte(mark ? '.' : digit >= most_digits ? '-' : 0);
        }
        Half& stop = decimals < 8 ? low_stop : high_stop;
        const auto before_mark = static_cast<std::size_t>(7 - decimals % 8);
        stop[before_mark] = stop[before_mark + 8] = 1;
    }

  private:
    static constexpr int nothing = 0x80, most_digits = 14;  // a shuffle by 0x80 gives a zero
    static constexpr std::uint8_t byte(int value) { return static_cast<std::uint8_t>(value); }
};

constexpr auto places = [] {
    std::array<Places, most_decimals_side_by_side + 1> all;
    for (int decimals = 0; decimals <= most_decimals_side_by_side; ++decimals)
        all[static_cast<std::size_t>(decimals)] = Places(decimals);
    return all;
}();

RIPPLENOTCH_INLINED_WIDE Bytes twice(const Half& bytes) { return load_halves(bytes.data(), bytes.data()); }

/// Splits numbers into digits.
class Splitter {
  public:
    RIPPLENOTCH_WIDE Splitter()
        : over_10000_(opaque(std::uint64_t{3518437209})),
          by_10000_(opaque(std::uint64_t{10000})),
          over_100_(opaque(std::uint16_t{10486})),
          by_100_(opaque(std::uint16_t{100})),
          over_10_(opaque(std::uint16_t{6554})),
          by_10_shifted_less_1_(opaque(std::uint16_t{10 * 256 - 1})) {}

    /// Eight digits, the first in the lowest byte, of the number below 1e8 in the lower half of each lane:
    /// fours, pairs and single digits, each time quotients before remainders.
    RIPPLENOTCH_INLINED_WIDE Bytes eight_digits(const Quadwords& numbers) const {
        const Quadwords high = low_products(numbers, over_10000_) >> 45;
        const Quadwords low = numbers - low_products(high, by_10000_);
        const Words fours = as<std::uint16_t>(high | low << 32);
        const Words highs = high_products(fours, over_100_) >> 4;
        const Words lows = fours - highs * by_100_;
        const Words pairs = highs | as<std::uint16_t>(as<std::uint32_t>(lows) << 16);
        const Words tens = high_products(pairs, over_10_);
        // tens + ((pairs - 10 * tens) << 8)
        return as<std::uint8_t>((pairs << 8) - tens * by_10_shifted_less_1_);
    }

  private:
    Quadwords over_10000_, by_10000_;
    Words over_100_, by_100_, over_10_, by_10_shifted_less_1_;
};

/// All ones in the bytes before the first digit that is not zero, or that is at a stop.
RIPPLENOTCH_INLINED_WIDE Bytes leading_zeros(const Bytes& digits, const Bytes& stop) {
    const Quadwords seen = as<std::uint64_t>(as<signed char>(digits | stop) > all<signed char>(0));
    return as<std::uint8_t>((seen + ~std::uint64_t{0}) & ~seen);
}

RIPPLENOTCH_INLINED_WIDE Quadwords count_bytes(const Bytes& all_ones_or_none) {
    return byte_sums(Bytes{} - all_ones_or_none);
}

/// From the characters of four numbers, in lanes, to slots: even ones, odd ones.
struct SlotPairs {
    Bytes even, odd;
};

RIPPLENOTCH_INLINED_WIDE SlotPairs in_place(const Bytes& text, const Bytes& from) {
    return {shuffle(text, from), shuffle(text, from + std::uint8_t{8})};
}

class Printer {
  public:
    RIPPLENOTCH_WIDE Printer(int decimals, char decimal_mark)
        : scale_(all(powers_of_ten[static_cast<std::size_t>(decimals)])),
          short_below_(opaque(decimals < 8 ? most_short : -1.0)),
          bytes_but_leading_(all(std::uint64_t{decimals > 0 ? 9U : 8U})) {
        const Places& from = places[static_cast<std::size_t>(decimals)];
        low_ = twice(from.low);
        high_ = twice(from.high);
        low_stop_ = twice(from.low_stop);
        high_stop_ = twice(from.high_stop);
        beside_low_ = with_mark(twice(from.beside_low), decimal_mark);
        beside_both_ = with_mark(twice(from.beside_both), decimal_mark);
    }

    /// Four values.
    RIPPLENOTCH_INLINED_WIDE void print(const double* values, char* slots, std::uint64_t* lengths) const {
        Doubles value, magnitude;
        load(value, values);
        magnitude = value;
        drop_signs(magnitude);
        const Doubles product = magnitude * scale_;
        const Doubles raised = product + raise_;  // which rounds
        const Doubles whole = raised - raise_;
        Doubles off = product - whole;
        drop_signs(off);
        // The product is off by at most half a unit in its last place, 1.2e-16 of itself.
        const Quadwords no_tie = as<std::uint64_t>(half_ - off > product * doubt_);
        const Quadwords fits = as<std::uint64_t>(product < most_long_);
        const Quadwords length = every(product < short_below_) ? print_short(as<std::uint64_t>(raised), slots)
                                                               : print_long(whole, slots);
        store_bytes(lengths, as<std::uint8_t>((length + (as<std::uint64_t>(value) >> 63)) & no_tie & fits));
    }

  private:
    RIPPLENOTCH_INLINED_WIDE static Bytes with_mark(const Bytes& bytes, char mark) {
        const Bytes at = as<std::uint8_t>(bytes == all(std::uint8_t{'.'}));
        return choose(at, all(static_cast<std::uint8_t>(mark)), bytes);
    }

    RIPPLENOTCH_INLINED_WIDE Bytes characters(const Bytes& digits, const Bytes& leading) const {
        static_assert('0' - '-' == 3);
        return digits + zeros_ - (leading & threes_);
    }

    RIPPLENOTCH_INLINED_WIDE static void put(const SlotPairs& pairs, const Bytes& beside, char* slots) {
        const Bytes even = pairs.even | beside, odd = pairs.odd | beside;
        store_bytes(slots, low_halves(even, odd));
        store_bytes(slots + sizeof(Bytes), high_halves(even, odd));
    }

    /// Below 1e8, in the lower halves; returns lengths without a sign.
    RIPPLENOTCH_INLINED_WIDE Quadwords print_short(const Quadwords& numbers, char* slots) const {
        const Bytes digits = split_.eight_digits(numbers);
        const Bytes leading = leading_zeros(digits, low_stop_);
        put(in_place(characters(digits, leading), low_), beside_low_, slots);
        return bytes_but_leading_ - count_bytes(leading);
    }

    /// Below 1e14.
    RIPPLENOTCH_INLINED_WIDE Quadwords print_long(const Doubles& whole, char* slots) const {
        // Half of the last digit more, so that the quotient of a multiple of 1e8 is not rounded below it.
        const Doubles quotient = floors((whole + 0.5) * 1e-8);
        const Doubles rest = whole - quotient * 1e8;
        const Bytes high = split_.eight_digits(as<std::uint64_t>(quotient + raise_));
        const Bytes low = split_.eight_digits(as<std::uint64_t>(rest + raise_));
        const Bytes high_leading = leading_zeros(high, high_stop_);
        const Bytes none_high = as<std::uint8_t>(as<std::uint64_t>(high_leading) == all(~std::uint64_t{0}));
        const Bytes low_leading = leading_zeros(low, low_stop_) & none_high;
        const SlotPairs before = in_place(characters(high, high_leading), high_);
        const SlotPairs last = in_place(characters(low, low_leading), low_);
        put({before.even | last.even, before.odd | last.odd}, beside_both_, slots);
        return bytes_but_leading_ + std::uint64_t{8} - count_bytes(high_leading) - count_bytes(low_leading);
    }

    Splitter split_;
    Doubles raise_ = opaque(two_to_52), half_ = opaque(0.5), doubt_ = opaque(4e-16),
            most_long_ = opaque(most_long);
    Doubles scale_, short_below_;
    Quadwords bytes_but_leading_;
    Bytes zeros_ = opaque(std::uint8_t{'0'}), threes_ = opaque(std::uint8_t{3});
    Bytes low_, high_, low_stop_, high_stop_, beside_low_, beside_both_;
};

}  // namespace

RIPPLENOTCH_WIDE void print_fixed(std::span<const double> values, int decimals, char decimal_mark,
                                  char* slots, std::uint64_t* lengths) {
    const Printer printer(decimals, decimal_mark);
    std::size_t i = 0;
    for (; i + 4 <= values.size(); i += 4) printer.print(values.data() + i, slots + 16 * i, lengths + i);
    if (i == values.size()) return;
    std::array<double, 4> last{};
    std::copy(values.begin() + static_cast<std::ptrdiff_t>(i), values.end(), last.begin());
    printer.print(last.data(), slots + 16 * i, lengths + i);
}

#else

void print_fixed(std::span<const double> values, int, char, char*, std::uint64_t* lengths) {
    std::fill_n(lengths, values.size(), std::uint64_t{0});
}

#endif

void FixedTexts::prepare(std::span<const double> values, double divisor, int decimals) {
    values_ = values;
    divisor_ = divisor;
    decimals_ = decimals;
    if (!wide_vectors() || decimals < 0 || decimals > most_decimals_side_by_side) {
        std::fill_n(lengths_.begin(), values.size(), 0);
        return;
    }
    std::array<double, most> quotients;
    if (divisor != 1.0) {
        std::transform(values.begin(), values.end(), quotients.begin(),
                       [divisor](double value) { return value / divisor; });
        values = {quotients.data(), values.size()};
    }
    print_fixed(values, decimals, mark_, slots_.data(), lengths_.data());
}

char* FixedTexts::put_alone(char* into, std::size_t i) const {
    char* const end = put_fixed(into, values_[i] / divisor_, decimals_);
    if (mark_ != '.') std::replace(into, end, '.', mark_);
    return end;
}

}  // namespace ripplenotch
