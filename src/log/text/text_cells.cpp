// SPDX-License-Identifier: MIT
#include "log/text/text_cells.hpp"

namespace ripplenotch {
namespace {

bool is_delimiter(char c, char delimiter) { return delimiter == ' ' ? is_blank(c) : c == delimiter; }

// Blanks around a cell belong to nobody, unless they are the delimiter.
bool is_padding(char c, char delimiter) { return is_blank(c) && !is_delimiter(c, delimiter); }

}  // namespace

void split_cells(std::string_view line, char delimiter, CellSplit& into) {
    into.cells.clear();
    into.unclosed = false;
    const std::size_t size = line.size();
    const bool runs = delimiter == ' ';
    std::size_t at = 0;
    if (runs) {
        while (at < size && is_blank(line[at])) ++at;
        if (at == size) return;
    }
    while (true) {
        while (at < size && is_padding(line[at], delimiter)) ++at;
        Cell cell{at, at, false};
        if (at < size && line[at] == '"') {
            cell = {at + 1, at + 1, true};
            std::size_t close = at + 1;
            while (close < size && (line[close] != '"' || (close + 1 < size && line[close + 1] == '"'))) {
                close += line[close] == '"' ? 2 : 1;
            }
            if (close >= size) into.unclosed = true;
            cell.end = close < size ? close : size;
            at = close < size ? close + 1 : size;
            // Anything between the closing quote and the delimiter makes the cell unreadable as a number.
            const std::size_t after = at;
            while (at < size && !is_delimiter(line[at], delimiter)) ++at;
            std::size_t end = at;
            while (end > after && is_padding(line[end - 1], delimiter)) --end;
            if (end > after) cell = {cell.begin - 1, end, false};
        } else {
            while (at < size && !is_delimiter(line[at], delimiter)) ++at;
            cell.end = at;
            while (cell.end > cell.begin && is_padding(line[cell.end - 1], delimiter)) --cell.end;
        }
        into.cells.push_back(cell);
        if (runs) {
            while (at < size && is_blank(line[at])) ++at;
            if (at == size) return;
        } else {
            if (at == size) return;
            ++at;
        }
    }
}

std::string cell_text(std::string_view line, const Cell& cell) {
    std::string text(cell.of(line));
    if (!cell.quoted) return text;
    for (std::size_t at = text.find("\"\""); at != std::string::npos; at = text.find("\"\"", at + 1))
        text.erase(at, 1);
    return text;
}

bool is_blank_line(std::string_view line) {
    for (const char c : line) {
        if (!is_blank(c) && c != '\r') return false;
    }
    return true;
}

bool is_comment_line(std::string_view line) {
    std::size_t at = 0;
    while (at < line.size() && is_blank(line[at])) ++at;
    const std::string_view rest = line.substr(at);
    return !rest.empty() && (rest[0] == '#' || rest[0] == '%' || rest.substr(0, 2) == "//");
}

bool is_no_row(std::string_view line) {
    return is_blank_line(line) || is_comment_line(line) || line == "EOF";
}

}  // namespace ripplenotch
