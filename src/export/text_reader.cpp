// SPDX-License-Identifier: MIT
#include "export/text_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

bool in_token(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+' || c == '-' || c == '_';
}

template <class Real>
std::optional<double> read_as(std::string_view digits, std::chars_format format) {
    Real value{};
    const char* const end = digits.data() + digits.size();
    const auto result = std::from_chars(digits.data(), end, value, format);
    if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
    return static_cast<double>(value);
}

std::optional<double> read_number(std::string_view text, Precision precision) {
    const bool negative = !text.empty() && text.front() == '-';
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
    if (text.empty() || text.front() == '-') return std::nullopt;
    const bool hex = text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    if (hex) text.remove_prefix(2);
    // The suffix of a C float; in hexadecimal an f is a digit unless an exponent stands before it.
    const bool suffix = (text.back() == 'f' || text.back() == 'F') &&
                        (!hex || text.find_first_of("pP") != std::string_view::npos);
    if (suffix) text.remove_suffix(1);
    const auto format = hex ? std::chars_format::hex : std::chars_format::general;
    const auto value =
        precision == Precision::float32 ? read_as<float>(text, format) : read_as<double>(text, format);
    if (!value) return std::nullopt;
    return negative ? -*value : *value;
}

}  // namespace

TextReader::TextReader(std::string_view text, std::string source, Comments comments, Precision precision)
    : text_(text), source_(std::move(source)), precision_(precision) {
    blank_comments(comments);
}

void TextReader::blank_comments(Comments comments) {
    if (comments == Comments::none) return;
    const std::string_view open = comments == Comments::c ? "/*" : comments == Comments::percent ? "%" : "#";
    const std::string_view close = comments == Comments::c ? "*/" : "\n";
    for (std::size_t from = 0; (from = text_.find(open, from)) != std::string::npos;) {
        const std::size_t end = std::min(text_.find(close, from), text_.size());
        const std::size_t past = comments == Comments::c ? std::min(end + close.size(), text_.size()) : end;
        std::replace_if(
            text_.begin() + static_cast<std::ptrdiff_t>(from),
            text_.begin() + static_cast<std::ptrdiff_t>(past), [](char c) { return c != '\n'; }, ' ');
        from = past;
    }
}

void TextReader::fail(std::string_view read, std::string_view expected) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    raise<DataError>("{}:{}: read {}, expected {}; write the file again with ripplenotch export", source_,
                     line, read.empty() ? "the end of the file" : fmt::format("'{}'", read), expected);
}

bool TextReader::find(std::string_view marker) {
    const std::size_t found = text_.find(marker, at_);
    if (found == std::string::npos) return false;
    at_ = found + marker.size();
    return true;
}

void TextReader::expect(std::string_view marker) {
    if (!find(marker)) fail(std::string_view(), fmt::format("'{}'", marker));
}

std::string_view TextReader::token() {
    while (at_ < text_.size() && !in_token(text_[at_])) {
        if (std::string_view("{}[]()").find(text_[at_]) != std::string_view::npos) return {};
        ++at_;
    }
    const std::size_t from = at_;
    while (at_ < text_.size() && in_token(text_[at_])) ++at_;
    return std::string_view(text_).substr(from, at_ - from);
}

double TextReader::number() {
    const std::string_view digits = token();
    const auto value = read_number(digits, precision_);
    if (!value) fail(digits, "a number");
    return *value;
}

std::vector<double> TextReader::numbers(char open, char close, std::size_t count) {
    expect(std::string_view(&open, 1));
    std::vector<double> values;
    while (values.size() < count) values.push_back(number());
    const std::string_view more = token();
    if (!more.empty() || at_ >= text_.size() || text_[at_] != close) {
        fail(more.empty() && at_ < text_.size() ? text_.substr(at_, 1) : std::string(more),
             fmt::format("'{}' after {} numbers", close, count));
    }
    ++at_;
    return values;
}

std::string TextReader::word() { return std::string(token()); }

bool TextReader::at_end() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ == text_.size();
}

}  // namespace ripplenotch
