// SPDX-License-Identifier: MIT
#include "log/npy/npy_field.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "log/clock/stamp.hpp"
#include "ripplenotch/core/reading.hpp"

namespace ripplenotch {
namespace {

template <class Word>
Word load_word(const char* bytes, bool big_endian) {
    std::array<unsigned char, sizeof(Word)> raw{};
    std::memcpy(raw.data(), bytes, sizeof(Word));
    if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Word>(raw);
}

template <class Word>
void store_word(char* bytes, bool big_endian, Word value) {
    auto raw = std::bit_cast<std::array<unsigned char, sizeof(Word)>>(value);
    if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
    std::memcpy(bytes, raw.data(), sizeof(Word));
}

constexpr bool is_native(const NpyField& field) {
    return field.big_endian == (std::endian::native == std::endian::big);
}

/// Words in the processor's own order, which is nearly all there are.
template <class Word>
bool load_native(const char* at, std::size_t record_size, std::span<double> into) {
    bool finite = true;
    for (double& value : into) {
        Word word;
        std::memcpy(&word, at, sizeof(Word));
        at += record_size;
        value = static_cast<double>(word);
        finite &= is_reading(value);
    }
    return finite;
}

}  // namespace

namespace {

double load_unscaled(const char* record, const NpyField& field) {
    const char* const at = record + field.offset;
    const bool big = field.big_endian;
    switch (field.kind) {
        case 'f':
            return field.size == 4 ? static_cast<double>(load_word<float>(at, big))
                                   : load_word<double>(at, big);
        case 'i':
            switch (field.size) {
                case 1:
                    return load_word<std::int8_t>(at, big);
                case 2:
                    return load_word<std::int16_t>(at, big);
                case 4:
                    return load_word<std::int32_t>(at, big);
                default:
                    return static_cast<double>(load_word<std::int64_t>(at, big));
            }
        case 'u':
            switch (field.size) {
                case 1:
                    return load_word<std::uint8_t>(at, big);
                case 2:
                    return load_word<std::uint16_t>(at, big);
                case 4:
                    return load_word<std::uint32_t>(at, big);
                default:
                    return static_cast<double>(load_word<std::uint64_t>(at, big));
            }
        default:
            return 0.0;
    }
}

}  // namespace

double load_field(const char* record, const NpyField& field) {
    const double number = load_unscaled(record, field);
    return field.scaled() ? number * field.scale + field.shift : number;
}

std::int64_t load_count(const char* record, const NpyField& field) {
    if ((field.kind == 'i' || field.kind == 'u') && field.size == 8 && !field.scaled())
        return load_word<std::int64_t>(record + field.offset, field.big_endian);
    const double value = load_field(record, field);
    return std::abs(value) < 9e18 ? static_cast<std::int64_t>(value) : 0;
}

double load_since(const char* record, const NpyField& field, std::int64_t origin) {
    if (field.kind == 'f' || field.scaled()) return load_field(record, field) - static_cast<double>(origin);
    return since(load_count(record, field), origin);
}

void store_float(char* record, const NpyField& field, double value) {
    if (field.size == 4) {
        store_word(record + field.offset, field.big_endian, static_cast<float>(value));
    } else {
        store_word(record + field.offset, field.big_endian, value);
    }
}

bool load_column(const char* records, std::size_t record_size, const NpyField& field,
                 std::span<double> into) {
    if (field.kind == 'f' && is_native(field) && !field.scaled()) {
        const char* const first = records + field.offset;
        return field.size == 4 ? load_native<float>(first, record_size, into)
                               : load_native<double>(first, record_size, into);
    }
    bool finite = true;
    for (double& value : into) {
        value = load_field(records, field);
        finite &= is_reading(value);
        records += record_size;
    }
    return finite;
}

void store_column(char* records, std::size_t record_size, const NpyField& field, const StoredColumn& column) {
    const auto [values, as_written, factor] = column;
    // What most logs are, without a question for each value.
    const bool plain = field.size == 8 && is_native(field) && factor == 1.0;
    for (std::size_t i = 0; i < values.size(); ++i, records += record_size) {
        if (!as_written.empty() && values[i] == as_written[i]) continue;
        if (plain)
            std::memcpy(records + field.offset, &values[i], sizeof(double));
        else
            store_float(records, field, values[i] / factor);
    }
}

}  // namespace ripplenotch
