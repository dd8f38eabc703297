// SPDX-License-Identifier: MIT
#include "log/npy/npy_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

template <class Word>
Word load_word(const char* bytes, bool big_endian) {
    std::array<unsigned char, sizeof(Word)> raw{};
    std::memcpy(raw.data(), bytes, sizeof(Word));
    if (big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
    return std::bit_cast<Word>(raw);
}

template <class Word>
void store_word(char* bytes, bool big_endian, Word value) {
    auto raw = std::bit_cast<std::array<unsigned char, sizeof(Word)>>(value);
    if (big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
    std::memcpy(bytes, raw.data(), sizeof(Word));
}

constexpr bool is_native(const NpyField& field) {
    return field.big_endian == (std::endian::native == std::endian::big);
}

/// Words in the processor's own order, which is nearly all there are.
template <class Word>
void load_native(const char* at, std::size_t record_size, std::span<double> into) {
    for (double& value : into) {
        Word word;
        std::memcpy(&word, at, sizeof(Word));
        at += record_size;
        value = static_cast<double>(word);
    }
}

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

constexpr std::uint64_t most_signals = 64, fewest_times = 32;  // of an array with one row a signal
constexpr std::size_t most_npy_fields = 100000;
constexpr std::uint64_t most_npy_rows = std::uint64_t{1} << 62;

// Reads the header's Python dictionary: strings, tuples, lists, numbers, True and False, nothing else.
class HeaderText {
  public:
    HeaderText(std::string_view text, const std::string& source) : text_(text), source_(source) {}

    NpyHeader parse() {
        expect('{');
        while (!accept('}')) {
            const std::string key = string();
            expect(':');
            skip_blanks();
            if (key == "descr") {
                const std::size_t from = at_;
                description();
                header_.descr = std::string(text_.substr(from, at_ - from));
            } else if (key == "fortran_order") {
                fortran_ = word() == "True";
            } else if (key == "shape") {
                shape();
            } else {
                fail(fmt::format("the unknown key '{}'", key));
            }
            accept(',');
        }
        settle();
        return std::move(header_);
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        raise<DataError>(
            "{}: read {} in the header of a NumPy file, expected what numpy.save writes; save the array "
            "again",
            source_, what);
    }

    void skip_blanks() {
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    }
    bool accept(char c) {
        skip_blanks();
        if (at_ >= text_.size() || text_[at_] != c) return false;
        ++at_;
        return true;
    }
    void expect(char c) {
        if (!accept(c)) fail(at_ < text_.size() ? fmt::format("'{}'", text_.substr(at_, 12)) : "an end");
    }
    std::string word() {
        skip_blanks();
        std::string found;
        while (at_ < text_.size() && std::isalnum(static_cast<unsigned char>(text_[at_])) != 0)
            found += text_[at_++];
        return found;
    }
    std::string string() {
        skip_blanks();
        if (at_ < text_.size() && text_[at_] == 'u') ++at_;  // Python 2
        if (at_ >= text_.size() || (text_[at_] != '\'' && text_[at_] != '"')) fail("no name");
        const char quote = text_[at_++];
        std::string found;
        while (at_ < text_.size() && text_[at_] != quote) {
            if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
            found += text_[at_++];
        }
        expect(quote);
        return found;
    }
    std::uint64_t number() {
        const std::string digits = word();
        std::uint64_t value = 0;
        for (const char c : digits) {
            if (c == 'L') continue;  // Python 2
            if (std::isdigit(static_cast<unsigned char>(c)) == 0 || value > most_npy_rows / 10)
                fail(fmt::format("'{}'", digits));
            value = value * 10 + static_cast<std::uint64_t>(c - '0');
        }
        if (digits.empty()) fail("no number");
        return value;
    }
    std::vector<std::uint64_t> tuple() {
        std::vector<std::uint64_t> values;
        expect('(');
        while (!accept(')')) {
            values.push_back(number());
            accept(',');
        }
        return values;
    }

    void description() {
        if (!accept('[')) {
            add_field("", string());
            return;
        }
        header_.structured = true;
        while (!accept(']')) {
            expect('(');
            std::string name;
            if (accept('(')) {  // (title, name)
                string();
                expect(',');
                name = string();
                expect(')');
            } else {
                name = string();
            }
            expect(',');
            skip_blanks();
            if (at_ < text_.size() && text_[at_] == '[') fail("a structure within a structure");
            const std::string type = string();
            std::uint64_t count = 1;
            bool array = false;
            if (accept(',') && at_ < text_.size()) {
                skip_blanks();
                if (at_ < text_.size() && text_[at_] == '(') {
                    array = true;
                    for (const std::uint64_t size : tuple())
                        count = std::min<std::uint64_t>(count * size, most_npy_fields + 1);
                }
            }
            expect(')');
            accept(',');
            if (!array) {
                add_field(name, type);
            } else {
                for (std::uint64_t i = 0; i < count; ++i) add_field(fmt::format("{}[{}]", name, i), type);
            }
        }
    }

    void add_field(const std::string& name, const std::string& type) {
        if (header_.fields.size() >= most_npy_fields) fail("too many columns");
        NpyField field;
        field.name = name;
        field.offset = header_.record_size;
        const std::size_t letter = type.find_first_not_of("<>|=");
        if (letter == std::string::npos) fail(fmt::format("the type '{}'", type));
        const char kind = type[letter];
        if (kind == 'O') {
            raise<DataError>(
                "{}: read Python objects, expected numbers; save the array with a numeric type, e.g. "
                "array.astype(float)",
                source_);
        }
        field.big_endian = type[0] == '>';
        std::size_t size = 0;
        for (std::size_t i = letter + 1; i < type.size(); ++i) {
            if (std::isdigit(static_cast<unsigned char>(type[i])) == 0 || size > largest_npy_header)
                break;  // "M8[us]"
            size = size * 10 + static_cast<std::size_t>(type[i] - '0');
        }
        field.size = kind == 'U' ? 4 * size : size;
        const bool integer =
            (kind == 'i' || kind == 'u') && (size == 1 || size == 2 || size == 4 || size == 8);
        field.kind = integer || (kind == 'f' && (size == 4 || size == 8)) ? kind : '\0';
        if (field.size == 0 && kind != 'S' && kind != 'U' && kind != 'V')
            fail(fmt::format("the type '{}'", type));
        header_.record_size += field.size;
        header_.fields.push_back(field);
    }

    void shape() { shape_ = tuple(); }

    void settle() {
        if (header_.fields.empty()) fail("no type");
        if (header_.structured) {
            std::uint64_t rows = 1;
            for (const std::uint64_t size : shape_)
                rows = size == 0                                                 ? 0
                       : rows > most_npy_rows / std::max<std::uint64_t>(size, 1) ? most_npy_rows
                                                                                 : rows * size;
            header_.rows = rows;
        } else {
            if (shape_.size() > 2 || shape_.empty()) {
                raise<DataError>(
                    "{}: read an array of {} dimensions, expected rows and columns; save it as a "
                    "two-dimensional "
                    "array",
                    source_, shape_.size());
            }
            // A few long rows are signals one under another, not a log of a few rows.
            header_.transposed = shape_.size() == 2 && shape_[0] > 1 && shape_[0] <= most_signals &&
                                 shape_[1] >= fewest_times * shape_[0];
            if (header_.transposed) std::swap(shape_[0], shape_[1]);
            const std::uint64_t columns = shape_.size() == 2 ? shape_[1] : 1;
            if (columns > most_npy_fields) fail("too many columns");
            if (columns == 0) fail("no columns");
            header_.by_columns = fortran_ != header_.transposed && columns > 1 && shape_[0] > 1;
            const NpyField first = header_.fields.front();
            for (std::uint64_t c = 1; c < columns; ++c) {
                NpyField field = first;
                field.offset = static_cast<std::size_t>(c) * first.size;
                header_.fields.push_back(field);
            }
            header_.record_size = static_cast<std::size_t>(columns) * first.size;
            header_.rows = shape_[0];
        }
        const auto is_number = [](const NpyField& field) { return field.kind != '\0'; };
        if (header_.record_size == 0 || std::ranges::none_of(header_.fields, is_number)) {
            raise<DataError>(
                "{}: read no column of numbers, expected floats or integers; save the array with a numeric "
                "type",
                source_);
        }
        if (header_.record_size > largest_npy_header) fail("rows of more than 1 MiB");
        if (header_.rows > most_npy_rows / header_.record_size) fail("more rows than a file can hold");
    }

    std::string_view text_;
    const std::string& source_;
    std::size_t at_ = 0;
    bool fortran_ = false;
    std::vector<std::uint64_t> shape_;
    NpyHeader header_;
};

}  // namespace

double load_field(const char* record, const NpyField& field) {
    const double number = load_unscaled(record, field);
    return field.scaled() ? number * field.scale + field.shift : number;
}

std::int64_t load_count(const char* record, const NpyField& field) {
    return load_word<std::int64_t>(record + field.offset, field.big_endian);
}

void store_float(char* record, const NpyField& field, double value) {
    if (field.size == 4) {
        store_word(record + field.offset, field.big_endian, static_cast<float>(value));
    } else {
        store_word(record + field.offset, field.big_endian, value);
    }
}

void load_column(const char* records, std::size_t record_size, const NpyField& field, std::size_t rows,
                 ColumnNumbers& into) {
    const std::size_t before = into.values.size();
    into.values.resize(before + rows);
    const std::span<double> values = std::span(into.values).subspan(before);
    if (field.kind == 'f' && is_native(field) && !field.scaled()) {
        const char* const first = records + field.offset;
        field.size == 4 ? load_native<float>(first, record_size, values)
                        : load_native<double>(first, record_size, values);
        return;
    }
    for (std::size_t row = 0; row < rows; ++row, records += record_size) {
        values[row] = load_field(records, field);
        if (field.whole()) into.counts.push_back(load_count(records, field));
    }
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

std::size_t npy_header_size(std::string_view bytes) {
    if (bytes.size() < 12 || bytes.substr(0, npy_magic.size()) != npy_magic) return 0;
    const auto byte = [&](std::size_t i) {
        return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
    };
    if (byte(6) == 1) return 10 + byte(8) + (byte(9) << 8);
    return 12 + byte(8) + (byte(9) << 8) + (byte(10) << 16) + (byte(11) << 24);
}

NpyHeader parse_npy_header(std::string_view bytes, const std::string& source) {
    const int version = bytes.size() > 6 ? static_cast<unsigned char>(bytes[6]) : 0;
    if (bytes.size() >= 8 && (version < 1 || version > 3)) {
        raise<DataError>("{}: read version {} of the NumPy format, expected 1, 2 or 3; save the array again",
                         source, version);
    }
    const std::size_t size = npy_header_size(bytes);
    if (size == 0 || size > largest_npy_header || bytes.size() < size) {
        raise<DataError>("{}: read a NumPy file cut off in its header, expected {}; save the array again",
                         source, size == 0 ? "at least 12 bytes" : fmt::format("{} bytes of it", size));
    }
    const std::size_t start = version == 1 ? 10 : 12;
    NpyHeader header = HeaderText(bytes.substr(start, size - start), source).parse();
    header.data_offset = size;
    header.version = version;
    return header;
}

std::string NpyHeader::after_rows(std::size_t more_columns) const {
    return structured ? "," : fmt::format(", {}", fields.size() + more_columns);
}

std::string make_npy_header(std::string_view descr, std::string_view shape, bool reserve_rows) {
    std::string text = fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': ({}), }}", descr, shape);
    constexpr std::size_t digits_of_any_count = 20;
    const std::size_t with_space =
        text.size() +
        (reserve_rows ? digits_of_any_count - std::min(digits_of_any_count, shape.find(',')) : 0);
    const bool large = with_space + 1 + 10 + 63 > 0xffff;
    const std::size_t start = large ? 12 : 10;
    const std::size_t total = (start + with_space + 1 + 63) / 64 * 64;
    text.resize(total - start - 1, ' ');
    text += '\n';
    std::string header(npy_magic);
    header += large ? '\x02' : '\x01';
    header += '\0';
    for (std::size_t i = 0; i < start - 8; ++i) header += static_cast<char>((text.size() >> (8 * i)) & 0xff);
    return header + text;
}

}  // namespace ripplenotch
