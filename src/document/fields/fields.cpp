// SPDX-License-Identifier: MIT
#include "document/fields/fields.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::string in_words(const Json& value) {
    constexpr std::size_t most = 40;
    if (value.is_array()) return "a list";
    if (value.is_object()) return "an object";
    const std::string text = value.dump();
    return text.size() <= most ? text : text.substr(0, most) + "...";
}

Fields::Fields(const Json& object, std::string source, std::string path)
    : object_(object), source_(std::move(source)), path_(std::move(path)) {
    if (!object_.is_object()) {
        raise<DataError>("{}: {} is not an object", source_, path_.empty() ? "the document" : path_);
    }
}

std::string Fields::path_of(std::string_view name) const {
    return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name);
}

std::string Fields::where(std::string_view name) const {
    return fmt::format("{}: {}", source_, path_of(name));
}

const Json* Fields::find(std::string_view name) {
    seen_.emplace_back(name);
    const auto found = object_.find(std::string(name));
    return found == object_.end() || found->is_null() ? nullptr : &*found;
}

const Json& Fields::at(std::string_view name) {
    const Json* value = find(name);
    if (value == nullptr) raise<DataError>("{} is missing", where(name));
    return *value;
}

double Fields::number(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_number()) raise<DataError>("{} is {}, expected a number", where(name), in_words(value));
    return value.get<double>();
}

std::optional<double> Fields::number_if_any(std::string_view name) {
    if (!has(name)) return std::nullopt;
    return number(name);
}

std::size_t Fields::whole(std::string_view name) {
    constexpr double most = 1e9;
    const double value = number(name);
    if (value < 0.0 || value != std::floor(value) || value > most)
        raise<DataError>("{} is {}, expected a whole number", where(name), value);
    return static_cast<std::size_t>(value);
}

bool Fields::flag(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_boolean()) raise<DataError>("{} is not true or false", where(name));
    return value.get<bool>();
}

std::string Fields::text(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_string()) raise<DataError>("{} is {}, expected a text", where(name), in_words(value));
    return value.get<std::string>();
}

const Json& Fields::list(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_array()) raise<DataError>("{} is not a list", where(name));
    return value;
}

std::vector<double> Fields::numbers(std::string_view name) {
    std::vector<double> values;
    for (const Json& value : list(name)) {
        if (!value.is_number())
            raise<DataError>("{} holds {}, expected numbers", where(name), in_words(value));
        values.push_back(value.get<double>());
    }
    return values;
}

std::vector<std::string> Fields::texts(std::string_view name) {
    std::vector<std::string> values;
    for (const Json& value : list(name)) {
        if (!value.is_string()) raise<DataError>("{} holds {}, expected texts", where(name), in_words(value));
        values.push_back(value.get<std::string>());
    }
    return values;
}

Fields Fields::object(std::string_view name) { return {at(name), source_, path_of(name)}; }

void Fields::refuse_name(std::string_view name, const std::string& word) const {
    raise<DataError>("{} is \"{}\", which is none of its names", where(name), word);
}

const Json& Fields::list(std::string_view name, std::size_t most) {
    const Json& value = list(name);
    if (value.size() > most)
        raise<DataError>("{} has {} entries, expected at most {}", where(name), value.size(), most);
    return value;
}

void Fields::ignore_head() {
    for (const std::string_view name : {"schema", "tool", "version", "command"})
        if (has(name)) static_cast<void>(text(name));
    if (has("inputs")) {
        each("inputs", [](Fields& input) {
            static_cast<void>(input.text("name"));
            if (input.has("sha256")) static_cast<void>(input.text("sha256"));
            if (input.has("rows")) static_cast<void>(input.whole("rows"));
        });
    }
    ignore({"recording", "recordings"});
}

void Fields::ignore(std::initializer_list<std::string_view> names) {
    for (const auto name : names) seen_.emplace_back(name);
}

void Fields::finish() const {
    for (const auto& [name, value] : object_.items()) {
        if (std::find(seen_.begin(), seen_.end(), name) == seen_.end()) {
            raise<DataError>("{} is not a known field; remove it or check its spelling", where(name));
        }
    }
}

}  // namespace ripplenotch
