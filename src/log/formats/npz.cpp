// SPDX-License-Identifier: MIT
// Archives of NumPy arrays, as numpy.savez and savez_compressed write them.

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "log/containers/stored_array.hpp"
#include "log/npy/npy_header.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 1> extensions = {".npz"};
constexpr std::size_t largest_header = std::size_t{1} << 20, most_columns = 64, most_fields = 4096;

// The members of a ZIP archive (PKWARE APPNOTE 6.3), stored or deflated, as bytes that are read here and
// there.

struct ZipMember {
    std::string name;
    std::uint64_t size = 0;              ///< unpacked
    std::shared_ptr<StoredBytes> bytes;  ///< of the whole archive, or unpacked
    std::uint64_t offset = 0;            ///< of the member in them
    std::uint32_t checksum = 0;          ///< CRC-32
    bool packed = false;                 ///< and checked when it is unpacked
};

constexpr std::size_t end_size = 22, longest_comment = 65535, most_members = 10000;
constexpr std::uint64_t most_for_one = 1100, unasked = std::uint64_t{1} << 26;  // deflate cannot do better

std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
    return little_endian(bytes.substr(std::min(at, bytes.size()), size));
}

struct Directory {
    std::uint64_t offset = 0, members = 0;
};

Directory find_directory(StoredBytes& archive) {
    const std::size_t tail_size =
        static_cast<std::size_t>(std::min<std::uint64_t>(archive.size(), end_size + longest_comment));
    const std::string tail = archive.text_at(archive.size() - tail_size, tail_size);
    const std::size_t end = tail.rfind("PK\x05\x06");
    if (end == std::string::npos || end + end_size > tail.size())
        raise<DataError>(
            "{}: read an archive without its directory, expected one at the end; the file is cut off, save "
            "it again",
            archive.name());
    Directory directory{number_at(tail, end + 16, 4), number_at(tail, end + 10, 2)};
    if (end >= 20 && tail.compare(end - 20, 4, "PK\x06\x07") == 0) {
        const std::string large = archive.text_at(number_at(tail, end - 12, 8), 56);
        directory = {number_at(large, 48, 8), number_at(large, 32, 8)};
    }
    return directory;
}

// Sizes of four bytes that do not suffice stand in an extra field of number 1.
void read_large_sizes(std::string_view extra, std::uint64_t& size, std::uint64_t& packed,
                      std::uint64_t& offset) {
    for (std::size_t at = 0; at + 4 <= extra.size();) {
        const std::size_t length = number_at(extra, at + 2, 2);
        if (number_at(extra, at, 2) == 1) {
            std::size_t place = at + 4;
            for (std::uint64_t* const value : {&size, &packed, &offset}) {
                if (*value != 0xffffffffU) continue;
                *value = number_at(extra, place, 8);
                place += 8;
            }
        }
        at += 4 + length;
    }
}

// In the order of the archive's directory. Throws DataError on a damaged one, and on members that are
// encrypted or packed in another way.
std::vector<ZipMember> zip_members(const std::shared_ptr<StoredBytes>& archive) {
    const Directory directory = find_directory(*archive);
    if (directory.members > most_members)
        raise<DataError>("{}: read an archive of {} files, expected a few arrays", archive->name(),
                         directory.members);
    std::vector<ZipMember> members;
    std::uint64_t at = directory.offset;
    for (std::uint64_t m = 0; m < directory.members; ++m) {
        const std::string head = archive->text_at(at, 46);
        if (!head.starts_with("PK\x01\x02"))
            raise<DataError>(
                "{}: read no entry of an archive at byte {}, expected file {} of {}; save it again",
                archive->name(), at, m + 1, directory.members);
        const std::size_t name_size = number_at(head, 28, 2), extra_size = number_at(head, 30, 2);
        std::uint64_t packed = number_at(head, 20, 4), size = number_at(head, 24, 4),
                      local = number_at(head, 42, 4);
        const std::string rest = archive->text_at(at + 46, name_size + extra_size);
        read_large_sizes(std::string_view(rest).substr(name_size), size, packed, local);
        at += 46 + name_size + extra_size + number_at(head, 32, 2);
        const std::string local_head = archive->text_at(local, 30);
        const std::uint64_t data = local + 30 + number_at(local_head, 26, 2) + number_at(local_head, 28, 2);
        const std::uint64_t method = number_at(head, 10, 2);
        const auto checksum = static_cast<std::uint32_t>(number_at(head, 16, 4));
        ZipMember member{rest.substr(0, name_size), size, archive, data, checksum, method == 8};
        if (method == 8 && size > unasked && size / most_for_one > packed) {
            raise<DataError>("{}: read '{}' of {} bytes out of {}, expected no more than {} for one",
                             archive->name(), member.name, size, packed, most_for_one);
        }
        if (method == 8) {
            member.bytes = unpack_part(archive, data, packed, Deflate::bare, size, checksum);
            member.offset = 0;
        } else if (method != 0 || number_at(head, 8, 2) % 2 == 1) {
            raise<DataError>(
                "{}: read '{}' packed by method {}{}, expected stored or deflated; save it again with "
                "numpy.savez",
                archive->name(), member.name, method, number_at(head, 8, 2) % 2 == 1 ? " and encrypted" : "");
        }
        members.push_back(std::move(member));
    }
    return members;
}

// The name of the first file says whether an archive is of arrays.
bool sniff(std::string_view bytes) {
    if (!bytes.starts_with("PK\x03\x04") || bytes.size() < 31) return false;
    return bytes.substr(30, little_endian(bytes.substr(26, 2))).ends_with(".npy");
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
                          field, check](std::size_t) {
                check();
                return strided_numbers(bytes, from, stride, field);
            };
            arrays.push_back(std::move(array));
        }
        return;
    }
    const NpyField& type = header.fields.front();
    const std::size_t columns = header.fields.size();
    StoredArray array{name, {header.rows, columns, columns == 1, !header.transposed}, type, "", {}, ""};
    array.open = [bytes = member.bytes, start, type, together = header.by_columns, rows = header.rows,
                  record = header.record_size, check = checked_once(member)](std::size_t c) {
        check();
        return strided_numbers(bytes, start + c * type.size * (together ? rows : 1),
                               together ? type.size : record, type);
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

ColumnLog make_npz(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
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
    return columns_of_arrays(archive, "npz", PathStyle::numpy, arrays, others, options);
}

}  // namespace

const LogFormat formats::npz{
    .name = "npz",
    .summary = "archives of NumPy arrays, packed or not",
    .extensions = extensions,
    .binary = true,
    .sniff = sniff,
    .columns = make_npz,
};

}  // namespace ripplenotch
