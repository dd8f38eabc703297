// SPDX-License-Identifier: MIT
#pragma once
// Numbers with a unit, as people write them on a command line or in a log's header: "13rad/s", "1kHz",
// "rad_s".

#include <cmath>
#include <compare>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

// The unit system of the whole tool, stated once: time in seconds, angle in degrees at the joint (output side
// of the gear), speed in degrees per second at the joint, torque in newton-metres, frequency in hertz. Angles
// become radians only inside a sine. "order" means cycles per motor (wave generator) revolution; "output
// order" means cycles per output revolution, so output order = order * gear ratio.
//
// A scalar that could be mistaken for another has one of these types. An array or a JSON field carries its
// unit in its name instead: _s, _hz, _deg, _deg_s, _nm, _db, _ms.

template <class Tag>
class Quantity {
  public:
    constexpr Quantity() = default;
    constexpr explicit Quantity(double value) : value_(value) {}
    [[nodiscard]] constexpr double value() const { return value_; }

    constexpr auto operator<=>(const Quantity&) const = default;
    constexpr Quantity operator-() const { return Quantity(-value_); }
    friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity(a.value_ + b.value_); }
    friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity(a.value_ - b.value_); }
    friend constexpr Quantity operator*(double factor, Quantity a) { return Quantity(factor * a.value_); }
    friend constexpr Quantity operator*(Quantity a, double factor) { return Quantity(factor * a.value_); }
    friend constexpr Quantity operator/(Quantity a, double divisor) { return Quantity(a.value_ / divisor); }
    friend constexpr double operator/(Quantity a, Quantity b) { return a.value_ / b.value_; }

  private:
    double value_ = 0.0;
};

using Seconds = Quantity<struct SecondsTag>;
using Hertz = Quantity<struct HertzTag>;
using Degrees = Quantity<struct DegreesTag>;
using DegPerSec = Quantity<struct DegPerSecTag>;
using NewtonMeters = Quantity<struct NewtonMetersTag>;
using Order = Quantity<struct OrderTag>;          ///< cycles per motor revolution
using GearRatio = Quantity<struct GearRatioTag>;  ///< motor revolutions per output revolution

/// A sample rate that stands beside a frequency: bare, the two could be swapped.
struct SampledAt {
    explicit constexpr SampledAt(Hertz samples) : rate(samples) {}
    Hertz rate;
};

template <class Tag>
[[nodiscard]] inline Quantity<Tag> abs(Quantity<Tag> q) {
    return Quantity<Tag>(std::abs(q.value()));
}

namespace literals {
constexpr Hertz operator""_Hz(long double v) { return Hertz(static_cast<double>(v)); }
constexpr Hertz operator""_Hz(unsigned long long v) { return Hertz(static_cast<double>(v)); }
constexpr DegPerSec operator""_deg_s(long double v) { return DegPerSec(static_cast<double>(v)); }
constexpr DegPerSec operator""_deg_s(unsigned long long v) { return DegPerSec(static_cast<double>(v)); }
constexpr Seconds operator""_s(long double v) { return Seconds(static_cast<double>(v)); }
constexpr Seconds operator""_s(unsigned long long v) { return Seconds(static_cast<double>(v)); }
}  // namespace literals

/// Ripple frequency of one order at one joint speed: f = n * Kg * |v| / 360 (Kim, Kim, Song 2011, eq. 1 and
/// 3).
[[nodiscard]] inline Hertz ripple_frequency(Order order, GearRatio ratio, DegPerSec speed) {
    return Hertz(order.value() * ratio.value() * std::abs(speed.value()) / 360.0);
}

inline constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

/// Joint speeds from the slowest to the fastest.
struct SpeedSpan {
    DegPerSec from, to;
};

/// What a number measures. Each dimension has one unit inside the tool (see units.hpp), named by base_unit().
enum class Dimension {
    none,          ///< a plain number
    time,          ///< s
    frequency,     ///< Hz; rad/s is read as an angular frequency
    angle,         ///< deg
    speed,         ///< deg/s; rpm and Hz are turns of the joint
    torque,        ///< Nm
    torque_rate,   ///< Nm/s
    inertia,       ///< kg m^2
    decibel,       ///< dB
    current,       ///< A
    length,        ///< m
    linear_speed,  ///< m/s
    force,         ///< N
};

[[nodiscard]] std::string_view base_unit(Dimension dimension);

/// Unit names that a dimension understands, the base unit first; for error messages and help.
[[nodiscard]] std::vector<std::string_view> unit_names(Dimension dimension);

/// Factor that turns a value in `unit` into the base unit, e.g. (speed, "rad/s") -> 57.29...; empty when the
/// unit does not belong to the dimension. Exact case, because mHz and MHz differ; "rad_s" and "rad/s" are the
/// same.
[[nodiscard]] std::optional<double> unit_factor(Dimension dimension, std::string_view unit);

/// Reads "12.5", "12.5Hz", "12.5 Hz" into the base unit; a bare number is already in the base unit.
/// Throws UsageError that names `what`, the text, and the units understood. Refuses nan and inf.
[[nodiscard]] double parse_quantity(std::string_view text, Dimension dimension, std::string_view what);

}  // namespace ripplenotch
