// SPDX-License-Identifier: MIT
#include "log/npy/npy_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>

#include "log/open.hpp"
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

/// Calls `use` with a zero of the type that a field of numbers holds.
template <class Use>
auto with_type_of(const NpyField& field, const Use& use) {
    const bool real = field.kind == 'f', is_signed = field.kind == 'i';
    switch (field.size) {
        case 1:
            return is_signed ? use(std::int8_t{}) : use(std::uint8_t{});
        case 2:
            return is_signed ? use(std::int16_t{}) : use(std::uint16_t{});
        case 4:
            return real ? use(float{}) : is_signed ? use(std::int32_t{}) : use(std::uint32_t{});
        default:
            return real ? use(double{}) : is_signed ? use(std::int64_t{}) : use(std::uint64_t{});
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
                    "two-dimensional array",
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

std::vector<ColumnInfo> info_of(const NpyHeader& header) {
    std::vector<ColumnInfo> info;
    for (const NpyField& field : header.fields)
        info.push_back({field.name, "", "", field.whole(), field.kind != '\0'});
    return info;
}

}  // namespace

std::optional<NpyField> number_type(std::string_view word) {
    for (const auto& [name, kind] :
         {std::pair("float", 'f'), std::pair("uint", 'u'), std::pair("int", 'i')}) {
        for (const std::size_t size : {1, 2, 4, 8}) {
            if (kind == 'f' && size < 4) continue;
            if (word == fmt::format("{}{}", name, 8 * size) || word == fmt::format("{}{}", kind, size))
                return NpyField{"", kind, size};
        }
    }
    return std::nullopt;
}

double load_field(const char* record, const NpyField& field) {
    const double number = with_type_of(field, [&](auto zero) {
        return static_cast<double>(load_word<decltype(zero)>(record + field.offset, field.big_endian));
    });
    return field.scaled() ? number * field.scale + field.shift : number;
}

std::int64_t load_count(const char* record, const NpyField& field) {
    return load_word<std::int64_t>(record + field.offset, field.big_endian);
}

void load_column(const char* records, std::size_t record_size, const NpyField& field, std::size_t rows,
                 ColumnNumbers& into) {
    const std::size_t before = into.values.size();
    into.values.resize(before + rows);
    const std::span<double> values = std::span(into.values).subspan(before);
    if (is_native(field) && !field.scaled()) {  // which is nearly all there are
        with_type_of(field, [&](auto word) {
            const char* at = records + field.offset;
            for (double& value : values) {
                std::memcpy(&word, at, sizeof word);
                at += record_size;
                value = static_cast<double>(word);
            }
        });
    } else {
        for (std::size_t row = 0; row < rows; ++row)
            values[row] = load_field(records + row * record_size, field);
    }
    for (std::size_t row = 0; row < rows && field.whole(); ++row)
        into.counts.push_back(load_count(records + row * record_size, field));
}

void store_column(char* records, std::size_t record_size, const NpyField& field,
                  std::span<const double> values, std::span<const double> as_written, double factor) {
    // What most logs are, without a question for each value.
    const bool plain = field.size == 8 && is_native(field) && factor == 1.0;
    char* into = records + field.offset;
    for (std::size_t i = 0; i < values.size(); ++i, into += record_size) {
        if (!as_written.empty() && values[i] == as_written[i]) continue;
        if (plain)
            std::memcpy(into, &values[i], sizeof(double));
        else if (field.size == 4)
            store_word(into, field.big_endian, static_cast<float>(values[i] / factor));
        else
            store_word(into, field.big_endian, values[i] / factor);
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

RecordColumns::RecordColumns(std::unique_ptr<ByteSource> source, std::string first_bytes, NpyHeader header,
                             std::string head)
    : Columns(source->name(), info_of(header)),
      source_(std::move(source)),
      begun_(std::move(first_bytes)),
      header_(std::move(header)),
      head_(std::move(head)) {}

std::size_t RecordColumns::next(std::size_t rows, NumberRows& into, std::string& bytes) {
    const std::size_t size = header_.record_size, left = header_.rows - rows_, at = bytes.size();
    const std::size_t asked = left == 0 ? 1 : std::min(left, std::max<std::size_t>(1, rows)) * size;
    const std::size_t taken = std::min(asked, begun_.size() - begun_at_);
    bytes.append(begun_, begun_at_, taken);
    begun_at_ += taken;
    read_on(*source_, bytes, at + asked);
    const std::size_t have = bytes.size() - at, whole = left == 0 ? 0 : have / size;
    if (left == 0 && have > 0) {
        raise<DataError>(
            "{}: read more bytes after the {} rows of the array, expected the end; save one array a file",
            name(), header_.rows);
    }
    if (whole == 0 && have > 0 && header_.rows == rows_unknown) complain_of_end(have);
    if (whole == 0 && left > 0 && header_.rows != rows_unknown) {
        raise<DataError>(
            "{}: read {} rows and a part of one, expected {} rows; the file is cut off, save the array again",
            name(), rows_, header_.rows);
    }
    // A part of a row is the end of the file.
    if (have > whole * size) {
        begun_ = bytes.substr(at + whole * size);
        begun_at_ = 0;
    }
    bytes.resize(at + whole * size);
    for (std::size_t c = 0; c < header_.fields.size(); ++c)
        if (wanted(c) && info()[c].number)
            load_column(bytes.data() + at, size, header_.fields[c], whole, into[c]);
    rows_ += whole;
    return whole;
}

void RecordColumns::complain_of_end(std::size_t left_over) const {
    raise<DataError>(
        "{}: read {} rows and {} bytes of one more, expected records of {} bytes; the file is cut off, or "
        "its records differ from its header",
        name(), rows_, left_over, header_.record_size);
}

}  // namespace ripplenotch
