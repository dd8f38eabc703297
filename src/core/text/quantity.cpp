// SPDX-License-Identifier: MIT
#include "ripplenotch/core/quantity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cctype>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {
namespace {

struct Unit {
    Dimension dimension;
    std::string_view name;
    double factor;
};

constexpr double pi = std::numbers::pi;
constexpr double kgf = 9.80665, lbf = 0.45359237 * kgf, inch = 0.0254;  // by definition, in N and m

// The first unit of a dimension is its base unit. A turn of the joint is 360 deg; a frequency in rad/s is
// angular.
constexpr std::array units = {
    Unit{Dimension::time, "s", 1.0},
    Unit{Dimension::time, "sec", 1.0},
    Unit{Dimension::time, "ms", 1e-3},
    Unit{Dimension::time, "us", 1e-6},
    Unit{Dimension::time, "ns", 1e-9},
    Unit{Dimension::time, "100ns", 1e-7},
    Unit{Dimension::time, "min", 60.0},
    Unit{Dimension::time, "h", 3600.0},
    Unit{Dimension::time, "d", 86400.0},
    Unit{Dimension::frequency, "Hz", 1.0},
    Unit{Dimension::frequency, "kHz", 1e3},
    Unit{Dimension::frequency, "MHz", 1e6},
    Unit{Dimension::frequency, "mHz", 1e-3},
    Unit{Dimension::frequency, "rad/s", 0.5 / pi},
    Unit{Dimension::angle, "deg", 1.0},
    Unit{Dimension::angle, "rad", degrees_per_radian},
    Unit{Dimension::angle, "mrad", degrees_per_radian * 1e-3},
    Unit{Dimension::angle, "rev", 360.0},
    Unit{Dimension::angle, "turn", 360.0},
    Unit{Dimension::speed, "deg/s", 1.0},
    Unit{Dimension::speed, "dps", 1.0},
    Unit{Dimension::speed, "rad/s", degrees_per_radian},
    Unit{Dimension::speed, "mrad/s", degrees_per_radian * 1e-3},
    Unit{Dimension::speed, "rpm", 6.0},
    Unit{Dimension::speed, "rev/s", 360.0},
    Unit{Dimension::speed, "deg/min", 1.0 / 60.0},
    Unit{Dimension::speed, "rad/min", degrees_per_radian / 60.0},
    Unit{Dimension::speed, "Hz", 360.0},
    Unit{Dimension::torque, "Nm", 1.0},
    Unit{Dimension::torque, "N*m", 1.0},
    Unit{Dimension::torque, "N.m", 1.0},
    Unit{Dimension::torque, "N m", 1.0},
    Unit{Dimension::torque, "mNm", 1e-3},
    Unit{Dimension::torque, "uNm", 1e-6},
    Unit{Dimension::torque, "cNm", 1e-2},
    Unit{Dimension::torque, "kNm", 1e3},
    Unit{Dimension::torque, "Nmm", 1e-3},
    Unit{Dimension::torque, "Ncm", 1e-2},
    Unit{Dimension::torque, "kgf.m", kgf},
    Unit{Dimension::torque, "kgf.cm", 1e-2 * kgf},
    Unit{Dimension::torque, "gf.cm", 1e-5 * kgf},
    Unit{Dimension::torque, "lbf.ft", lbf * 12.0 * inch},
    Unit{Dimension::torque, "lbf.in", lbf* inch},
    Unit{Dimension::torque, "ozf.in", lbf / 16.0 * inch},
    Unit{Dimension::torque_rate, "Nm/s", 1.0},
    Unit{Dimension::torque_rate, "mNm/s", 1e-3},
    Unit{Dimension::inertia, "kgm2", 1.0},
    Unit{Dimension::inertia, "kg*m^2", 1.0},
    Unit{Dimension::inertia, "kg m^2", 1.0},
    Unit{Dimension::decibel, "dB", 1.0},
    Unit{Dimension::current, "A", 1.0},
    Unit{Dimension::current, "mA", 1e-3},
    Unit{Dimension::length, "m", 1.0},
    Unit{Dimension::length, "cm", 1e-2},
    Unit{Dimension::length, "mm", 1e-3},
    Unit{Dimension::length, "um", 1e-6},
    Unit{Dimension::linear_speed, "m/s", 1.0},
    Unit{Dimension::linear_speed, "mm/s", 1e-3},
    Unit{Dimension::linear_speed, "m/min", 1.0 / 60.0},
    Unit{Dimension::linear_speed, "mm/min", 1e-3 / 60.0},
    Unit{Dimension::force, "N", 1.0},
    Unit{Dimension::force, "mN", 1e-3},
    Unit{Dimension::force, "kN", 1e3},
};

bool same_unit(std::string_view written, std::string_view known) {
    if (written.size() != known.size()) return false;
    for (std::size_t i = 0; i < known.size(); ++i) {
        if (written[i] != known[i] && !(known[i] == '/' && written[i] == '_')) return false;
    }
    return true;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

// Length of the longest prefix that looks like a decimal number; "1e3" counts, the "e" of "1eV" does not.
std::size_t number_length(std::string_view text) {
    std::size_t i = 0;
    const auto digit = [&](std::size_t k) {
        return k < text.size() && std::isdigit(static_cast<unsigned char>(text[k]));
    };
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
    while (digit(i)) ++i;
    if (i < text.size() && text[i] == '.') ++i;
    while (digit(i)) ++i;
    if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        std::size_t k = i + 1;
        if (k < text.size() && (text[k] == '+' || text[k] == '-')) ++k;
        if (digit(k)) {
            while (digit(k)) ++k;
            i = k;
        }
    }
    return i;
}

}  // namespace

std::string_view base_unit(Dimension dimension) {
    for (const Unit& unit : units) {
        if (unit.dimension == dimension) return unit.name;
    }
    return "";
}

std::vector<std::string_view> unit_names(Dimension dimension) {
    std::vector<std::string_view> names;
    for (const Unit& unit : units) {
        if (unit.dimension == dimension) names.push_back(unit.name);
    }
    return names;
}

std::optional<double> unit_factor(Dimension dimension, std::string_view unit) {
    for (const Unit& known : units) {
        if (known.dimension == dimension && same_unit(unit, known.name)) return known.factor;
    }
    return std::nullopt;
}

double parse_quantity(std::string_view text, Dimension dimension, std::string_view what) {
    const std::string_view whole = trimmed(text);
    const std::size_t length = number_length(whole);
    const auto number = parse_number(whole.substr(0, length));
    const std::string_view unit = trimmed(whole.substr(length));
    const auto understood = [&] {
        const auto names = unit_names(dimension);
        return names.empty() ? std::string("a plain number")
                             : fmt::format("a number in {}", fmt::join(names, ", "));
    };
    if (!number || !std::isfinite(*number)) {
        raise<UsageError>("{}: cannot read '{}' as a number; write {}", what, text, understood());
    }
    const auto factor = unit.empty() ? std::optional(1.0) : unit_factor(dimension, unit);
    if (!factor) raise<UsageError>("{}: '{}' has the unit '{}'; write {}", what, text, unit, understood());
    const double value = *number * *factor;
    if (!is_reading(value)) {
        raise<UsageError>("{}: '{}' is {} {}; write a number from -{} to {}", what, text, shortest(value),
                          base_unit(dimension), largest_reading, largest_reading);
    }
    return value;
}

}  // namespace ripplenotch
