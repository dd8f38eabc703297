// SPDX-License-Identifier: MIT
#pragma once

#include <sys/stat.h>

#include <string>
#include <string_view>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

// Internal: an open file with what it was when it was opened, for sources that read it and notice when
// somebody else writes to it.

/// The system's words for errno.
[[nodiscard]] std::string system_reason();

/// What tells one state of a file from another.
struct FileState {
    dev_t device = 0;
    ino_t inode = 0;
    off_t size = 0;
    timespec written = {}, touched = {};  ///< its bytes; its bytes, rights, names or times
    bool regular = false;

    /// The state of an open file; all zero where the system does not tell.
    [[nodiscard]] static FileState of(int descriptor);
    [[nodiscard]] bool same_bytes(const FileState& other) const;
};

class OpenFile {
  public:
    /// Opens for reading; "-" is standard input. Throws FileError, and UsageError when "-" is a terminal.
    explicit OpenFile(const std::string& path);
    /// Takes over a file that is complete.
    OpenFile(std::string path, int descriptor);
    ~OpenFile();
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] int descriptor() const { return descriptor_; }
    [[nodiscard]] const FileState& state() const { return state_; }
    /// Can be read at any place, by several at a time.
    [[nodiscard]] bool by_place() const { return owns_ && state_.regular; }
    /// Where reading begins: standard input may have been read by somebody before.
    [[nodiscard]] off_t begin() const { return begin_; }
    /// Where the size of the file is known (not in /proc): throws FileError unless the source ends at `end`
    /// and nothing was written since the file was opened.
    void require_unchanged(off_t end, std::string_view name) const;

  private:
    std::string path_;
    int descriptor_ = -1;
    bool owns_ = true;
    FileState state_;
    off_t begin_ = 0;
};

// Internal: the record of files read, which sources write and sha256_as_read() asks.

/// Whether a source of this file hashes its bytes: as wanted, and not where the hash is known. Throws
/// FileError when the file is not what it was when it was first opened.
[[nodiscard]] bool to_be_hashed(const OpenFile& file, std::string_view name);
/// The file was read to its end; or, with an empty hash, is read at places and hashed when somebody asks.
void note_hash(const OpenFile& file, const std::string& sha256);
/// The file of this name may be another from now on.
void forget_input(const std::string& path);

}  // namespace ripplenotch
