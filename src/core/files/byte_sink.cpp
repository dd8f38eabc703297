// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <optional>

#include "core/files/open_file.hpp"
#include "core/files/pipes.hpp"
#include "core/files/temporary_file.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t page_group = std::size_t{1} << 16;
constexpr std::uint64_t least_reserved = std::uint64_t{4}
                                         << 20;  // what is written in a few pieces needs none

std::optional<struct stat> status_of(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return status;
}

// The file that a link stands for takes the new bytes, and the link stays.
std::string behind_links(const std::string& path) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0 || !S_ISLNK(status.st_mode)) return path;
    char* const real = ::realpath(path.c_str(), nullptr);
    if (real == nullptr)
        raise<FileError>("{}: is a link to a file that cannot be reached: {}; remove it, or name that file",
                         path, system_reason());
    const std::string target = real;
    std::free(real);  // NOLINT: of the C library
    return target;
}

using Parts = std::array<std::string_view, 2>;

// One part behind the other.
void write_fully(int descriptor, Parts parts, const std::string& path) {
    while (!parts[0].empty() || !parts[1].empty()) {
        std::array<iovec, 2> vectors;
        for (std::size_t i = 0; i < parts.size(); ++i)
            vectors[i] = {const_cast<char*>(parts[i].data()), parts[i].size()};
        const ssize_t done = ::writev(descriptor, vectors.data(), static_cast<int>(vectors.size()));
        if (done < 0) {
            if (errno == EINTR) continue;
            raise<FileError>("{}: cannot write: {}", path, system_reason());
        }
        const auto taken = static_cast<std::size_t>(done), of_first = std::min(taken, parts[0].size());
        parts[0].remove_prefix(of_first);
        parts[1].remove_prefix(taken - of_first);
    }
}

}  // namespace

ByteSink::ByteSink(const std::string& path, Overwrite overwrite, bool binary)
    : path_(path), overwrite_(overwrite) {
    if (path == "-") {
        descriptor_ = STDOUT_FILENO;
        if (binary && ::isatty(STDOUT_FILENO) == 1) {
            raise<UsageError>("binary output would go to the terminal; name a file with -o, or pipe it on");
        }
        widen_pipe(descriptor_);
        return;
    }
    const std::string target = behind_links(path);
    const auto replaced = status_of(target);
    // A device or a named pipe is written in place: /dev/null must stay what it is.
    if (replaced && !S_ISREG(replaced->st_mode)) {
        descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
        if (descriptor_ < 0) raise<FileError>("{}: cannot write: {}", path, system_reason());
        widen_pipe(descriptor_);
        return;
    }
    if (replaced && !overwrite.allowed) {
        raise<FileError>("{}: exists already; choose another name or overwrite it with --force", path);
    }
    target_ = target;
    file_ = std::make_unique<TemporaryFile>(target_, replaced);
    descriptor_ = file_->descriptor();
}

ByteSink::~ByteSink() {
    if (descriptor_ >= 0 && descriptor_ != STDOUT_FILENO && !file_) ::close(descriptor_);
}

void ByteSink::write(std::string_view bytes) {
    static const bool to_terminal = ::isatty(STDOUT_FILENO) == 1;
    if (to_terminal && descriptor_ == STDOUT_FILENO) Progress::current().step_aside();
    if (!file_)  // somebody may be waiting for it
        write_fully(descriptor_, {bytes, {}}, path_ == "-" ? "standard output" : path_);
    else
        write_pages(bytes);
}

// The page cache takes large aligned pieces best: each is few of its own units, and none is touched twice.
void ByteSink::write_pages(std::string_view bytes) {
    const std::size_t whole = (waiting_.size() + bytes.size()) / page_group * page_group;
    if (whole > 0) {
        const std::size_t of_bytes = whole - waiting_.size();
        write_fully(descriptor_, {waiting_, bytes.substr(0, of_bytes)}, path_);
        written_ += whole;
        waiting_.clear();
        bytes.remove_prefix(of_bytes);
    }
    waiting_ += bytes;
}

void ByteSink::write_waiting() {
    write_fully(descriptor_, {waiting_, {}}, path_);
    written_ += waiting_.size();
    waiting_.clear();
}

void ByteSink::expect(std::uint64_t bytes) {
    if (!file_ || bytes < least_reserved) return;
#if defined(FALLOC_FL_KEEP_SIZE)
    if (::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) == 0) reserved_ = bytes;
#endif
}

void ByteSink::rewrite(std::size_t offset, std::string_view bytes) {
    write_waiting();
    while (!bytes.empty()) {
        const ssize_t done = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) raise<FileError>("{}: cannot write: {}", path_, system_reason());
        bytes.remove_prefix(static_cast<std::size_t>(done));
        offset += static_cast<std::size_t>(done);
    }
}

void ByteSink::finish() {
    if (!file_) {
        close_special();
        return;
    }
    write_waiting();
    if (reserved_ > written_ && ::ftruncate(descriptor_, static_cast<off_t>(written_)) != 0)
        raise<FileError>("{}: cannot write: {}", path_, system_reason());
    file_->take_place(target_, overwrite_.allowed, overwrite_.synced);
}

// What a device or a pipe has to say against the bytes, it says when it is closed.
void ByteSink::close_special() {
    if (descriptor_ == STDOUT_FILENO || descriptor_ < 0) return;
    const int special = descriptor_;
    descriptor_ = -1;
    if (::close(special) != 0) raise<FileError>("{}: cannot write: {}", path_, system_reason());
}

void write_all(const std::string& path, std::string_view bytes, ByteSink::Overwrite overwrite) {
    ByteSink sink(path, overwrite);
    sink.write(bytes);
    sink.finish();
}

}  // namespace ripplenotch
