// SPDX-License-Identifier: MIT
#pragma once
// Internal: files under temporary names, which a signal that ends the process must not leave behind.

#include <string>

namespace ripplenotch {

/// While it lives, `path` is one of them. More than sixty-four at a time are not remembered.
class UnfinishedFile {
  public:
    explicit UnfinishedFile(const std::string& path);
    ~UnfinishedFile();
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  private:
    std::string path_;
    std::size_t slot_;
};

/// For programs: SIGINT, SIGTERM and SIGHUP remove these files before they end the process as they always
/// do. A signal that is ignored (nohup) stays so.
void remove_unfinished_files_on_signals();

}  // namespace ripplenotch
