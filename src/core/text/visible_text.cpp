// SPDX-License-Identifier: MIT
#include "ripplenotch/core/visible_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace ripplenotch {
namespace {

// The code point at text[at] and its length in bytes; length 0 for what is not UTF-8 (RFC 3629).
struct CodePoint {
    std::uint32_t value;
    std::size_t length;
};

CodePoint code_point_at(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[at + i]); };
    const unsigned char lead = byte(0);
    if (lead < 0x80) return {lead, 1};
    const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || at + length > text.size()) return {lead, 0};
    std::uint32_t value = lead & (0x7FU >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0U) != 0x80) return {lead, 0};
        value = (value << 6U) | (byte(i) & 0x3FU);
    }
    constexpr std::uint32_t lowest[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = value >= 0xD800 && value <= 0xDFFF;
    if (value < lowest[length] || value > 0x10FFFF || surrogate) return {lead, 0};
    return {value, length};
}

// Marks, embeddings and isolates of the bidirectional algorithm, line and paragraph separators, byte order
// mark, and what XML has no place for.
bool acts(std::uint32_t value) {
    return (value >= 0x80 && value < 0xA0) || value == 0x61C || value == 0x200E || value == 0x200F ||
           (value >= 0x2028 && value <= 0x202E) || (value >= 0x2066 && value <= 0x2069) || value == 0xFEFF ||
           (value & 0xFFFEU) == 0xFFFE;
}

std::size_t bytes_of(std::string_view text, std::size_t characters) {
    std::size_t at = 0;
    while (at < text.size() && characters-- > 0)
        at += std::max<std::size_t>(code_point_at(text, at).length, 1);
    return at;
}

// Most texts: nothing to look at twice.
bool is_plain(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x20 && c < 0x7F; });
}

// Without an escape there is no other way to write a line feed between values of JSON.
bool is_space(char c) { return c == '\n' || c == '\t' || c == '\r'; }

std::string json_escape(std::uint32_t value) {
    if (value < 0x10000) return fmt::format("\\u{:04x}", value);
    const std::uint32_t rest = value - 0x10000;
    return fmt::format("\\u{:04x}\\u{:04x}", 0xD800 + (rest >> 10U), 0xDC00 + (rest & 0x3FFU));
}

}  // namespace

std::string visible_json(std::string_view json) {
    if (std::all_of(json.begin(), json.end(), [](char c) { return (c >= 0x20 && c < 0x7F) || is_space(c); }))
        return std::string(json);
    std::string shown;
    shown.reserve(json.size());
    for (std::size_t at = 0; at < json.size();) {
        const auto [value, length] = code_point_at(json, at);
        const bool silent = (value < 0x20 && !is_space(json[at])) || value == 0x7F || acts(value);
        const std::size_t taken = std::max<std::size_t>(length, 1);
        if (length > 0 && silent) {
            shown += json_escape(value);
        } else {
            shown += json.substr(at, taken);
        }
        at += taken;
    }
    return shown;
}

std::string visible_text(std::string_view text) {
    if (is_plain(text)) return std::string(text);
    std::string shown;
    for (std::size_t at = 0; at < text.size();) {
        const auto [value, length] = code_point_at(text, at);
        if (length == 0 || value < 0x20 || value == 0x7F) {
            shown += value == '\n'   ? "\\n"
                     : value == '\t' ? "\\t"
                     : value == '\r' ? "\\r"
                                     : fmt::format("\\x{:02x}", value);
            ++at;
            continue;
        }
        if (acts(value)) {
            shown += fmt::format("\\u{:04x}", value);
        } else {
            shown += text.substr(at, length);
        }
        at += length;
    }
    return shown;
}

std::size_t text_width(std::string_view visible) {
    std::size_t width = 0;
    for (std::size_t at = 0; at < visible.size(); ++width)
        at += std::max<std::size_t>(code_point_at(visible, at).length, 1);
    return width;
}

std::string cut_to(std::string_view visible, std::size_t width) {
    if (bytes_of(visible, width) == visible.size()) return std::string(visible);
    return std::string(visible.substr(0, bytes_of(visible, width > 0 ? width - 1 : 0))) + "…";
}

std::vector<std::string> wrapped(std::string_view visible, std::size_t width) {
    std::vector<std::string> lines;
    while (true) {
        const std::size_t most = bytes_of(visible, width + 1);  // looking no further keeps long texts linear
        if (most == visible.size() && text_width(visible) <= width) break;
        const std::size_t blank = visible.substr(0, most).rfind(' ');
        const bool at_blank = blank != std::string_view::npos && blank > 0;
        const std::size_t end = at_blank ? blank : bytes_of(visible, std::max<std::size_t>(width, 1));
        lines.emplace_back(visible.substr(0, end));
        visible.remove_prefix(at_blank ? end + 1 : end);
    }
    if (!visible.empty() || lines.empty()) lines.emplace_back(visible);
    return lines;
}

}  // namespace ripplenotch
