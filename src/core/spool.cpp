// SPDX-License-Identifier: MIT
#include "ripplenotch/core/spool.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t piece_size = std::size_t{1} << 20;

void copy_to(ByteSource& source, int descriptor, const std::string& temporary) {
    std::vector<char> piece(piece_size);
    while (const std::size_t size = source.read(piece.data(), piece.size())) {
        std::size_t written = 0;
        while (written < size) {
            const ssize_t taken = ::write(descriptor, piece.data() + written, size - written);
            if (taken < 0 && errno == EINTR) continue;
            if (taken < 0) {
                raise<FileError>(
                    "{}: cannot keep {} for a second pass: {}; TMPDIR=FOLDER names another place", temporary,
                    source.name(), std::strerror(errno));
            }
            written += static_cast<std::size_t>(taken);
        }
    }
}

}  // namespace

Spool::Spool(const std::string& path) : path_(path) {
    std::error_code failed;
    if (path != "-" &&
        (std::filesystem::is_regular_file(path, failed) || !std::filesystem::exists(path, failed)))
        return;
    ByteSource source(path);
    name_ = source.name();
    std::string name = (std::filesystem::temp_directory_path(failed) / "ripplenotch-XXXXXX").string();
    if (failed)
        raise<FileError>("no folder for temporary files: {}; TMPDIR=FOLDER names one", failed.message());
    const int descriptor = ::mkstemp(name.data());
    if (descriptor < 0) raise<FileError>("{}: cannot make a temporary file: {}", name, std::strerror(errno));
    temporary_ = name;
    try {
        copy_to(source, descriptor, temporary_);
    } catch (...) {
        ::close(descriptor);
        ::unlink(temporary_.c_str());
        throw;
    }
    ::close(descriptor);
}

Spool::~Spool() {
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

std::unique_ptr<ByteSource> Spool::open() const {
    if (temporary_.empty()) return std::make_unique<ByteSource>(path_);
    return std::make_unique<ByteSource>(temporary_, name_);
}

}  // namespace ripplenotch
