// SPDX-License-Identifier: MIT
#pragma once
// Which files a run reads and which it writes: those that collide are refused before anything is done.

#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

class FileClaims {
  public:
    /// A file, or a specification with files in it ("switching,table=table.json"): each value of a key may be
    /// one. `as`: "LOG", "--table".
    void reads(std::string_view text, std::string_view as);
    /// Pipes ("-") and what is no file (/dev/null, a folder) collide with nothing.
    void writes(std::string_view path, std::string_view as);
    /// Throws UsageError where one file is written twice, or written and read. `remedy` follows the words
    /// "name another file".
    void check(std::string_view remedy = "") const;

  private:
    struct Claim {
        std::string path, as;
    };
    std::vector<Claim> read_, written_;
};

}  // namespace ripplenotch
