// SPDX-License-Identifier: MIT
#include "core/files/open_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/files/pipes.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::string system_reason() { return std::strerror(errno); }

FileState FileState::of(int descriptor) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) return {};
    return {status.st_dev,  status.st_ino,  status.st_size,
            status.st_mtim, status.st_ctim, S_ISREG(status.st_mode)};
}

bool FileState::same_bytes(const FileState& other) const {
    const auto same = [](const timespec& a, const timespec& b) {
        return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
    };
    // Who writes may set the time of writing back; nobody sets the other.
    return device == other.device && inode == other.inode && size == other.size &&
           same(written, other.written) && same(touched, other.touched);
}

OpenFile::OpenFile(const std::string& path) : path_(path) {
    if (path == "-") {
        owns_ = false;
        descriptor_ = STDIN_FILENO;
        if (::isatty(STDIN_FILENO) == 1) {
            raise<UsageError>(
                "standard input is a terminal; name a file, or pipe one in: cat log.csv | ripplenotch ...");
        }
        state_ = FileState::of(descriptor_);
        begin_ = state_.regular ? std::max<off_t>(0, ::lseek(descriptor_, 0, SEEK_CUR)) : 0;
        widen_pipe(descriptor_);
        return;
    }
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0) raise<FileError>("{}: cannot open: {}", path, system_reason());
    struct stat status {};
    if (::fstat(descriptor_, &status) == 0 && S_ISDIR(status.st_mode)) {
        ::close(descriptor_);
        raise<FileError>("{}: is a directory; name a file in it", path);
    }
    state_ = FileState::of(descriptor_);
    if (S_ISFIFO(status.st_mode)) widen_pipe(descriptor_);
}

OpenFile::OpenFile(std::string path, int descriptor)
    : path_(std::move(path)), descriptor_(descriptor), state_(FileState::of(descriptor)) {}

OpenFile::~OpenFile() {
    if (owns_) ::close(descriptor_);
}

void OpenFile::require_unchanged(off_t end, std::string_view name) const {
    if (!state_.regular || state_.size == 0) return;
    const FileState now = FileState::of(descriptor_);
    if (end == state_.size && now.same_bytes(state_)) return;
    const std::string sizes =
        end == state_.size
            ? "something wrote to it"
            : fmt::format("{} bytes when it was opened, {} when its end was reached", state_.size, end);
    raise<FileError>(
        "{}: the file changed while it was read: {}; wait until nothing writes to it, or read a copy", name,
        sizes);
}

}  // namespace ripplenotch
