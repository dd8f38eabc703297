// SPDX-License-Identifier: MIT
#include "export/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>

#include "export/targets.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
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

// printf's %a, by our own hand: fmt's form of it depends on its version, and 10 writes 0 as 0x0p-1022.
std::string hexadecimal(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const std::uint64_t fraction = bits & 0xF'FFFF'FFFF'FFFFU;
    const int exponent = static_cast<int>(bits >> 52U & 0x7FFU);
    const bool normal = exponent != 0;
    const int power = normal ? exponent - 1023 : fraction == 0 ? 0 : -1022;
    std::string digits = fmt::format(".{:013x}", fraction);
    digits.erase(digits.find_last_not_of("0.") + 1);
    return fmt::format("{}0x{:d}{}p{:+d}", std::signbit(value) ? "-" : "", normal, digits, power);
}

std::string hexadecimal_float(double value) {
    return hexadecimal(static_cast<double>(static_cast<float>(value))) + "f";
}

std::string describe(const ExportSection& section) {
    if (!section.notch) return fmt::format("low-pass section at {:.6g} Hz", section.center.value());
    std::string text = section.order ? fmt::format("order {}, ", shortest(section.order->value())) : "";
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

void check_identifier(std::string_view name, std::string_view what) {
    const auto allowed = [](char c) { return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0; };
    const bool good = !name.empty() && std::isdigit(static_cast<unsigned char>(name.front())) == 0 &&
                      std::all_of(name.begin(), name.end(), allowed);
    if (!good)
        raise<UsageError>("{}: '{}' is no name; use letters, digits and _, no digit first", what, name);
}

std::string upper_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

const ExportBand& only_band(const FilterSet& filters, std::string_view target) {
    if (filters.by_speed()) {
        raise<UsageError>(
            "target {} holds one filter for all speeds, and this table has {}; choose a band with --band, "
            "for "
            "example --band {}, or a target that switches: {}",
            target,
            filters.bands.size() == 1 ? "a band of speed" : fmt::format("{} bands", filters.bands.size()),
            filters.bands.back().number, fmt::join(targets_that(&Target::switches), ", "));
    }
    return filters.bands.front();
}

}  // namespace ripplenotch
