// SPDX-License-Identifier: MIT
#include "log/text/row_parser.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "log/text/text_cells.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/reading.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<double, 23> powers_of_ten = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// Reads [-]digits[.digits] with at most 15 digits: mantissa and power of ten are then both exact doubles, so
// one division rounds correctly (W. D. Clinger, How to read floating point numbers accurately, 1990). Null
// when the text is anything else.
const char* read_short_decimal(const char* at, const char* end, char decimal_mark, double& value) {
    const bool negative = at < end && *at == '-';
    if (negative) ++at;
    const char* const first = at;
    std::uint64_t mantissa = 0;
    while (at < end && static_cast<unsigned char>(*at - '0') < 10)
        mantissa = mantissa * 10 + static_cast<std::uint64_t>(*at++ - '0');
    std::ptrdiff_t digits = at - first, decimals = 0;
    if (at < end && *at == decimal_mark) {
        const char* const fraction = ++at;
        while (at < end && static_cast<unsigned char>(*at - '0') < 10)
            mantissa = mantissa * 10 + static_cast<std::uint64_t>(*at++ - '0');
        decimals = at - fraction;
        digits += decimals;
    }
    if (digits == 0 || digits > 15) return nullptr;
    const double magnitude =
        static_cast<double>(mantissa) / powers_of_ten[static_cast<std::size_t>(decimals)];
    value = negative ? -magnitude : magnitude;
    return at;
}

// A cell that nobody reads is passed on as it is, but for what no text has.
bool needs_care(char c) { return c == '"' || is_control(c); }

}  // namespace

bool RowParser::add_stamp(std::string_view text, bool fraction, double& time) const {
    const auto number = fraction ? parse_number(text, rules_.decimal_mark) : read_stamp(text, stamp_);
    if (!number || !is_reading(*number)) return false;
    time += fraction ? seconds_per_nanosecond * *number : *number;
    return true;
}

bool RowParser::parse(const char* at, const char* end, ParsedRow& row) const {
    const bool first_is_read = !wanted_.empty() && wanted_.front().column == 0;
    if (!first_is_read && is_no_row({at, static_cast<std::size_t>(end - at)})) return false;
    const char delimiter = rules_.delimiter;
    const bool runs = delimiter == ' ';
    if (runs) {
        while (at < end && is_blank(*at)) ++at;
        while (end > at && is_blank(end[-1])) --end;
    }
    std::size_t column = 0;
    if (stamp_.careful) row.values[time_slot] = nothing_yet;
    const auto at_cell_end = [&](const char* p) {
        return p == end || *p == delimiter || (runs && *p == '\t');
    };
    for (auto wanted = wanted_.begin();; ++column) {
        if (wanted != wanted_.end() && wanted->column == column) {
            while (!runs && at < end && *at == ' ' && delimiter != '\t') ++at;
            double& value = row.values[wanted->slot];
            ParsedRow::Place place{at, nullptr};
            const bool stamp = stamp_.careful && wanted->slot == time_slot;
            const char* stop = stamp ? nullptr : read_short_decimal(at, end, rules_.decimal_mark, value);
            if (stop == nullptr || !at_cell_end(stop)) {
                stop = at;
                while (!at_cell_end(stop)) ++stop;
                const char* content = stop;
                while (content > at && is_blank(content[-1])) --content;
                const std::string_view text(at, static_cast<std::size_t>(content - at));
                if (stamp) {
                    if (!add_stamp(text, wanted->fraction, value)) return false;
                } else {
                    const auto number = parse_number(text, rules_.decimal_mark);
                    if (!number || !is_reading(*number)) return false;
                    value = *number;
                }
                place.end = content;
            } else {
                place.end = stop;
            }
            if (is_torque(wanted->slot)) row.torques[joint_of(wanted->slot)] = place;
            at = stop;
            ++wanted;
        } else {
            while (!at_cell_end(at)) {
                if (needs_care(*at)) return false;
                ++at;
            }
        }
        if (at == end) break;
        ++at;
        while (runs && at < end && is_blank(*at)) ++at;
    }
    row.content_end = end;
    return column + 1 == columns_;
}

}  // namespace ripplenotch
