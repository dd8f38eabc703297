// SPDX-License-Identifier: MIT
#pragma once
// The one way in which methods and motions are written: "name,key=value,key=value". Keys are described by
// data, so that parsing, checking, help and documentation come from the same table.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

enum class KeyKind { number, list, text };

/// One key of a specification. Aggregate, so that tables read as data:
/// {.name = "cutoff", .kind = KeyKind::number, .dimension = Dimension::frequency, .help = "..."}
struct Key {
    std::string_view name;
    KeyKind kind = KeyKind::number;  ///< does not matter where there are choices
    Dimension dimension = Dimension::none;
    std::string_view default_text = {};  ///< as the user would write it; empty: no default
    bool required = false;
    std::string_view choices = {};  ///< of a choice: "df1 df2t"
    double above = -1e300;          ///< numbers and list entries must be > above ...
    double at_least = -1e300;       ///< ... and >= at_least ...
    double at_most = 1e300;         ///< ... and <= at_most, in the base unit
    bool whole = false;             ///< numbers and list entries must be whole numbers
    std::string_view help = {};
};

/// A specification as it was typed: name and raw key=value pairs in order.
struct Spec {
    std::string name;
    std::vector<std::pair<std::string, std::string>> values;
    [[nodiscard]] std::string text() const;  ///< canonical form, as it would be typed again
};

/// The pieces between separators: "a::b" by ':' are "a", "" and "b", and "" is one empty piece.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);

/// Splits "name,key=value,..."; throws UsageError on an empty name, a piece without '=', or a repeated key.
[[nodiscard]] Spec parse_spec(std::string_view text);

/// A specification checked against its keys. Throws UsageError, naming `what` ("method lowpass"), the key,
/// the value, and what is allowed: unknown key (with the nearest known one), missing required key, wrong
/// unit, out of range.
class Settings {
  public:
    Settings(std::string_view what, const Spec& spec, std::span<const Key> keys);

    [[nodiscard]] bool has(std::string_view key) const;                  ///< given or defaulted
    [[nodiscard]] double number(std::string_view key) const;             ///< in the base unit
    [[nodiscard]] std::vector<double> list(std::string_view key) const;  ///< "25Hz:50Hz" -> {25, 50}
    [[nodiscard]] std::string text(std::string_view key) const;          ///< of a choice or a text

  private:
    std::map<std::string, std::string, std::less<>> texts_;
    std::map<std::string, std::vector<double>, std::less<>> numbers_;
    std::string what_;
};

/// The entry of `known` nearest to `text` by edit distance, when close enough to be a likely typing error.
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view text,
                                                      std::span<const std::string> known);

/// " (did you mean lowpass?)" where `nearest_name` has an answer, else nothing: to be put behind the wrong
/// name. A name of removed_names.def is answered with " any more; instead: <what to use now>".
[[nodiscard]] std::string did_you_mean(std::string_view text, std::span<const std::string> known);

/// Throws the UsageError of find_entry.
[[noreturn]] void raise_no_entry(std::string_view kind, std::string_view plural, std::string_view name,
                                 std::span<const std::string> known);

/// The entry of a registry that has this name. Throws UsageError "there is no <kind> 'x' (did you mean y?);
/// <plural>: ..." where none has.
template <class Entry>
[[nodiscard]] const Entry& find_entry(std::span<const Entry* const> entries, std::string_view kind,
                                      std::string_view plural, std::string_view name) {
    std::vector<std::string> known;
    for (const Entry* entry : entries) {
        if (entry->name == name) return *entry;
        known.emplace_back(entry->name);
    }
    raise_no_entry(kind, plural, name, known);
}

}  // namespace ripplenotch
