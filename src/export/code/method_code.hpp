// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "export/text.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"
#include "runtime_text.hpp"

namespace ripplenotch {

// A header is tables, and one of the runtimes in design/runtime as it stands but for its prefix: the tool
// runs the same C over the tables that it reads back.

/// How a header is written. Its text is composed with the runtimes' prefix, rn_ and RN_.
struct CodeStyle {
    std::string name;
    bool is_float = true;

    [[nodiscard]] Precision precision() const { return is_float ? Precision::float32 : Precision::float64; }
    /// How a number is written, so that the compiler reads the same bits.
    [[nodiscard]] auto literal() const { return is_float ? decimal_float : decimal; }
    [[nodiscard]] std::string number(double value) const { return literal()(value); }
    /// A whole header: its origin, its guard, and between them its kind of numbers and `body`, filled in.
    [[nodiscard]] std::string header(std::span<const std::string> heading, std::string_view body) const;

    /// "static const rn_real rn_what[3] = {...};"
    [[nodiscard]] std::string array(std::string_view what, const std::vector<double>& values) const;
    /// "static const rn_constants rn_values = {...};"
    [[nodiscard]] std::string constants(std::span<const double> values) const;
    /// With the prefix of this header, and without what only the tool needs.
    [[nodiscard]] std::string filled(std::string_view code) const;
    /// The numbers of constants().
    [[nodiscard]] std::vector<double> read_constants(TextReader& reader, std::size_t count) const;
    /// The numbers of an array().
    [[nodiscard]] std::vector<double> read(TextReader& reader, std::string_view what,
                                           std::size_t count) const;
};

/// By the keys name and precision. Throws UsageError.
[[nodiscard]] CodeStyle style_of(const Settings& settings);

/// A runtime with these tables behind its types.
[[nodiscard]] std::string with_tables(std::string_view runtime, const std::string& tables);

}  // namespace ripplenotch
