// SPDX-License-Identifier: MIT
// MAT files of versions 5, 6 and 7 (MathWorks, "MAT-File Format"). Those of version 7.3 are HDF5.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "log/containers/stored_array.hpp"
#include "log/npy/npy_header.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

namespace mat_type {

// Numbers of data types in MAT files of level 5.
enum : std::uint32_t {
    int8 = 1,
    uint16 = 4,
    int32 = 5,
    uint32 = 6,
    float64 = 9,
    matrix = 14,
    compressed = 15,
    utf16 = 17
};

}  // namespace mat_type

// New MAT files of version 5, which every MATLAB, Octave and SciPy reads: a column vector for each column.

constexpr std::size_t text_size = 116, longest_variable = 63;
constexpr std::uint64_t most_mat_rows = (std::uint64_t{1} << 29) - 64;  // of 8 bytes: sizes have 32 bits

constexpr std::uint32_t double_class = 6;

void add_word(std::string& bytes, std::uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift & 0xffU);
}

// Letters, digits and underscores, a letter first: what MATLAB calls a variable.
std::string variable_name(const std::string& name) {
    std::string plain = name;
    for (char& c : plain)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    if (plain.empty() || std::isalpha(static_cast<unsigned char>(plain.front())) == 0) plain = "x" + plain;
    return plain.substr(0, longest_variable);
}

/// A variable is stored as a whole, so that each column waits in a temporary file until the last row is
/// known.
class MatTableWriter final : public TableWriter {
  public:
    /// Arrays hold every digit: of the options none concerns them.
    MatTableWriter(ByteSink& sink, std::span<const std::string> names, const WriteOptions& /*options*/)
        : sink_(sink), columns_(names.size()) {
        for (const std::string& name : names) names_.push_back(variable_name(name));
        std::string head = "MATLAB 5.0 MAT-file, written by ripplenotch";
        head.resize(text_size, ' ');
        head.append(8, '\0');
        head += '\0';  // version 1.0, then the byte order
        head += "\x01IM";
        sink_.write(head);
    }
    void rows(std::span<const std::span<const double>> columns) override {
        for (std::size_t c = 0; c < columns.size(); ++c) {
            bytes_.resize(8 * columns[c].size());
            store_column(bytes_.data(), 8, {}, columns[c]);
            columns_[c].put(bytes_);
        }
        if (!columns.empty()) rows_ += columns[0].size();
    }
    /// Throws UsageError beyond the 4 GiB that a variable of this version can have.
    void end() override {
        if (rows_ > most_mat_rows) {
            raise<UsageError>(
                "a MAT file of version 5 holds at most {} rows, and these are {}; write -o NAME.h5 or -o "
                "NAME.npy",
                most_mat_rows, rows_);
        }
        for (std::size_t c = 0; c < names_.size(); ++c) {
            write_head(names_[c]);
            columns_[c].copy_to(sink_);
        }
    }

  private:
    void write_head(const std::string& name) {
        std::string head;
        const auto add_tag = [&](std::uint32_t type, std::uint64_t size) {
            add_word(head, type);
            add_word(head, static_cast<std::uint32_t>(size));
        };
        add_tag(mat_type::uint32, 8);
        add_word(head, double_class);
        add_word(head, 0);
        add_tag(mat_type::int32, 8);
        add_word(head, static_cast<std::uint32_t>(rows_));
        add_word(head, 1);
        add_tag(mat_type::int8, name.size());
        head += name;
        head.append((8 - name.size() % 8) % 8, '\0');
        add_tag(mat_type::float64, 8 * rows_);
        std::string whole;
        add_word(whole, mat_type::matrix);
        add_word(whole, static_cast<std::uint32_t>(head.size() + 8 * rows_));
        sink_.write(whole + head);
    }

    ByteSink& sink_;
    std::vector<std::string> names_;
    std::vector<TemporaryBytes> columns_;
    std::string bytes_;
    std::uint64_t rows_ = 0;
};

constexpr int deepest_nesting = 16;
constexpr std::uint64_t most_unpacked = std::uint64_t{1} << 33;
constexpr std::size_t longest_name = 4096, most_mat_fields = 4096, most_things = 100000;

// Numbers of the format's array classes.
enum Class : unsigned {
    cell = 1,
    structure = 2,
    object = 3,
    text = 4,
    sparse = 5,
    first_number = 6,
    last_number = 15,
    function = 16,
    opaque = 17
};

struct Storage {
    char kind;
    std::size_t size;
};
std::optional<Storage> storage_of(std::uint32_t type) {
    constexpr std::string_view kinds = " iuiuiuf f  iu", sizes = "01122444080088";
    if (type >= kinds.size() || kinds[type] == ' ') return std::nullopt;
    return Storage{kinds[type], static_cast<std::size_t>(sizes[type] - '0')};
}

std::string_view class_name(unsigned code) {
    if (code >= first_number && code <= last_number) return "";
    constexpr std::array<std::string_view, first_number> below = {
        "unknown", "a cell array", "a struct", "an object", "text", "a sparse matrix"};
    return code < first_number ? below[code]
           : code == function  ? "a function handle"
           : code == opaque    ? "an object (a table, a timeseries, a string)"
                               : "unknown";
}

struct Element {
    std::uint32_t type = 0;
    std::uint64_t data = 0, size = 0, next = 0;
};

/// The arrays of a whole file, of which only the heads of its elements are read.
class MatWalk {
  public:
    explicit MatWalk(const std::shared_ptr<StoredBytes>& file) : file_(file) {
        const std::string head = file_->text_at(0, 128);
        big_endian_ = head[126] == 'M';
        for (std::uint64_t at = 128; at + 8 <= file_->size();) {
            const Element element = element_at(*file_, at);
            if (element.next > file_->size() && element.data + element.size > file_->size())
                fail(at, fmt::format("an element of {} bytes, of which {} are there; the file is cut off",
                                     element.size, file_->size() - std::min(file_->size(), element.data)));
            if (element.type == mat_type::compressed) {
                const auto inside =
                    unpack_part(file_, element.data, element.size, Deflate::wrapped, most_unpacked);
                read_matrix(inside, element_at(*inside, 0), "", 0);
                at = element.data + element.size;
            } else {
                if (element.type == mat_type::matrix) read_matrix(file_, element, "", 0);
                at = element.next;
            }
        }
        name_signals();
    }
    std::vector<StoredArray>
        arrays;  ///< of numbers, by paths as MATLAB writes them: "log.q_dot", "runs(2).tau"
    std::vector<ContentEntry> others;  ///< what is no log: "a function handle", "complex"

  private:
    [[noreturn]] void fail(std::uint64_t at, const std::string& what) const {
        raise<DataError>("{}: read at byte {} {}; save it again in MATLAB", file_->name(), at, what);
    }
    std::uint32_t word(StoredBytes& bytes, std::uint64_t at) const {
        std::array<unsigned char, 4> raw{};
        bytes.read_at(at, reinterpret_cast<char*>(raw.data()), raw.size());
        if (big_endian_ != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
        return std::bit_cast<std::uint32_t>(raw);
    }
    Element element_at(StoredBytes& bytes, std::uint64_t at) const {
        const std::uint32_t first = word(bytes, at);
        if (first >> 16U != 0)
            return {first & 0xffffU, at + 4, std::min<std::uint64_t>(first >> 16U, 4), at + 8};
        const std::uint64_t size = word(bytes, at + 4);
        return {first, at + 8, size, at + 8 + (size + 7) / 8 * 8};
    }
    std::string text_of(StoredBytes& bytes, const Element& element) const {
        if (element.size > longest_name) fail(element.data, "a name of more than 4096 bytes");
        return bytes.text_at(element.data, static_cast<std::size_t>(element.size));
    }

    void read_matrix(const std::shared_ptr<StoredBytes>& bytes, const Element& whole, const std::string& path,
                     int depth) {
        if (depth > deepest_nesting) fail(whole.data, "a struct nested deeper than 16");
        if (++things_ > most_things) fail(whole.data, "more than 100000 arrays");
        if (whole.type != mat_type::matrix)
            fail(whole.data, fmt::format("an element of type {}, expected an array", whole.type));
        if (whole.size == 0) return;  // an empty field
        const Element flags = element_at(*bytes, whole.data);
        const std::uint32_t flag_bits = word(*bytes, flags.data);
        const unsigned code = flag_bits & 0xffU;
        const Element sides = element_at(*bytes, flags.next);
        if (code == opaque) {
            std::string name = path.empty() ? text_of(*bytes, sides) : path;
            std::string kind(class_name(code));
            // The name, how it is stored ("MCOS"), and the class.
            const std::uint64_t end = whole.data + whole.size;
            if (path.empty() && sides.next < end) {
                const Element storage = element_at(*bytes, sides.next);
                if (storage.next < end)
                    kind = matlab_object_text(name, text_of(*bytes, element_at(*bytes, storage.next)));
            }
            others.push_back({name, "", kind, "", {}, false});
            return;
        }
        std::vector<std::uint64_t> dimensions;
        if (sides.size > 256) fail(sides.data, "an array of more than 64 dimensions");
        for (std::uint64_t at = 0; at + 4 <= sides.size; at += 4)
            dimensions.push_back(word(*bytes, sides.data + at));
        const Element name = element_at(*bytes, sides.next);
        const std::string own = path.empty() ? text_of(*bytes, name) : path;
        if (code == structure) {
            read_struct(bytes, name.next, dimensions, own, depth);
        } else if (code >= first_number && code <= last_number) {
            add_numbers(bytes, element_at(*bytes, name.next), dimensions, own, flag_bits);
        } else {
            if (code == text) keep_words(*bytes, element_at(*bytes, name.next), own);
            add_other(dimensions, own, std::string(class_name(code)));
        }
    }
    // What dSPACE's ControlDesk calls the signals of Y: "Model Root"/"Joint"/torque_nm, and their units.
    void keep_words(StoredBytes& bytes, const Element& characters, const std::string& path) {
        if (!path.ends_with(".Name") && !path.ends_with(".Unit")) return;
        if (characters.size > longest_name) return;
        std::string words;
        const bool wide = characters.type == mat_type::uint16 || characters.type == mat_type::utf16;
        for (const char c : bytes.text_at(characters.data, static_cast<std::size_t>(characters.size)))
            if (c != '\0' || !wide) words.push_back(c);
        words_[path] = words;
    }
    void name_signals() {
        for (StoredArray& array : arrays) {
            if (!array.path.ends_with(".Data")) continue;
            const std::string folder = array.path.substr(0, array.path.rfind('.'));
            const std::string axis = folder.substr(folder.rfind('.') + 1);
            if (const auto unit = words_.find(folder + ".Unit"); unit != words_.end())
                array.unit = unit->second;
            const auto name = words_.find(folder + ".Name");
            if (axis == "X" || axis.starts_with("X("))
                array.read_as = "time";
            else if (name != words_.end() && (axis == "Y" || axis.starts_with("Y(")))
                array.read_as = signal_name(name->second);
        }
    }
    static std::string signal_name(const std::string& words) {
        std::string last = words.substr(words.rfind('/') + 1);
        std::erase(last, '"');
        return last.empty() ? words : last;
    }

    void read_struct(const std::shared_ptr<StoredBytes>& bytes, std::uint64_t at,
                     const std::vector<std::uint64_t>& dimensions, const std::string& path, int depth) {
        const Element width = element_at(*bytes, at);
        const std::uint64_t length = word(*bytes, width.data);
        const Element names = element_at(*bytes, width.next);
        if (length == 0 || length > longest_name) fail(names.data, "a struct with names of no length");
        const std::uint64_t fields = names.size / length;
        std::uint64_t count = 1;
        for (const std::uint64_t side : dimensions)
            count =
                side > most_things ? most_things + 1 : std::min<std::uint64_t>(count * side, most_things + 1);
        if (fields > most_mat_fields || count > most_things)
            fail(names.data, "a struct with too many fields");
        std::uint64_t next = names.next;
        for (std::uint64_t i = 0; i < count; ++i) {
            for (std::uint64_t f = 0; f < fields; ++f) {
                const std::string name =
                    bytes->text_at(names.data + f * length, static_cast<std::size_t>(length));
                const Element field = element_at(*bytes, next);
                read_matrix(
                    bytes, field,
                    fmt::format("{}{}.{}", path, count > 1 ? fmt::format("({})", i + 1) : "", name.c_str()),
                    depth + 1);
                next = field.next;
            }
        }
    }

    void add_numbers(const std::shared_ptr<StoredBytes>& bytes, const Element& numbers,
                     const std::vector<std::uint64_t>& dimensions, const std::string& path,
                     std::uint32_t flags) {
        constexpr std::uint32_t complex_bit = 0x800, logical_bit = 0x200;
        const auto storage = storage_of(numbers.type);
        const auto shape = shape_over_time(dimensions);
        if ((flags & complex_bit) != 0) return add_other(dimensions, path, "complex numbers");
        if ((flags & logical_bit) != 0) return add_other(dimensions, path, "logical");
        if (!storage) fail(numbers.data, fmt::format("numbers of type {}, which no array has", numbers.type));
        if (!shape || shape->rows < 2) return add_other(dimensions, path, "numbers");
        if (shape->rows > numbers.size / storage->size / shape->columns)
            fail(numbers.data, fmt::format("{} bytes of numbers of {}, expected {} x {} of {} bytes",
                                           numbers.size, path, shape->rows, shape->columns, storage->size));
        StoredArray array;
        array.path = path;
        array.shape = *shape;
        array.type.kind = storage->kind;
        array.type.size = storage->size;
        array.type.big_endian = big_endian_;
        array.open = [bytes, own = *shape, type = array.type, start = numbers.data](std::size_t column) {
            // A matrix is stored column by column.
            const bool together = own.vector || own.time_is_first;
            return strided_numbers(bytes, start + column * type.size * (together ? own.rows : 1),
                                   type.size * (together ? 1 : own.columns), type);
        };
        arrays.push_back(std::move(array));
    }
    void add_other(const std::vector<std::uint64_t>& dimensions, const std::string& path, std::string what) {
        others.push_back(
            {path, fmt::format("{}", fmt::join(dimensions, " x ")), std::move(what), "", {}, false});
    }

    std::shared_ptr<StoredBytes> file_;
    bool big_endian_ = false;
    std::size_t things_ = 0;
    std::map<std::string, std::string> words_;  ///< by their paths
};

constexpr std::array<std::string_view, 1> mat_extensions = {".mat"};

// Text of 116 bytes, then version and byte order; that of version 7.3 is 2.
bool sniff(std::string_view bytes) {
    if (bytes.size() < 128) return false;
    const std::string_view order = bytes.substr(126, 2);
    const bool little = order == "IM", big = order == "MI";
    const char version = little ? bytes[125] : bytes[124];
    return (little || big) && version == 1;
}

ColumnLog make_mat(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    if (!sniff(first_bytes))
        raise<DataError>("{}: read no head of a MAT file, expected one; leave out --format", source->name());
    const auto file = store_bytes(std::move(source), std::move(first_bytes));
    const MatWalk found(file);
    return columns_of_arrays(file, "mat", PathStyle::matlab, found.arrays, found.others, options);
}

}  // namespace

const LogFormat formats::mat{
    .name = "mat",
    .summary = "MATLAB files (versions 5 to 7; 7.3 is HDF5): vectors and matrices by name, fields of structs",
    .extensions = mat_extensions,
    .binary = true,
    .sniff = sniff,
    .columns = make_mat,
    .table = table_of<MatTableWriter>,
};

}  // namespace ripplenotch
