// SPDX-License-Identifier: MIT
#include "log/text/text_lines.hpp"

#include <algorithm>
#include <utility>

#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t shortest_usual_line = 16, most_usual_lines = 4000;  // for room to begin with
constexpr std::string_view utf8_mark = "\xef\xbb\xbf";

void refuse_binary(std::string_view bytes, const ByteSource& source) {
    if (bytes.empty())
        raise<DataError>("{}: read an empty file, expected rows of numbers; check what wrote it",
                         source.name());
    const std::string_view two = bytes.substr(0, 2);
    if (two == "\xff\xfe" || two == "\xfe\xff") {
        raise<DataError>(
            "{}:1:1: read UTF-16 text, expected UTF-8; convert it, e.g. with iconv -f UTF-16 -t UTF-8",
            source.name());
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (!is_control(bytes[i])) continue;
        const auto byte = static_cast<unsigned char>(bytes[i]);
        const TextPlace place = place_of(bytes, i, '\n');
        raise<DataError>(
            "{}:{}:{}: read the byte 0x{:02x}, expected text; this is not a text log, say which format it "
            "has with --format, or export it as CSV",
            source.name(), source.number_in_file(place.line), place.column, byte);
    }
}

// Complete lines; the last, unfinished one counts only when the file ends there.
std::vector<TextLine> lines_of(std::string_view bytes, bool whole, char line_end, std::size_t from) {
    std::vector<TextLine> lines;
    lines.reserve(std::min(bytes.size() / shortest_usual_line, most_usual_lines));
    std::size_t number = 1;
    for (std::size_t begin = from; begin < bytes.size(); ++number) {
        const std::size_t at = bytes.find(line_end, begin);
        if (at == std::string_view::npos && !whole) break;
        TextLine line{begin, at == std::string_view::npos ? bytes.size() : at, 0, number};
        line.next = at == std::string_view::npos ? bytes.size() : at + 1;
        if (line.end > line.begin && bytes[line.end - 1] == '\r') --line.end;
        lines.push_back(line);
        begin = line.next;
    }
    return lines;
}

// No control character, least of all a line's end, and nothing that a number or a name may have.
bool may_separate(char c) { return std::string_view(",;\t |").find(c) != std::string_view::npos; }

// "sep=;" or "sep=\t"
std::optional<char> stated_delimiter(std::string_view line) {
    if (line.size() > 1 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
    const std::string_view value =
        line.substr(0, 4) == "sep=" || line.substr(0, 4) == "SEP=" ? line.substr(4) : "";
    if (value == "\\t") return '\t';
    return value.size() == 1 && may_separate(value.front()) ? std::optional<char>(value.front())
                                                            : std::nullopt;
}

}  // namespace

TextLines opening_lines(std::string_view bytes, bool whole, const ByteSource& source,
                        std::size_t skip_lines) {
    refuse_binary(bytes, source);
    const std::size_t start = bytes.substr(0, 3) == utf8_mark ? 3 : 0;
    TextLines opening;
    const bool line_feeds = bytes.find('\n') != std::string_view::npos;
    opening.line_end = !line_feeds && bytes.find('\r') != std::string_view::npos ? '\r' : '\n';
    std::vector<TextLine> lines = lines_of(bytes, whole, opening.line_end, start);
    if (!whole && bytes.size() - (lines.empty() ? start : lines.back().next) > longest_line) {
        raise<DataError>(
            "{}:{}: read a line of more than 1 MiB, expected rows of numbers; check that this is a text log",
            source.name(), source.number_in_file(lines.size() + 1));
    }
    std::size_t kept = 0;
    for (const TextLine& line : lines) {
        if (line.number <= skip_lines || is_blank_line(line.of(bytes))) continue;
        if (kept == 0 && !opening.delimiter) {
            opening.delimiter = stated_delimiter(line.of(bytes));
            if (opening.delimiter) continue;
        }
        if (!is_comment_line(line.of(bytes))) {
            lines[kept++] = line;
        } else if (kept == 0) {
            opening.comments.push_back(line);
        }
    }
    lines.resize(kept);
    opening.content = std::move(lines);
    if (opening.content.empty()) {
        raise<DataError>("{}: read {} without a row of numbers, expected rows; check what wrote it",
                         source.name(), whole ? "a file" : "the first 64 kB");
    }
    return opening;
}

}  // namespace ripplenotch
