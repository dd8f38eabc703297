// SPDX-License-Identifier: MIT
#include "core/files/byte_source.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <functional>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "core/files/byte_sink.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"

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

namespace {

/// By name, with the descriptors of their bytes.
std::map<std::string, int>& held_files() {
    static std::map<std::string, int> all;
    return all;
}

void write_to(int descriptor, std::string_view bytes, const std::function<void()>& refuse) {
    while (!bytes.empty()) {
        const ssize_t taken = ::write(descriptor, bytes.data(), bytes.size());
        if (taken < 0 && errno != EINTR) refuse();
        if (taken > 0) bytes.remove_prefix(static_cast<std::size_t>(taken));
    }
}

}  // namespace

HeldFile::HeldFile(std::string name, std::string_view bytes) : name_(std::move(name)) {
    const auto refuse = [this] {
        raise<FileError>("{}: cannot be held in memory: {}", name_, system_reason());
    };
    descriptor_ = ::memfd_create("ripplenotch", MFD_CLOEXEC);
    if (descriptor_ < 0) refuse();
    write_to(descriptor_, bytes, refuse);
    held_files()[name_] = descriptor_;
    forget_input(name_);
}

HeldFile::~HeldFile() {
    held_files().erase(name_);
    forget_input(name_);
    ::close(descriptor_);
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
    const auto held = held_files().find(path);
    descriptor_ = held != held_files().end() ? ::fcntl(held->second, F_DUPFD_CLOEXEC, 0)
                                             : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
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

namespace {

constexpr std::size_t piece_size = std::size_t{1} << 20;

void copy_to(ByteSource& source, int descriptor, const std::string& folder) {
    std::vector<char> piece(piece_size);
    const auto refuse = [&] {
        raise<FileError>("{}: cannot keep {} for a second pass: {}; TMPDIR=FOLDER names another place",
                         folder, source.name(), system_reason());
    };
    while (const std::size_t size = source.read(piece.data(), piece.size()))
        write_to(descriptor, {piece.data(), size}, refuse);
}

/// Standard input as it was read first, which no second reading would give.
struct KeptInput {
    std::string name;
    std::shared_ptr<const OpenFile> file;
};
KeptInput& kept_standard_input() {
    static KeptInput kept;
    return kept;
}

}  // namespace

Spool::Spool(const std::string& path) : path_(path) {
    if (path == "-" && kept_standard_input().file) {
        name_ = kept_standard_input().name;
        file_ = kept_standard_input().file;
        return;
    }
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
        if (path == "-") kept_standard_input() = {name_, file_};
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

std::string input_name(const std::string& path) {
    return path == "-" ? "standard input" : visible_text(path);
}

ByteSource::ByteSource(const std::string& path) : ByteSource(std::make_shared<const OpenFile>(path)) {}

ByteSource::ByteSource(std::shared_ptr<const OpenFile> file) : ByteSource(file, input_name(file->path())) {
    if (to_be_hashed(*file_, name_)) hash_ = std::make_unique<Sha256>();
}

ByteSource::ByteSource(std::shared_ptr<const OpenFile> file, std::string name)
    : name_(std::move(name)), file_(std::move(file)) {
    const FileState& state = file_->state();
    at_ = static_cast<std::uint64_t>(file_->begin());
    if (file_->by_place() && state.size > 0) size_ = static_cast<std::uint64_t>(state.size);
    Progress::current().begin("reading", "B", size_);
}

ByteSource::ByteSource(std::string name, std::shared_ptr<const std::string> bytes, std::size_t piece_size)
    : name_(std::move(name)), bytes_(std::move(bytes)), piece_size_(piece_size), size_(bytes_->size()) {}

ByteSource::ByteSource(Name name) : name_(std::move(name.name)) {}

ByteSource::~ByteSource() = default;

std::size_t ByteSource::read(char* into, std::size_t size) {
    if (bytes_) {
        const std::size_t taken = bytes_->copy(into, std::min(size, piece_size_), at_);
        at_ += taken;
        return taken;
    }
    while (true) {
        const int from = file_->descriptor();
        const ssize_t got =
            file_->by_place() ? ::pread(from, into, size, static_cast<off_t>(at_)) : ::read(from, into, size);
        if (got > 0) {
            take({into, static_cast<std::size_t>(got)});
            return static_cast<std::size_t>(got);
        }
        if (got == 0) {
            if (size > 0) end();
            return 0;
        }
        if (errno != EINTR) raise<FileError>("{}: cannot read: {}", name_, system_reason());
    }
}

void ByteSource::take(std::string_view bytes) {
    at_ += bytes.size();
    if (hash_) hash_->update(bytes);
    Progress::current().add(bytes.size());
}

void ByteSource::end() {
    if (std::exchange(ended_, true)) return;
    file_->require_unchanged(static_cast<off_t>(at_), name_);
    if (hash_) note_hash(*file_, hash_->hex());
}

bool ByteSource::by_place() const { return file_ != nullptr && file_->by_place(); }

int ByteSource::descriptor_by_place() {
    if (hash_) note_hash(*file_, "");
    hash_.reset();
    return file_->descriptor();
}

void ByteSource::require_unchanged() const { file_->require_unchanged(file_->state().size, name_); }

std::string read_all(const std::string& path) {
    ByteSource source(path);
    std::string bytes;
    std::size_t have = 0, got = 1;
    for (std::size_t room = std::size_t{1} << 14; got > 0; room = 2 * have) {
        if (bytes.size() < room) bytes.resize(room);
        got = source.read(bytes.data() + have, bytes.size() - have);
        have += got;
    }
    bytes.resize(have);
    return bytes;
}

namespace {

struct Read {
    FileState state;  ///< when it was first opened
    std::string sha256;
    bool by_place = false;  ///< read here and there: hashed when somebody asks
};

std::atomic<bool> watched = false, hashed = false;
std::mutex mutex;
std::map<std::string, Read>& inputs() {
    static std::map<std::string, Read> all;
    return all;
}

std::string known_hash(const std::string& path) {
    const std::lock_guard lock(mutex);
    const auto found = inputs().find(path);
    return found == inputs().end() ? "" : found->second.sha256;
}

}  // namespace

void watch_inputs(bool wanted) {
    watched = wanted;
    if (!wanted) hashed = false;
    const std::lock_guard lock(mutex);
    if (!wanted) inputs().clear();
}

void forget_input(const std::string& path) {
    const std::lock_guard lock(mutex);
    inputs().erase(path);
}

void hash_inputs(bool wanted) { hashed = watched && wanted; }

bool to_be_hashed(const OpenFile& file, std::string_view name) {
    // What comes through standard input is gone when the run ends: no artifact tells its hash.
    if (!watched || file.path() == "-") return false;
    const std::lock_guard lock(mutex);
    const Read& known = inputs().try_emplace(file.path(), Read{file.state(), {}}).first->second;
    if (file.state().regular && !known.state.same_bytes(file.state()))
        raise<FileError>(
            "{}: the file is another than when it was read a moment ago; wait until nothing writes to it, or "
            "read a copy",
            name);
    return known.sha256.empty() && !known.by_place && hashed;
}

void note_hash(const OpenFile& file, const std::string& sha256) {
    const std::lock_guard lock(mutex);
    Read& read = inputs().try_emplace(file.path(), Read{file.state(), {}}).first->second;
    if (read.sha256.empty()) read.sha256 = sha256;
    read.by_place = sha256.empty();
}

std::string sha256_as_read(const std::string& path) {
    if (watched && !hashed) return "";
    const std::string known = known_hash(path);
    return known.empty() ? sha256_of_file(path) : known;
}

}  // namespace ripplenotch
