// SPDX-License-Identifier: MIT
#include "ripplenotch/core/spool.hpp"

#include <unistd.h>

#include <cerrno>
#include <vector>

#include "core/files/open_file.hpp"
#include "core/files/temporary_file.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t piece_size = std::size_t{1} << 20;

void copy_to(ByteSource& source, int descriptor, const std::string& folder) {
    std::vector<char> piece(piece_size);
    while (const std::size_t size = source.read(piece.data(), piece.size())) {
        std::size_t written = 0;
        while (written < size) {
            const ssize_t taken = ::write(descriptor, piece.data() + written, size - written);
            if (taken < 0 && errno == EINTR) continue;
            if (taken < 0) {
                raise<FileError>(
                    "{}: cannot keep {} for a second pass: {}; TMPDIR=FOLDER names another place", folder,
                    source.name(), system_reason());
            }
            written += static_cast<std::size_t>(taken);
        }
    }
}

}  // namespace

Spool::Spool(const std::string& path) : path_(path) {
    const auto file = std::make_shared<const OpenFile>(path);
    if (file->by_place()) {
        file_ = file;
        return;
    }
    // Read under its own name, so that it is hashed like any other input.
    ByteSource source(file);
    name_ = source.name();
    const std::string folder = temporary_folder();
    TemporaryFile kept(folder + "/ripplenotch-spool", std::nullopt);
    const int descriptor = kept.release_without_name();
    try {
        copy_to(source, descriptor, folder);
        file_ = std::make_shared<const OpenFile>("", descriptor);
    } catch (...) {
        ::close(descriptor);
        throw;
    }
}

Spool::~Spool() = default;

std::unique_ptr<ByteSource> Spool::open() const {
    if (name_.empty()) return std::make_unique<ByteSource>(file_);
    return std::make_unique<ByteSource>(file_, name_);
}

}  // namespace ripplenotch
