// SPDX-License-Identifier: MIT
#pragma once
// Writes the fields of a document in the order in which they are described.

#include <string>
#include <string_view>
#include <utility>

#include "document/archive/archive.hpp"

namespace ripplenotch {

class JsonWriter {
  public:
    static constexpr bool reading = false;

    /// `object` is a JSON object, which the fields are added to.
    explicit JsonWriter(Json& object) : json_(object) {}

    template <class Value, class... Marks>
    void operator()(std::string_view name, const Value& value, const Marks&... marks) {
        if constexpr (marked<IfAny, Marks...>)
            if (is_empty(value)) return;
        put(name, json_of(value, marks...));
    }

    /// What a reader passes over, since it follows from the rest: value() is asked for by the writer alone.
    template <class ValueOf, class... Marks>
    void derived(std::string_view name, const ValueOf& value, const Marks&... marks) {
        (*this)(name, value(), marks...);
    }

    /// An object that is described in place.
    template <class Describe>
    void group(std::string_view name, const Describe& describe_group) {
        put(name, object_of(describe_group));
    }

    /// The same of what may be empty: then it is null.
    template <class Value, class Describe>
    void group_if(std::string_view name, const Value& value, const Describe& describe_group) {
        put(name, value ? object_of([&](JsonWriter& inner) { describe_group(inner, *value); }) : Json());
    }

    /// A list of objects, each described in place.
    template <class List, class Describe, class... Marks>
    void each(std::string_view name, const List& list, const Describe& describe_entry,
              const Marks&... /*of the reader*/) {
        Json entries = Json::array();
        for (const auto& entry : list)
            entries.push_back(object_of([&](JsonWriter& inner) { describe_entry(inner, entry); }));
        put(name, std::move(entries));
    }

    /// Null unless it is known. Tells whether it is.
    template <class Value, class... Marks>
    bool known(std::string_view name, bool is_known, const Value& value, const Marks&... marks) {
        put(name, is_known ? json_of(value, marks...) : Json(nullptr));
        return is_known;
    }

    /// Whether the document has such a field.
    [[nodiscard]] bool holds(std::string_view /*name*/, bool written) const { return written; }

    void put(std::string_view name, Json value) { json_[std::string(name)] = std::move(value); }

    /// The object that describe_object(JsonWriter&) describes.
    template <class Describe>
    [[nodiscard]] static Json object_of(const Describe& describe_object) {
        Json object = Json::object();
        JsonWriter inner(object);
        describe_object(inner);
        return object;
    }

  private:
    template <class Value>
    static bool is_empty(const Value& value) {
        if constexpr (requires { value.empty(); })
            return value.empty();
        else if constexpr (is_a<Value, Quantity>)
            return value.value() == 0.0;
        else
            return !value;
    }

    template <class Value, class... Marks>
    static Json json_of(const Value& value, const Marks&... marks) {
        if constexpr (std::is_same_v<Value, Json> || std::is_integral_v<Value>) {
            return value;
        } else if constexpr (std::is_same_v<Value, double>) {
            if constexpr (marked<StepsOf, Marks...>)
                return to_digits_in_row({value, mark_among(StepsOf{}, marks...).largest});
            return mark_among(Rounded{}, marks...).json_of(mark_among(Times{}, marks...).factor * value);
        } else if constexpr (is_a<Value, Quantity>) {
            return json_of(value.value(), marks...);
        } else if constexpr (std::is_enum_v<Value>) {
            return json_of(mark_among(Names<Value>{}, marks...).name_of(value), marks...);
        } else if constexpr (std::is_convertible_v<const Value&, std::string_view>) {
            const std::string_view text = value;
            return marked<NullIfEmpty, Marks...> && text.empty() ? Json(nullptr) : Json(text);
        } else if constexpr (is_a<Value, std::optional> || std::is_pointer_v<Value>) {
            return value ? json_of(*value, marks...) : Json(nullptr);
        } else if constexpr (HasEnds<const Value>) {
            const auto [first, second] = ends_of(value);
            return {json_of(first, marks...), json_of(second, marks...)};
        } else if constexpr (requires { value.begin(); }) {
            if (marked<NullIfEmpty, Marks...> && value.begin() == value.end()) return nullptr;
            Json list = Json::array();
            for (const auto& entry : value) list.push_back(json_of(entry, marks...));
            return list;
        } else {
            return object_of([&](JsonWriter& inner) { describe(inner, value); });
        }
    }

    Json& json_;
};

/// The value as an object.
template <class Value>
[[nodiscard]] Json to_json(const Value& value) {
    return JsonWriter::object_of([&](JsonWriter& json) { describe(json, value); });
}

}  // namespace ripplenotch
