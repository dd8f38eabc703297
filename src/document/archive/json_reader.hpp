// SPDX-License-Identifier: MIT
#pragma once
// Reads the fields of a document strictly: a missing, a mistyped and an unknown field is a DataError that
// names source and path.

#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "document/archive/archive.hpp"

namespace ripplenotch {

/// A value as a message names it: short, whatever it is.
[[nodiscard]] std::string in_words(const Json& value);

/// One object of a document. What is asked for by name must be there and of its kind, but for `find`, for
/// what may be empty (std::optional) and for what its marks say otherwise.
class JsonReader {
  public:
    static constexpr bool reading = true;

    JsonReader(const Json& object, std::string source, std::string path);

    template <class Value, class... Marks>
    void operator()(std::string_view name, Value& value, const Marks&... marks) {
        if constexpr (marked<IfThere, Marks...> || marked<IfAny, Marks...> || marked<NullIfEmpty, Marks...>)
            if (!has(name)) return;
        read(name, value, marks...);
    }

    template <class... Marks>
    void operator()(std::string_view name, std::tuple<double&, double&> ends, const Marks&... marks) {
        read(name, ends, marks...);
    }

    template <class ValueOf, class... Marks>
    void derived(std::string_view name, const ValueOf& /*of the writer*/, const Marks&... /*as well*/) {
        ignore({name});
    }

    template <class Describe>
    void group(std::string_view name, const Describe& describe_group) {
        JsonReader inner = object(name);
        describe_group(inner);
        inner.finish();
    }

    template <class Entry, class Describe, class... Marks>
    void each(std::string_view name, std::vector<Entry>& list, const Describe& describe_entry,
              const Marks&... marks) {
        if constexpr (marked<IfThere, Marks...> || marked<IfAny, Marks...>)
            if (!has(name)) return;
        list.clear();
        each(
            name, [&](JsonReader& entry) { describe_entry(entry, list.emplace_back()); },
            mark_among(AtMost{max_entries}, marks...).entries);
    }

    template <class Value, class... Marks>
    bool known(std::string_view name, bool /*of the writer*/, Value&& value, const Marks&... marks) {
        if (!has(name)) return false;
        read(name, value, marks...);
        return true;
    }

    [[nodiscard]] bool holds(std::string_view name, bool /*of the writer*/) { return has(name); }

    // The same one at a time, for what is not described but worked out.

    [[nodiscard]] const Json& at(std::string_view name);
    [[nodiscard]] const Json* find(std::string_view name);  ///< nullptr where it is absent or null
    [[nodiscard]] bool has(std::string_view name) { return find(name) != nullptr; }
    [[nodiscard]] double number(std::string_view name);
    [[nodiscard]] std::size_t whole(std::string_view name);  ///< 0 to 1e15
    [[nodiscard]] std::string text(std::string_view name);
    /// `unknown`: null is read as nan.
    [[nodiscard]] std::vector<double> numbers(std::string_view name, bool unknown = false);
    [[nodiscard]] const Json& list(std::string_view name, std::size_t most = max_json_values);
    /// The object of this name; its finish() is the caller's.
    [[nodiscard]] JsonReader object(std::string_view name);
    /// Calls read(JsonReader&) with each object of a list of at most so many, and finishes each.
    template <class Read>
    void each(std::string_view name, const Read& read_entry, std::size_t most = max_entries) {
        const Json& objects = list(name, most);
        for (std::size_t i = 0; i < objects.size(); ++i) {
            JsonReader entry(objects[i], source_, path_of(fmt::format("{}[{}]", name, i)));
            read_entry(entry);
            entry.finish();
        }
    }
    void ignore(std::initializer_list<std::string_view> names);    ///< known, not used
    [[nodiscard]] std::vector<std::string> not_asked_for() const;  ///< names so far
    void finish() const;  ///< throws on fields that no description has read
    [[nodiscard]] std::string where(std::string_view name) const;  ///< "table.json: bands[2].q"
    [[nodiscard]] std::string place() const { return fmt::format("{}: {}", source_, path_); }
    [[nodiscard]] const std::string& source() const { return source_; }

  private:
    template <class Value, class... Marks>
    void read(std::string_view name, Value& value, const Marks&... marks) {
        if constexpr (is_a<Value, std::optional>) {
            value.reset();
            if (has(name)) read(name, value.emplace(), marks...);
        } else if constexpr (std::is_same_v<Value, double>) {
            if (mark_among(Rounded{}, marks...).unknown && !has(name)) {
                value = std::numeric_limits<double>::quiet_NaN();
                return;
            }
            value = number(name) / mark_among(Times{}, marks...).factor;
            if constexpr (marked<Limits, Marks...>) check(name, value, marks...);
        } else if constexpr (is_a<Value, Quantity>) {
            double number = 0.0;
            read(name, number, marks...);
            value = Value(number);
        } else if constexpr (std::is_same_v<Value, bool>) {
            value = flag(name);
        } else if constexpr (std::is_integral_v<Value>) {
            const std::size_t number = whole(name);
            if constexpr (marked<Limits, Marks...>) check(name, static_cast<double>(number), marks...);
            value = static_cast<Value>(number);
        } else if constexpr (std::is_enum_v<Value>) {
            value = named(name, mark_among(Names<Value>{}, marks...));
        } else if constexpr (std::is_same_v<Value, std::string>) {
            value = text(name);
            if constexpr (marked<AtMost, Marks...>) check_bytes(name, value, mark_among(AtMost{}, marks...));
        } else if constexpr (HasEnds<Value>) {
            ends_of(value) = two_numbers(at(name), where(name) + " is", marked<LowerFirst, Marks...>);
        } else if constexpr (is_array_of_numbers<Value>) {
            read_array(name, value);
        } else if constexpr (is_a<Value, std::vector>) {
            read_list(name, value, marks...);
        } else {
            group(name, [&](JsonReader& inner) { describe(inner, value); });
        }
    }

    template <class Entry, class... Marks>
    void read_list(std::string_view name, std::vector<Entry>& values, const Marks&... marks) {
        const AtMost most = mark_among(AtMost{max_json_values}, marks...);
        if constexpr (std::is_same_v<Entry, double>) {
            values = numbers(name, mark_among(Rounded{}, marks...).unknown);
        } else if constexpr (is_a<Entry, Quantity>) {
            static_cast<void>(list(name, most.entries));
            values.clear();
            for (const double value : numbers(name)) values.emplace_back(value);
        } else if constexpr (std::is_same_v<Entry, std::string>) {
            values = texts(name);
        } else if constexpr (std::is_integral_v<Entry>) {
            values = whole_numbers(name, mark_among(Limits{}, marks...));
        } else if constexpr (HasEnds<Entry>) {
            values.clear();
            for (const Json& entry : list(name, most.entries))
                ends_of(values.emplace_back()) =
                    two_numbers(entry, where(name) + " holds", marked<LowerFirst, Marks...>);
        } else {
            each(
                name, values, [](JsonReader& entry, Entry& value) { describe(entry, value); }, marks...);
        }
    }

    template <class Enum>
    Enum named(std::string_view name, const Names<Enum>& names) {
        const std::string word = text(name);
        std::string known;
        for (int i = 0; i <= static_cast<int>(names.last); ++i) {
            const std::string_view one = names.name_of(static_cast<Enum>(i));
            if (one == word) return static_cast<Enum>(i);
            known += fmt::format("{}{}", known.empty() ? "" : ", ", one);
        }
        refuse_name(name, word, known);
    }

    template <class... Marks>
    void check(std::string_view name, double value, const Marks&... marks) const {
        const Limits limits = mark_among(Limits{}, marks...);
        if (!limits.hold(value)) refuse_number(name, value, limits);
    }

    void check_bytes(std::string_view name, std::string_view value, const AtMost& most) const;
    void read_array(std::string_view name, std::span<double> values);
    [[nodiscard]] bool flag(std::string_view name);
    [[nodiscard]] std::vector<std::string> texts(std::string_view name);
    [[nodiscard]] std::vector<int> whole_numbers(std::string_view name, const Limits& limits);
    /// `what`: "table.json: range is", with which the message begins.
    static std::pair<double, double> two_numbers(const Json& value, const std::string& what, bool rising);
    [[nodiscard]] std::string path_of(std::string_view name) const;
    [[noreturn]] void refuse_name(std::string_view name, const std::string& word,
                                  const std::string& known) const;
    [[noreturn]] void refuse_number(std::string_view name, double value, const Limits& limits) const;

    const Json& object_;
    std::string source_, path_;
    std::vector<std::string> seen_;
};

}  // namespace ripplenotch
