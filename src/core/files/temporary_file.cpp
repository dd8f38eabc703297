// SPDX-License-Identifier: MIT
#include "core/files/temporary_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <random>
#include <utility>

#include "core/files/open_file.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr mode_t rights = 0777, of_owner = 0600, of_everybody = 0666;
constexpr std::size_t longest_name = 255 - 20;  // of most file systems, less what is added
constexpr int most_tries = 100;

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

std::string folder_of(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

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
        if (descriptor_ >= 0 || (errno == EEXIST && tries < most_tries)) continue;
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
    for (int tries = 0; name_.empty() && tries < most_tries; ++tries) {
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

void TemporaryFile::take_place(const std::string& path, bool overwrite, bool synced) {
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

}  // namespace ripplenotch
