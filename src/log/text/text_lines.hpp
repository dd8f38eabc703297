// SPDX-License-Identifier: MIT
#pragma once
// The opening of a text log as lines: comments apart from content, what is no text refused.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

struct TextLine {
    std::size_t begin = 0, end = 0;  ///< content, without line end
    std::size_t next = 0;            ///< offset of the next line
    std::size_t number = 1;
    [[nodiscard]] std::string_view of(std::string_view bytes) const {
        return bytes.substr(begin, end - begin);
    }
};

struct TextLines {
    char line_end = '\n';            ///< '\r' for files of old Macintoshes
    std::vector<TextLine> comments;  ///< before the first content
    std::vector<TextLine> content;   ///< neither blank nor comment; never empty
    std::optional<char> delimiter;   ///< from a first line "sep=;", as Excel writes and reads it
};

/// `bytes` is the opening of a file, all of it when `whole`; its first `skip_lines` lines count for nothing.
/// Throws DataError that begins with `source`: for an empty file, bytes that no text has, UTF-16, a line
/// longer than longest_line, nothing but comments.
[[nodiscard]] TextLines opening_lines(std::string_view bytes, bool whole, const ByteSource& source,
                                      std::size_t skip_lines = 0);

}  // namespace ripplenotch
