// SPDX-License-Identifier: MIT
#include "ripplenotch/core/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

#include "core/unfinished_files.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t first_room = std::size_t{1} << 14;  // for a whole file: most are tables and models

constexpr std::size_t page_group = std::size_t{1} << 16;
constexpr std::uint64_t least_reserved = std::uint64_t{4}
                                         << 20;  // what is written in a few pieces needs none

std::string reason() { return std::strerror(errno); }

bool exists(const std::string& path) { return ::access(path.c_str(), F_OK) == 0; }

// A device or a named pipe is written in place: /dev/null must stay what it is.
bool is_special(const std::string& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

// A pipe holds 64 KiB: who writes and who reads it take turns every few microseconds. No more than the system
// lets everybody have; where it does not, all goes on as it is.
void widen_pipe(int descriptor) {
#if defined(F_SETPIPE_SZ)
    static_cast<void>(::fcntl(descriptor, F_SETPIPE_SZ, 1 << 20));
#else
    static_cast<void>(descriptor);
#endif
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
            raise<FileError>("{}: cannot write: {}", path, reason());
        }
        const auto taken = static_cast<std::size_t>(done), of_first = std::min(taken, parts[0].size());
        parts[0].remove_prefix(of_first);
        parts[1].remove_prefix(taken - of_first);
    }
}

// Both return the reason of a failure, empty when all went well.
std::string put_in_place(const std::string& from, const std::string& to) {
    return ::rename(from.c_str(), to.c_str()) == 0 ? "" : reason();
}

// A new name for the file, then the old one goes: link() refuses to replace what somebody else made in the
// meantime. File systems without links get the small race instead.
std::string put_in_free_place(const std::string& from, const std::string& to) {
    if (::link(from.c_str(), to.c_str()) == 0) {
        ::unlink(from.c_str());
        return "";
    }
    const bool without_links = errno == EPERM || errno == EOPNOTSUPP || errno == ENOSYS || errno == EMLINK;
    if (!without_links) return reason();
    return exists(to) ? "it exists already" : put_in_place(from, to);
}

}  // namespace

ByteSource::ByteSource(const std::string& path) : name_(path == "-" ? "standard input" : path) {
    if (path == "-") {
        descriptor_ = STDIN_FILENO;
        if (::isatty(STDIN_FILENO) == 1) {
            raise<UsageError>(
                "standard input is a terminal; name a file, or pipe one in: cat log.csv | ripplenotch ...");
        }
        widen_pipe(descriptor_);
        Progress::current().begin("reading", "B", 0);
        return;
    }
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0) raise<FileError>("{}: cannot open: {}", path, reason());
    owns_ = true;
    struct stat status {};
    if (::fstat(descriptor_, &status) == 0 && S_ISDIR(status.st_mode)) {
        ::close(descriptor_);
        raise<FileError>("{}: is a directory; name a file in it", path);
    }
    if (S_ISFIFO(status.st_mode)) widen_pipe(descriptor_);
    regular_ = S_ISREG(status.st_mode);
    if (regular_ && status.st_size > 0) size_ = static_cast<std::uint64_t>(status.st_size);
    Progress::current().begin("reading", "B", size_);
}

ByteSource::ByteSource(const std::string& path, std::string name) : ByteSource(path) {
    name_ = std::move(name);
}

ByteSource::ByteSource(std::string name, std::shared_ptr<const std::string> bytes, std::size_t piece_size)
    : name_(std::move(name)), bytes_(std::move(bytes)), piece_size_(piece_size), size_(bytes_->size()) {}

ByteSource::~ByteSource() {
    if (owns_) ::close(descriptor_);
}

std::size_t ByteSource::read(char* into, std::size_t size) {
    if (bytes_) {
        const std::size_t taken = bytes_->copy(into, std::min(size, piece_size_), given_);
        given_ += taken;
        return taken;
    }
    while (true) {
        const ssize_t got = ::read(descriptor_, into, size);
        if (got >= 0) {
            Progress::current().add(static_cast<std::uint64_t>(got));
            return static_cast<std::size_t>(got);
        }
        if (errno != EINTR) raise<FileError>("{}: cannot read: {}", name_, reason());
    }
}

std::string read_all(const std::string& path) {
    ByteSource source(path);
    std::string bytes;
    std::size_t have = 0, got = 1;
    for (std::size_t room = first_room; got > 0; room = 2 * have) {
        if (bytes.size() < room) bytes.resize(room);
        got = source.read(bytes.data() + have, bytes.size() - have);
        have += got;
    }
    bytes.resize(have);
    return bytes;
}

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
    if (is_special(path)) {
        descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
        if (descriptor_ < 0) raise<FileError>("{}: cannot write: {}", path, reason());
        widen_pipe(descriptor_);
        return;
    }
    if (overwrite == Overwrite::no && exists(path)) {
        raise<FileError>("{}: exists already; choose another name or overwrite it with --force", path);
    }
    static std::atomic<unsigned> made = 0;
    temporary_ = fmt::format("{}.part-{}-{}", path, ::getpid(), made++);
    unfinished_ =
        std::make_unique<UnfinishedFile>(temporary_);  // before it is there: a signal may come at once
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
        const std::string why = reason();
        unfinished_.reset();
        temporary_.clear();
        raise<FileError>("{}: cannot write: {}", path, why);
    }
}

ByteSink::~ByteSink() {
    if (descriptor_ >= 0 && descriptor_ != STDOUT_FILENO) ::close(descriptor_);
    if (!finished_ && !temporary_.empty()) ::unlink(temporary_.c_str());
}

void ByteSink::write(std::string_view bytes) {
    static const bool to_terminal = ::isatty(STDOUT_FILENO) == 1;
    if (to_terminal && descriptor_ == STDOUT_FILENO) Progress::current().step_aside();
    if (temporary_.empty())  // somebody may be waiting for it
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
    if (temporary_.empty() || bytes < least_reserved) return;
#if defined(FALLOC_FL_KEEP_SIZE)
    if (::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) == 0) reserved_ = bytes;
#endif
}

void ByteSink::rewrite(std::size_t offset, std::string_view bytes) {
    write_waiting();
    if (::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset)) !=
        static_cast<ssize_t>(bytes.size())) {
        raise<FileError>("{}: cannot write: {}", path_, reason());
    }
}

void ByteSink::finish() {
    if (!temporary_.empty()) write_waiting();
    finished_ = true;
    if (temporary_.empty()) return;
    const bool returned =
        reserved_ <= written_ || ::ftruncate(descriptor_, static_cast<off_t>(written_)) == 0;
    if (::close(descriptor_) != 0 || !returned) {
        descriptor_ = -1;
        ::unlink(temporary_.c_str());
        raise<FileError>("{}: cannot write: {}", path_, reason());
    }
    descriptor_ = -1;
    const std::string why =
        overwrite_ == Overwrite::yes ? put_in_place(temporary_, path_) : put_in_free_place(temporary_, path_);
    if (!why.empty()) {
        ::unlink(temporary_.c_str());
        raise<FileError>("{}: cannot put the finished file in place: {}", path_, why);
    }
}

void write_all(const std::string& path, std::string_view bytes, ByteSink::Overwrite overwrite) {
    ByteSink sink(path, overwrite);
    sink.write(bytes);
    sink.finish();
}

}  // namespace ripplenotch
