// SPDX-License-Identifier: MIT
#include "log/text/text_cells.hpp"

#include <algorithm>
#include <utility>

#include "log/columns/units.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// The minus sign as typesetters write it.
constexpr std::string_view long_minus = "\xe2\x88\x92";

/// Takes the text of a number off the front, as parse_number() reads it: without separators of thousands.
std::string take_number(std::string_view& rest, char decimal_mark, std::size_t& groups) {
    std::string plain;
    const auto take_sign = [&] {
        const std::size_t size = rest.starts_with(long_minus) ? long_minus.size()
                                 : !rest.empty() && (rest.front() == '-' || rest.front() == '+') ? 1
                                                                                                 : 0;
        if (size > 0) plain += rest.front() == '+' ? '+' : '-';
        rest.remove_prefix(size);
    };
    const auto digit_at = [&](std::size_t at) { return at < rest.size() && is_digit(rest[at]); };
    take_sign();
    char separator = '\0';
    for (bool marked = false; !rest.empty(); rest.remove_prefix(1)) {
        const char c = rest.front();
        const bool thousands = !marked && c != decimal_mark && std::string_view(",.' ").find(c) < 4 &&
                               (separator == '\0' || separator == c) && !plain.empty() &&
                               is_digit(plain.back()) && digit_at(1) && digit_at(2) && digit_at(3) &&
                               !digit_at(4);
        if (thousands) {
            separator = c;
            ++groups;
        } else if (c == decimal_mark && !marked) {
            marked = true;
            groups += groups > 0 ? 1 : 0;
            plain += '.';
        } else if (is_digit(c)) {
            plain += c;
        } else {
            break;
        }
    }
    if (rest.empty() || std::string_view("eEdD").find(rest.front()) > 3) return plain;
    const std::size_t sign = rest.substr(1).starts_with(long_minus)                  ? long_minus.size()
                             : rest.size() > 1 && (rest[1] == '-' || rest[1] == '+') ? 1
                                                                                     : 0;
    if (!digit_at(1 + sign)) return plain;
    rest.remove_prefix(1);
    plain += 'e';
    take_sign();
    for (; digit_at(0); rest.remove_prefix(1)) plain += rest.front();
    return plain;
}

// Bytes that are no UTF-8 are Latin-1: a degree sign, a micro sign, an umlaut.
std::string as_utf8(const std::string& text) {
    std::string converted;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const std::size_t more = byte < 0xC2 ? 0 : byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : byte < 0xF5 ? 3 : 0;
        bool whole = byte < 0x80 || more > 0;
        for (std::size_t k = 1; whole && k <= more; ++k)
            whole = i + k < text.size() && (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
        if (whole) {
            converted += text.substr(i, more + 1);
            i += more;
        } else {
            converted += static_cast<char>(0xC0 | (byte >> 6));
            converted += static_cast<char>(0x80 | (byte & 0x3F));
        }
    }
    return converted;
}

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

std::vector<std::string> cell_texts(std::string_view line, char delimiter) {
    CellSplit split;
    split_cells(line, delimiter, split);
    std::vector<std::string> texts;
    for (const Cell& cell : split.cells) {
        std::string text(cell.of(line));
        for (std::size_t at = text.find("\"\""); cell.quoted && at != std::string::npos;
             at = text.find("\"\"", at + 1))
            text.erase(at, 1);
        texts.push_back(as_utf8(text));
    }
    return texts;
}

std::optional<std::vector<double>> list_in(std::string_view cell) {
    const bool square = cell.starts_with('[') && cell.ends_with(']');
    if (cell.size() < 3 || !(square || (cell.starts_with('(') && cell.ends_with(')')))) return std::nullopt;
    std::string_view rest = cell.substr(1, cell.size() - 2);
    std::vector<double> numbers;
    while (true) {
        constexpr std::string_view between = " \t,;";
        rest.remove_prefix(std::min(rest.find_first_not_of(between), rest.size()));
        if (rest.empty()) break;
        const std::size_t end = std::min(rest.find_first_of(between), rest.size());
        const auto number = parse_number(rest.substr(0, end));
        if (!number) return std::nullopt;
        numbers.push_back(*number);
        rest.remove_prefix(end);
    }
    return numbers.empty() ? std::nullopt : std::optional(std::move(numbers));
}

std::optional<CellNumber> cell_number(std::string_view cell, char decimal_mark) {
    if (const auto plain = parse_number(cell, decimal_mark)) return CellNumber{*plain, cell.size(), {}};
    std::string_view rest = cell;
    std::size_t groups = 0;
    const auto number = parse_number(take_number(rest, decimal_mark, groups));
    if (!number || groups == 1) return std::nullopt;  // a decimal mark counts as a second one
    const std::size_t size = cell.size() - rest.size();
    // "6064h" is a name: a unit stands behind a blank, or behind decimals.
    if (!rest.empty() && !is_blank(rest.front()) &&
        cell.substr(0, size).find(decimal_mark) == std::string_view::npos)
        return std::nullopt;
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    // Lines are tried with every separator: what stands behind the first number is mostly the rest of the
    // line.
    if (rest.find_first_of(",;\t") != std::string_view::npos) return std::nullopt;
    if (!rest.empty() && !usual_unit(rest, Role::other) && !is_device_unit(rest)) return std::nullopt;
    return CellNumber{*number, size, rest};
}

std::optional<CellNumber> CellRules::number(std::string_view cell, std::size_t column) const {
    const auto number = cell_number(cell, decimal_mark);
    const bool alike = number && number->unit == (units.empty() ? std::string_view() : units[column]);
    return alike ? number : std::nullopt;
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
