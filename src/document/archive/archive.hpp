// SPDX-License-Identifier: MIT
#pragma once
// What the two archives of documents have in common: a document is described once, by describe(archive,
// value), and a JsonWriter writes it while a JsonReader reads it back.
//
//     template <class Archive>
//     void describe(auto& archive, Is<Hum> auto& hum) {
//         archive("from_hz", hum.from_hz);
//         archive("peak_hz", hum.peak_hz, above_zero);
//     }
//
// A value is `const` for the writer and not for the reader. What only one of the two does stands in an
// `if constexpr (Archive::reading)`. What is only ever written is described to a JsonWriter.

#include <array>
#include <concepts>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

/// `Value` is a T, const or not: the archive decides which.
template <class Value, class T>
concept Is = std::same_as<std::remove_const_t<Value>, T>;

template <class Value, template <class...> class Template>
constexpr bool is_a = false;
template <template <class...> class Template, class... Parts>
constexpr bool is_a<Template<Parts...>, Template> = true;

template <class Value>
constexpr bool is_array_of_numbers = false;
template <std::size_t size>
constexpr bool is_array_of_numbers<std::array<double, size>> = true;

// Options of a field, after its name and value. Each is for the archive that can do something with
// it; the other passes over it.

/// Older files do not have it: then the value stays what it is. It is always written.
constexpr struct IfThere {
} if_there;

/// Left out where it is empty, zero or false, and then the value stays what it is.
constexpr struct IfAny {
} if_any;

/// Null where the text or list is empty.
constexpr struct NullIfEmpty {
} null_if_empty;

/// Of two numbers the lower one comes first.
constexpr struct LowerFirst {
} lower_first;

/// A list has so many entries at most, a text so many bytes.
struct AtMost {
    std::size_t entries = 0;
};

/// Which numbers are let in. `above`: the least itself is not. `or_null`: a message says that null is, too.
struct Limits {
    double least = 0.0, most = std::numeric_limits<double>::infinity();
    bool above = false, or_null = false;

    [[nodiscard]] bool hold(double value) const {
        return (above ? value > least : value >= least) && value <= most;
    }
};
constexpr Limits above_zero{.above = true}, above_zero_or_null{.above = true, .or_null = true};
constexpr Limits above_zero_up_to(double most) { return {.most = most, .above = true}; }

/// The document has the value times this, such as milliseconds of seconds.
struct Times {
    double factor = 1.0;
};
constexpr Times in_ms{1e3}, in_percent{100.0};

/// Written rounded, since what follows is noise. `unknown`: what is not finite is null, and read as nan.
struct Rounded {
    Json (*json_of)(double) = finite_or_null;
    bool unknown = false;
};
constexpr Rounded fitted{[](double value) { return finite_or_null(to_digits(value)); }};
constexpr Rounded six{[](double value) { return six_digits(value); }};

/// Written in steps that suit the largest of its kind: below them is only how a processor rounds.
struct StepsOf {
    double largest = 0.0;
};

/// The names of an enumeration whose first enumerator is 0: name_of each up to `last`.
template <class Enum>
struct Names {
    std::string_view (*name_of)(Enum) = nullptr;
    Enum last = {};
};

template <class Mark, class... Marks>
constexpr bool marked = (std::is_same_v<Mark, Marks> || ...);

/// The mark of this type among them, or another.
template <class Mark, class... Marks>
[[nodiscard]] Mark mark_among(Mark otherwise, const Marks&... marks) {
    (([&] {
         if constexpr (std::is_same_v<Mark, Marks>) otherwise = marks;
     }()),
     ...);
    return otherwise;
}

// What is written as a list of two numbers: std::tie of two members, and every type for which there is an
// ends_of.

template <class Number>
auto ends_of(const std::tuple<Number&, Number&>& ends) {
    return ends;
}
auto ends_of(Is<Interval> auto& interval) { return std::tie(interval.low, interval.high); }

template <class Value>
concept HasEnds = requires(Value& value) {
    ends_of(value);
};

}  // namespace ripplenotch
