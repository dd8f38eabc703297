// SPDX-License-Identifier: MIT
#pragma once
// Reading the same bytes twice: a file as it is, a pipe by way of a temporary file.

#include <memory>
#include <string>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

class Spool {
  public:
    /// A regular file is opened and stays where it is; standard input ("-"), a named pipe or a device is read
    /// to its end into a file without a name in the folder for temporary files (TMPDIR). Throws FileError.
    explicit Spool(const std::string& path);
    ~Spool();
    Spool(const Spool&) = delete;
    Spool& operator=(const Spool&) = delete;

    /// The bytes from their start, under the name that people gave: those of the file that was opened,
    /// whatever has its name by now.
    [[nodiscard]] std::unique_ptr<ByteSource> open() const;

  private:
    std::string path_, name_;
    std::shared_ptr<const OpenFile> file_;
};

}  // namespace ripplenotch
