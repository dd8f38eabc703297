// SPDX-License-Identifier: MIT
#include "cli/design/speed_bands.hpp"

#include <fmt/format.h>

#include <string>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

// The unit that a number was written with. An exponent belongs to the number: "1e3" has none.
std::string_view unit_of(std::string_view text) {
    std::size_t end = text.size();
    while (end > 0 && (text[end - 1] < '0' || text[end - 1] > '9') && text[end - 1] != '.') --end;
    while (end < text.size() && text[end] == ' ') ++end;
    return text.substr(end);
}

std::vector<DegPerSec> parse_speeds(std::string_view text, std::string_view what) {
    const auto pieces = split(text, ':');
    const std::string_view last_unit = unit_of(pieces.back());
    std::size_t bare = 0;
    for (const auto piece : pieces) bare += unit_of(piece).empty() ? 1 : 0;
    // "0.3rad/s:3:0.3" is a trap: read as deg/s, the bare numbers would be fifty times too small.
    if (bare != 0 && bare != pieces.size() && (last_unit.empty() || bare != pieces.size() - 1)) {
        raise<UsageError>(
            "{}: '{}' mixes numbers with and without a unit; give each its unit, or only the last", what,
            text);
    }
    std::vector<DegPerSec> speeds;
    for (const auto piece : pieces) {
        const std::string with_unit =
            unit_of(piece).empty() ? fmt::format("{}{}", piece, last_unit) : std::string(piece);
        speeds.emplace_back(parse_quantity(with_unit, Dimension::speed, what));
    }
    return speeds;
}

}  // namespace

SpeedRange parse_speed_range(std::string_view text, std::string_view what) {
    const auto speeds = parse_speeds(text, what);
    if (speeds.size() != 2 && speeds.size() != 3) {
        raise<UsageError>("{}: '{}' is not FROM:TO:WIDTH, for example 18:180:18 (deg/s)", what, text);
    }
    SpeedRange range{speeds[0], speeds[1], std::nullopt};
    if (speeds.size() == 3) range.width = speeds[2];
    return range;
}

std::vector<std::pair<DegPerSec, DegPerSec>> parse_speed_bands(std::string_view text, std::string_view what) {
    std::vector<std::pair<DegPerSec, DegPerSec>> bands;
    for (const auto piece : split(text, ',')) {
        const auto speeds = parse_speeds(piece, what);
        if (speeds.size() != 2) {
            raise<UsageError>("{}: '{}' is not FROM:TO; a list reads 18:36,36:60,60:100 (deg/s)", what,
                              piece);
        }
        bands.emplace_back(speeds[0], speeds[1]);
    }
    return bands;
}

}  // namespace ripplenotch
