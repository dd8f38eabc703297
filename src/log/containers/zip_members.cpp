// SPDX-License-Identifier: MIT
#include "log/containers/zip_members.hpp"

#include <algorithm>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

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

}  // namespace

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

}  // namespace ripplenotch
