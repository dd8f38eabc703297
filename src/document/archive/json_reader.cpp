// SPDX-License-Identifier: MIT
#include "document/archive/json_reader.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::string in_words(const Json& value) {
    constexpr std::size_t most = 40;
    if (value.is_array()) return "a list";
    if (value.is_object()) return "an object";
    const std::string text = value.dump();
    return text.size() <= most ? text : text.substr(0, most) + "...";
}

JsonReader::JsonReader(const Json& object, std::string source, std::string path)
    : object_(object), source_(std::move(source)), path_(std::move(path)) {
    if (!object_.is_object()) {
        raise<DataError>("{}: {} is not an object", source_, path_.empty() ? "the document" : path_);
    }
}

std::string JsonReader::path_of(std::string_view name) const {
    return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name);
}

std::string JsonReader::where(std::string_view name) const {
    return fmt::format("{}: {}", source_, path_of(name));
}

const Json* JsonReader::find(std::string_view name) {
    seen_.emplace_back(name);
    const auto found = object_.find(std::string(name));
    return found == object_.end() || found->is_null() ? nullptr : &*found;
}

const Json& JsonReader::at(std::string_view name) {
    const Json* value = find(name);
    if (value == nullptr) raise<DataError>("{} is missing", where(name));
    return *value;
}

double JsonReader::number(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_number()) raise<DataError>("{} is {}, expected a number", where(name), in_words(value));
    return value.get<double>();
}

std::size_t JsonReader::whole(std::string_view name) {
    constexpr double most = 1e15;
    const double value = number(name);
    if (value < 0.0 || value != std::floor(value) || value > most)
        raise<DataError>("{} is {}, expected a whole number", where(name), value);
    return static_cast<std::size_t>(value);
}

bool JsonReader::flag(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_boolean()) raise<DataError>("{} is not true or false", where(name));
    return value.get<bool>();
}

std::string JsonReader::text(std::string_view name) {
    const Json& value = at(name);
    if (!value.is_string()) raise<DataError>("{} is {}, expected a text", where(name), in_words(value));
    return value.get<std::string>();
}

const Json& JsonReader::list(std::string_view name, std::size_t most) {
    const Json& value = at(name);
    if (!value.is_array()) raise<DataError>("{} is not a list", where(name));
    if (value.size() > most)
        raise<DataError>("{} has {} entries, expected at most {}", where(name), value.size(), most);
    return value;
}

std::vector<double> JsonReader::numbers(std::string_view name, bool unknown) {
    std::vector<double> values;
    for (const Json& value : list(name)) {
        if (!value.is_number() && !(unknown && value.is_null()))
            raise<DataError>("{} holds {}, expected numbers{}", where(name), in_words(value),
                             unknown ? " and null" : "");
        values.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
    }
    return values;
}

void JsonReader::check_bytes(std::string_view name, std::string_view value, const AtMost& most) const {
    if (value.size() > most.entries)
        raise<DataError>("{} has {} bytes, expected at most {}", where(name), value.size(), most.entries);
}

void JsonReader::read_array(std::string_view name, std::span<double> values) {
    const std::vector<double> found = numbers(name);
    if (found.size() != values.size())
        raise<DataError>("{} holds {} numbers, expected {}", where(name), found.size(), values.size());
    std::copy(found.begin(), found.end(), values.begin());
}

std::vector<std::string> JsonReader::texts(std::string_view name) {
    std::vector<std::string> values;
    for (const Json& value : list(name)) {
        if (!value.is_string()) raise<DataError>("{} holds {}, expected texts", where(name), in_words(value));
        values.push_back(value.get<std::string>());
    }
    return values;
}

std::vector<int> JsonReader::whole_numbers(std::string_view name, const Limits& limits) {
    std::vector<int> values;
    for (const double value : numbers(name)) {
        if (!limits.hold(value) || value != std::floor(value))
            raise<DataError>("{} holds {}, expected whole numbers from {} to {}", where(name), value,
                             limits.least, limits.most);
        values.push_back(static_cast<int>(value));
    }
    return values;
}

JsonReader JsonReader::object(std::string_view name) { return {at(name), source_, path_of(name)}; }

std::pair<double, double> JsonReader::two_numbers(const Json& value, const std::string& what, bool rising) {
    if (value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number()) {
        const std::pair numbers{value[0].get<double>(), value[1].get<double>()};
        if (!rising || numbers.first <= numbers.second) return numbers;
    }
    raise<DataError>("{} {}, expected two numbers{}", what, in_words(value),
                     rising ? ", the lower one first" : "");
}

void JsonReader::refuse_name(std::string_view name, const std::string& word, const std::string& known) const {
    raise<DataError>("{} is \"{}\", expected one of {}", where(name), word, known);
}

void JsonReader::refuse_number(std::string_view name, double value, const Limits& limits) const {
    const std::string least = shortest(limits.least), most = shortest(limits.most);
    std::string expected = fmt::format("{} to {}", least, most);
    if (limits.above) expected = fmt::format("a number above {} and at most {}", least, most);
    if (limits.above && std::isinf(limits.most)) expected = "a positive number";
    raise<DataError>("{} is {}, expected {}{}", where(name), shortest(value), expected,
                     limits.or_null ? " or null" : "");
}

void JsonReader::ignore(std::initializer_list<std::string_view> names) {
    for (const auto name : names) seen_.emplace_back(name);
}

std::vector<std::string> JsonReader::not_asked_for() const {
    std::vector<std::string> names;
    for (const auto& [name, value] : object_.items())
        if (std::find(seen_.begin(), seen_.end(), name) == seen_.end()) names.push_back(name);
    return names;
}

void JsonReader::finish() const {
    for (const std::string& name : not_asked_for())
        raise<DataError>("{} is not a known field; remove it or check its spelling", where(name));
}

}  // namespace ripplenotch
