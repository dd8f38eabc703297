// SPDX-License-Identifier: MIT
#pragma once
// Internal: files under temporary names, which a signal that ends the process must not leave behind.

#include <string>

namespace ripplenotch {

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

}  // namespace ripplenotch
