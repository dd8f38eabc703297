// SPDX-License-Identifier: MIT
#include "core/files/byte_sink.hpp"

#include <fmt/format.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <utility>

#include "core/files/byte_source.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"

// Sanitizers have handlers of signals of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RIPPLENOTCH_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RIPPLENOTCH_SANITIZED 1
#endif
#endif

namespace ripplenotch {

// What a signal handler may touch: atomics without locks, and unlink(). Places are made and never freed, so
// that a handler on another thread can walk along them at any time.
struct UnfinishedFile::Place {
    std::atomic<const char*> path = nullptr;
    Place* next = nullptr;
};

namespace {

using Place = UnfinishedFile::Place;
static_assert(std::atomic<const char*>::is_always_lock_free && std::atomic<Place*>::is_always_lock_free);
std::atomic<Place*> newest = nullptr;

Place* claim_place(const char* path) {
    for (Place* place = newest; place != nullptr; place = place->next) {
        const char* free = nullptr;
        if (place->path.compare_exchange_strong(free, path)) return place;
    }
    auto* const place = new Place;
    place->path = path;
    place->next = newest;
    while (!newest.compare_exchange_weak(place->next, place)) {
    }
    return place;
}

void remove_and_end(int signal) {
    remove_unfinished_files();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

// All that end a process unless somebody says otherwise. A sanitizer wants to report the faults itself.
constexpr int ending_signals[] = {
    SIGHUP,    SIGINT,  SIGQUIT, SIGPIPE, SIGALRM, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGVTALRM, SIGPROF,
#if defined(SIGPOLL)
    SIGPOLL,
#endif
#if defined(SIGPWR)
    SIGPWR,
#endif
#if defined(SIGSTKFLT)
    SIGSTKFLT,
#endif
#if !defined(RIPPLENOTCH_SANITIZED)
    SIGILL,    SIGTRAP, SIGABRT, SIGBUS,  SIGFPE,  SIGSEGV, SIGSYS,
#endif
};

void remove_on(int signal) {
    if (std::signal(signal, remove_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

void remove_unfinished_files() noexcept {
    for (const Place* place = newest; place != nullptr; place = place->next) {
        if (const char* const name = place->path.load()) ::unlink(name);
    }
}

UnfinishedFile::UnfinishedFile(const std::string& path) : path_(path), place_(claim_place(path_.c_str())) {}

UnfinishedFile::~UnfinishedFile() { place_->path = nullptr; }

void remove_unfinished_files_on_signals() {
    for (const int signal : ending_signals) remove_on(signal);
#if defined(SIGRTMIN)
    for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) remove_on(signal);
#endif
#if defined(SIGXFSZ)
    std::signal(SIGXFSZ, SIG_IGN);
#endif
}

namespace {

constexpr mode_t rights = 0777, of_owner = 0600, of_everybody = 0666;
constexpr std::size_t longest_name = 255 - 20;  // of most file systems, less what is added
constexpr int max_tries = 100;

// The folder that a path is in: "." where it names none.
std::string folder_of(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

bool exists(const std::string& path) { return ::access(path.c_str(), F_OK) == 0; }

// Process numbers repeat, in containers at every start; what a killed run left must be in nobody's way.
std::string random_name(const std::string& path) {
    std::random_device random;
    const std::string name = std::filesystem::path(path).filename().string();
    const std::string shown = name.size() > longest_name ? "ripplenotch" : name;
    return fmt::format("{}/{}.part-{:08x}{:08x}", folder_of(path), shown, random(), random());
}

std::string by_descriptor(int descriptor) { return fmt::format("/proc/self/fd/{}", descriptor); }

// Where a file system cannot do it (EINVAL of special ones), there is nothing to wait for.
bool synced_to_disk(int descriptor) {
    return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP;
}

void sync_folder(const std::string& path) {
    const int folder = ::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;  // one may write into a folder that one may not read
    const bool done = synced_to_disk(folder);
    const std::string why = system_reason();
    ::close(folder);
    if (!done)
        raise<FileError>("{}: is in place, but its folder could not be written to the disk: {}", path, why);
}

}  // namespace

std::string temporary_folder() {
    std::error_code failed;
    std::string folder = std::filesystem::temp_directory_path(failed).string();
    if (failed)
        raise<FileError>("no folder for temporary files: {}; TMPDIR=FOLDER names one", failed.message());
    return folder;
}

TemporaryFile::TemporaryFile(const std::string& path, const std::optional<struct stat>& replaced) {
    const mode_t mode = replaced ? of_owner : of_everybody;
    if (!open_without_name(folder_of(path), mode)) open_with_name(path, mode);
    if (replaced) keep_rights(*replaced);
}

TemporaryFile::~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!name_.empty()) ::unlink(name_.c_str());
}

// Its name is made of the descriptor's in the end, so there has to be one.
bool TemporaryFile::open_without_name(const std::string& folder, mode_t mode) {
#if defined(O_TMPFILE)
    descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
    if (descriptor_ >= 0 && exists(by_descriptor(descriptor_))) return true;
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
#else
    static_cast<void>(folder);
    static_cast<void>(mode);
#endif
    return false;
}

void TemporaryFile::open_with_name(const std::string& path, mode_t mode) {
    for (int tries = 0; descriptor_ < 0; ++tries) {
        name_ = random_name(path);
        unfinished_ =
            std::make_unique<UnfinishedFile>(name_);  // before it is there: a signal may come at once
        descriptor_ = ::open(name_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (descriptor_ >= 0 || (errno == EEXIST && tries < max_tries)) continue;
        const std::string why = system_reason();
        unfinished_.reset();
        name_.clear();
        raise<FileError>("{}: cannot write: {}", path, why);
    }
}

// Without the old group its rights would be another group's.
void TemporaryFile::keep_rights(const struct stat& replaced) {
    struct stat own {};
    mode_t mode = replaced.st_mode & rights;
    const bool known = ::fstat(descriptor_, &own) == 0;
    if (!known || own.st_uid != replaced.st_uid)
        static_cast<void>(!::fchown(descriptor_, replaced.st_uid, static_cast<gid_t>(-1)));
    if ((!known || own.st_gid != replaced.st_gid) &&
        ::fchown(descriptor_, static_cast<uid_t>(-1), replaced.st_gid) != 0)
        mode &= ~static_cast<mode_t>(S_IRWXG);
    static_cast<void>(::fchmod(descriptor_, mode));
}

const std::string& TemporaryFile::name_for_a_moment(const std::string& path) {
    static_cast<void>(::fchmod(descriptor_, of_owner));
    if (const std::string why = named_beside(path); !why.empty())
        raise<FileError>("{}: cannot name a temporary file: {}", folder_of(path), why);
    return name_;
}

void TemporaryFile::forget_name() {
    if (!name_.empty()) ::unlink(name_.c_str());
    unfinished_.reset();
    name_.clear();
}

int TemporaryFile::release_without_name() {
    forget_name();
    return std::exchange(descriptor_, -1);
}

std::string TemporaryFile::linked(const std::string& to) const {
    const int done = name_.empty() ? ::linkat(AT_FDCWD, by_descriptor(descriptor_).c_str(), AT_FDCWD,
                                              to.c_str(), AT_SYMLINK_FOLLOW)
                                   : ::link(name_.c_str(), to.c_str());
    return done == 0 ? "" : system_reason();
}

// A nameless file cannot be renamed.
std::string TemporaryFile::named_beside(const std::string& path) {
    std::string why;
    for (int tries = 0; name_.empty() && tries < max_tries; ++tries) {
        const std::string name = random_name(path);
        unfinished_ = std::make_unique<UnfinishedFile>(name);
        why = linked(name);
        if (why.empty())
            name_ = name;
        else if (errno != EEXIST)
            break;
    }
    return why;
}

// A new name for the file, then the old one goes: link() refuses to replace what somebody else made in the
// meantime. File systems without links get the small race instead.
std::string TemporaryFile::in_free_place(const std::string& path) {
    std::string why = linked(path);
    if (why.empty()) {
        if (!name_.empty()) ::unlink(name_.c_str());
        return "";
    }
    const bool without_links = errno == EPERM || errno == EOPNOTSUPP || errno == ENOSYS || errno == EMLINK;
    if (name_.empty() || !without_links) return why;
    return exists(path) ? "it exists already" : over(path);
}

std::string TemporaryFile::over(const std::string& path) {
    if (std::string why = named_beside(path); !why.empty()) return why;
    return ::rename(name_.c_str(), path.c_str()) == 0 ? "" : system_reason();
}

void TemporaryFile::close(const std::string& path) {
    if (::close(std::exchange(descriptor_, -1)) != 0)
        raise<FileError>("{}: cannot write: {}", path, system_reason());
}

void TemporaryFile::take_place(const std::string& path, bool overwrite) {
    const char* const asked = std::getenv("RIPPLENOTCH_SYNC");
    const bool synced = asked == nullptr || std::string_view(asked) != "none";
    if (synced && !synced_to_disk(descriptor_))
        raise<FileError>("{}: cannot write to the disk: {}", path, system_reason());
    // Where writing is put off until the file is closed (NFS), that is the last moment to hear of a failure.
    const int probe = ::dup(descriptor_);
    if (probe >= 0 && ::close(probe) != 0) raise<FileError>("{}: cannot write: {}", path, system_reason());
    const std::string why = overwrite ? over(path) : in_free_place(path);
    if (!why.empty()) raise<FileError>("{}: cannot put the finished file in place: {}", path, why);
    unfinished_.reset();
    name_.clear();
    close(path);
    if (synced) sync_folder(path);
}

namespace {

std::string* captured = nullptr;  ///< capture_output

constexpr std::size_t page_group = std::size_t{1} << 16;
constexpr std::uint64_t min_reserved = std::uint64_t{4} << 20;  // what is written in a few pieces needs none

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
        if (captured != nullptr) return;
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

void capture_output(std::string* text) noexcept { captured = text; }

void ByteSink::write(std::string_view bytes) {
    if (captured != nullptr && descriptor_ == STDOUT_FILENO) {
        *captured += bytes;
        return;
    }
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
    if (!file_ || bytes < min_reserved) return;
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
    file_->take_place(target_, overwrite_.allowed);
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
