// SPDX-License-Identifier: MIT
#include "export/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "export/target.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

namespace {

bool in_token(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+' || c == '-' || c == '_';
}

template <class Real>
std::optional<double> read_as(std::string_view digits) {
    Real value{};
    const char* const end = digits.data() + digits.size();
    const auto result = std::from_chars(digits.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
    return static_cast<double>(value);
}

std::optional<double> read_number(std::string_view text, Precision precision) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    if (text.empty()) return std::nullopt;
    if (text.back() == 'f' || text.back() == 'F') text.remove_suffix(1);  // of a C float
    return precision == Precision::float32 ? read_as<float>(text) : read_as<double>(text);
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

namespace {

std::string with_point(std::string digits) {
    if (digits.find_first_of(".en") == std::string::npos) digits += ".0";
    return digits;
}

}  // namespace

std::string decimal(double value) { return with_point(shortest(value)); }

std::string decimal_float(double value) {
    return with_point(fmt::format("{:.9g}", static_cast<float>(value))) + "f";
}

std::string describe(const ExportSection& section) {
    if (!section.notch) return fmt::format("low-pass section at {:.6g} Hz", section.center.value());
    std::string text = section.order ? order_in_words(*section.order, section.gear_ratio) + ", " : "";
    text += fmt::format("{} Hz, Q {}", shortest(section.center.value()), shortest(section.notch->q));
    if (section.notch->width == WidthRule::digital) text += " (digital)";
    if (section.notch->depth_db < infinite_depth_db)
        text += fmt::format(", {} dB", shortest(section.notch->depth_db));
    return text;
}

std::string describe(const ExportBand& band) {
    if (band.number == 0) return "one filter";
    return fmt::format("band {}: {} < |v| <= {} deg/s", band.number, shortest(band.from.value()),
                       shortest(band.to.value()));
}

CodeSpeed code_speed(const Settings& settings, double gear_ratio) {
    CodeSpeed speed{settings.text("speed-unit"), settings.text("speed-side"), "", 1.0};
    if (speed.unit == "rad/s") speed.per_deg_s = std::numbers::pi / 180.0;
    if (speed.unit == "rpm") speed.per_deg_s = 1.0 / 6.0;
    const bool motor = speed.side == "motor";
    if (motor && gear_ratio == no_ratio.value())
        raise<UsageError>("target c-header: speed-side=motor takes a gear ratio, and none is known");
    if (motor) speed.per_deg_s *= gear_ratio;
    speed.name = std::string(motor ? "motor_speed_" : "speed_") + (speed.unit == "deg/s"   ? "deg_s"
                                                                   : speed.unit == "rad/s" ? "rad_s"
                                                                                           : "rpm");
    return speed;
}

std::vector<double> edges(const FilterSet& filters, DegPerSec ExportBand::*edge) {
    std::vector<double> values;
    for (const ExportBand& band : filters.bands) values.push_back((band.*edge).value());
    return values;
}

std::string filled(std::string text, const Fields& fields) {
    for (const auto& [field, value] : fields)
        for (std::size_t at = 0; (at = text.find(field, at)) != std::string::npos; at += value.size())
            text.replace(at, field.size(), value);
    return text;
}

std::string comment_lines(std::span<const std::string> lines, std::string_view mark) {
    std::string text;
    for (std::string line : lines) {
        for (char& c : line) {
            if (static_cast<unsigned char>(c) < 0x20) c = ' ';
        }
        for (std::size_t at = 0; (at = line.find("*/", at)) != std::string::npos;) line.replace(at, 2, "* /");
        text += fmt::format("{}{}\n", mark, visible_text(line));
    }
    return text;
}

std::string xml_comment(std::span<const std::string> lines) {
    std::string text = comment_lines(lines, "  ");
    for (std::size_t at = 0; (at = text.find("--", at)) != std::string::npos;) text.replace(at, 2, "- -");
    return "<!--\n" + text + "-->\n";
}

void check_identifier(std::string_view name, std::string_view what) {
    const auto allowed = [](char c) { return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0; };
    const bool good = !name.empty() && std::isdigit(static_cast<unsigned char>(name.front())) == 0 &&
                      std::all_of(name.begin(), name.end(), allowed);
    if (!good)
        raise<UsageError>("{}: '{}' is no name; use letters, digits and _, no digit first", what, name);
}

std::string in_quotes(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e ? '?' : c;
    }
    return out + "\"";
}

std::string upper_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

const ExportBand& only_band(const FilterSet& filters, std::string_view target) {
    if (filters.by_speed()) {
        raise<UsageError>(
            "target {} holds one filter for all speeds, and this table has {}; choose a band with --band, "
            "for example --band {}, or a target that switches: {}",
            target,
            filters.bands.size() == 1 ? "a band of speed" : fmt::format("{} bands", filters.bands.size()),
            filters.bands.back().number, fmt::join(targets_that(&Target::switches), ", "));
    }
    return filters.bands.front();
}

}  // namespace ripplenotch
