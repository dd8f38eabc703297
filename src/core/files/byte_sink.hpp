// SPDX-License-Identifier: MIT
#pragma once
#include <fcntl.h>
#include <sys/stat.h>

#include <memory>
#include <optional>
#include <string>

namespace ripplenotch {

// Internal: files under temporary names, which a signal that ends the process must not leave behind.

/// While it lives, `path` is one of them.
class UnfinishedFile {
  public:
    explicit UnfinishedFile(const std::string& path);
    ~UnfinishedFile();
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;

    struct Place;

  private:
    std::string path_;
    Place* place_;
};

/// At once, for a process that ends without its destructors. May be called by a signal handler.
void remove_unfinished_files() noexcept;

/// For programs: every signal that ends the process and can be caught removes these files first, and then
/// ends it as it always does. One that is ignored (nohup) stays so. A file that outgrows its limit (SIGXFSZ)
/// ends no process, but fails to be written, with the system's reason.
void remove_unfinished_files_on_signals();

// Internal: every file that the tool makes begins here, under no name, or under a random one where the file
// system has no files without names.

class TemporaryFile {
  public:
    /// For reading and writing, in the folder of `path`. With the rights, the owner and the group of
    /// `replaced`, if there is one: as far as the system lets the user give them, and no right to anybody who
    /// had none. Throws FileError.
    TemporaryFile(const std::string& path, const std::optional<struct stat>& replaced);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    [[nodiscard]] int descriptor() const { return descriptor_; }
    /// A random name in the folder of `path`, so that a library can open the file by it: nobody else may.
    /// forget_name() and the destructor take it away again. Throws FileError.
    [[nodiscard]] const std::string& name_for_a_moment(const std::string& path);
    void forget_name();
    /// A name that surely nobody sees keeps: the file goes with its last descriptor.
    [[nodiscard]] int release_without_name();
    /// Closes the file and gives it its name, in the folder that it was made in: not before its bytes are on
    /// the disk, and its name is when this returns, but where RIPPLENOTCH_SYNC is none in the environment.
    /// Throws FileError; nothing is left then.
    void take_place(const std::string& path, bool overwrite);

  private:
    [[nodiscard]] bool open_without_name(const std::string& folder, mode_t mode);
    void open_with_name(const std::string& path, mode_t mode);
    void keep_rights(const struct stat& replaced);
    void close(const std::string& path);
    [[nodiscard]] std::string linked(const std::string& to) const;
    [[nodiscard]] std::string named_beside(const std::string& path);
    [[nodiscard]] std::string in_free_place(const std::string& path);
    [[nodiscard]] std::string over(const std::string& path);

    int descriptor_ = -1;
    std::string name_;  ///< empty while it has none
    std::unique_ptr<UnfinishedFile> unfinished_;
};

/// Where temporary files go: TMPDIR, else the system's. Throws FileError.
[[nodiscard]] std::string temporary_folder();

// Internal: the tool within another program, whose standard output is not ours.

/// From now on what goes to "-" is added to `text`; with null it goes to standard output again.
void capture_output(std::string* text) noexcept;

// Internal: room in pipes.

/// A pipe holds 64 KiB: who writes and who reads it take turns every few microseconds. No more than the
/// system lets everybody have; where it does not, all goes on as it is.
inline void widen_pipe(int descriptor) {
#if defined(F_SETPIPE_SZ)
    static_cast<void>(::fcntl(descriptor, F_SETPIPE_SZ, 1 << 20));
#else
    static_cast<void>(descriptor);
#endif
}

}  // namespace ripplenotch
