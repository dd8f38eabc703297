// SPDX-License-Identifier: MIT
#pragma once
// Lists of numbers on the command line, "1,2" or "25Hz,50Hz", and the ways in which people write them
// instead.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

// Help that names what can be chosen takes the names from the list of records that they are chosen from.

/// "csv, npy": the names of a registry's entries, in its order.
template <class Entry>
[[nodiscard]] std::string name_list(std::span<const Entry* const> entries) {
    return joined(entries, ", ", &Entry::name);
}

// Words of command lines that people paste.

/// The word as a shell takes it: as it is where it is plain, else in single quotes.
[[nodiscard]] std::string shell_quoted(const std::string& word);

// Which files a run reads and which it writes: those that collide are refused before anything is done.

class FileClaims {
  public:
    /// A file, or a specification with files in it ("switching,table=table.json"): each value of a key may be
    /// one. `as`: "LOG", "--method".
    void reads(std::string_view text, std::string_view as);
    /// Pipes ("-") and what is no file (/dev/null, a folder) collide with nothing.
    void writes(std::string_view path, std::string_view as);
    /// Throws UsageError where one file is written twice, or written and read.
    void check() const;

  private:
    struct Claim {
        std::string path, as;
    };
    std::vector<Claim> read_, written_;
};

/// Throws UsageError with the list as it should be when `text` is one with other marks: "1 2", "1:2", "1, 2".
void refuse_other_marks(const std::string& option, const std::string& text, Dimension dimension);

/// The same for "--orders 1 2" among the words of a command line, whose second number would be taken for the
/// name of a log. A file of that name is one.
void refuse_split_list(const std::vector<std::string>& words, const std::string& option, Dimension dimension);

}  // namespace ripplenotch
