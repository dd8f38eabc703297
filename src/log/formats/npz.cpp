// SPDX-License-Identifier: MIT
// Archives of NumPy arrays, as numpy.savez and savez_compressed write them.

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>

#include "log/containers/stored_array.hpp"
#include "log/containers/zip_members.hpp"
#include "log/formats.hpp"
#include "log/npy/npy_header.hpp"
#include "log/records/joined_records.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 1> extensions = {".npz"};
constexpr std::size_t largest_header = std::size_t{1} << 20, most_columns = 64, most_fields = 4096;

// The name of the first file says whether an archive is of arrays.
bool sniff(std::string_view bytes) {
    if (!bytes.starts_with("PK\x03\x04") || bytes.size() < 31) return false;
    const std::size_t size =
        static_cast<unsigned char>(bytes[26]) + 256U * static_cast<unsigned char>(bytes[27]);
    return bytes.substr(30, size).ends_with(".npy");
}

// What is stored as it is is compared with its checksum before it is read.
std::function<void()> checked_once(const ZipMember& member) {
    return [member, done = std::make_shared<bool>(member.packed)] {
        if (!*done) require_checksum(*member.bytes, member.offset, member.size, member.checksum);
        *done = true;
    };
}

// A plain array is one thing with columns; the fields of a structured one are vectors beside each other.
void add_arrays(const ZipMember& member, const std::string& name, const NpyHeader& header,
                std::vector<StoredArray>& arrays) {
    const std::uint64_t start = member.offset + header.data_offset;
    if (header.structured) {
        const auto check = checked_once(member);
        for (const NpyField& field : header.fields) {
            if (field.kind == '\0') continue;
            StoredArray array{name + "." + field.name, {header.rows, 1, true, true}, field, "", {}, ""};
            array.open = [bytes = member.bytes, from = start + field.offset, stride = header.record_size,
                          size = field.size, check](std::size_t) {
                check();
                return strided_cursor(bytes, from, stride, size);
            };
            arrays.push_back(std::move(array));
        }
        return;
    }
    const NpyField& type = header.fields.front();
    const std::size_t columns = header.fields.size();
    StoredArray array{name, {header.rows, columns, columns == 1, !header.transposed}, type, "", {}, ""};
    array.open = [bytes = member.bytes, start, size = type.size, together = header.by_columns,
                  rows = header.rows, record = header.record_size,
                  check = checked_once(member)](std::size_t c) {
        check();
        return strided_cursor(bytes, start + c * size * (together ? rows : 1), together ? size : record,
                              size);
    };
    arrays.push_back(std::move(array));
}

// None where it is no log: objects, text, more dimensions than two, one row.
std::optional<NpyHeader> header_of(const ZipMember& member, const std::string& archive) {
    const auto size_of = [&](std::size_t most) {
        return static_cast<std::size_t>(std::min<std::uint64_t>(most, member.size));
    };
    const std::string start = member.bytes->text_at(member.offset, size_of(12));
    const std::size_t head = std::min<std::size_t>(npy_header_size(start), largest_header);
    const std::string text = member.bytes->text_at(member.offset, size_of(head));
    NpyHeader header;
    try {
        header = parse_npy_header(text, archive);
    } catch (const DataError&) {
        return std::nullopt;
    }
    if (header.rows < 2 || header.fields.size() > (header.structured ? most_fields : most_columns))
        return std::nullopt;
    if (header.data_offset > member.size ||
        header.rows > (member.size - header.data_offset) / header.record_size) {
        raise<DataError>("{}: read '{}' of {} bytes, expected {} rows of {} bytes; save it again", archive,
                         member.name, member.size, header.rows, header.record_size);
    }
    return header;
}

Records make_npz(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    const auto archive = store_bytes(std::move(source), std::move(first_bytes));
    std::vector<StoredArray> arrays;
    std::vector<ContentEntry> others;
    for (const ZipMember& member : zip_members(archive)) {
        if (!member.name.ends_with(".npy")) continue;
        const std::string name = member.name.substr(0, member.name.size() - 4);
        if (const auto header = header_of(member, archive->name()))
            add_arrays(member, name, *header, arrays);
        else
            others.push_back({name, "", "no log", "", {}, false});
    }
    return records_of_arrays(archive, "npz", PathStyle::numpy, arrays, others, options);
}

}  // namespace

const LogFormat formats::npz{
    .name = "npz",
    .summary = "archives of NumPy arrays, packed or not",
    .extensions = extensions,
    .binary = true,
    .sniff = sniff,
    .open = open_as_records<make_npz>,
};

}  // namespace ripplenotch
