// SPDX-License-Identifier: MIT
// Logs and messages in JSON, by nlohmann's parser: the first object says which numbers there are and where.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "log/messages/message_columns.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

/// How deep the records and lists of a message may lie in one another.
constexpr int deepest_field = 32;
constexpr std::size_t most_named_fields = 16384;
constexpr double largest_exact = 9007199254740992.0;  // 2^53: what a double holds of whole numbers

/// Throws DataError, without a source's name, where the bytes are none.
Json json_of(std::string_view text) {
    const auto is_shallow = [](int depth, Json::parse_event_t /*event*/, const Json& /*json*/) {
        if (depth > deepest_field)
            raise<DataError>("lists and objects deeper than {} in a message in JSON", deepest_field);
        return true;
    };
    try {
        return Json::parse(text.begin(), text.end(), is_shallow);
    } catch (const Json::parse_error& error) {
        raise<DataError>("byte {} of a message in JSON, where it is none, expected an object", error.byte);
    } catch (const Json::exception& error) {
        raise<DataError>("a message in JSON that is none: {}", error.what());
    }
}

Json parsed(std::string_view message) {
    Json json = json_of(message);
    if (json.is_array()) raise<DataError>("a list as a message in JSON, expected an object");
    if (!json.is_object()) raise<DataError>("a message in JSON that is no object");
    return json;
}

/// What has to be in every message.
struct Program {
    struct Number {
        Pointer at;
        std::string path;
        std::size_t leaf = 0;
        std::optional<double> ns_per_unit;  ///< of a part of a stamp
    };
    struct List {
        Pointer at;
        std::string path;
        std::size_t elements = 0;
    };
    struct Name {
        Pointer at;
        std::string path, text;
    };
    std::vector<MessageLeaf> leaves;
    std::vector<Number> numbers;
    std::vector<List> lists;
    std::vector<Name> names;  ///< of joints
};

double ns_per_unit(std::string_view key) {
    if (key == "sec" || key == "secs" || key == "seconds") return 1e9;
    return key == "nsec" || key == "nsecs" || key == "nanosec" || key == "nanos" ? 1.0 : 0.0;
}

bool is_number(const Json& json) { return json.is_number() || json.is_boolean(); }

/// Goes through the first message and writes down what is in it.
class JsonLayOut {
  public:
    explicit JsonLayOut(const Json& message) { record(message, Pointer(), ""); }
    Program program;

  private:
    using Names = std::vector<std::string>;

    void go_on(const Json& json, const Pointer& at, const std::string& path, const std::string& read_as,
               const Names& names, std::string_view key) {
        if (++fields_ > most_named_fields)
            raise<DataError>("messages of more than {} fields", most_named_fields);
        if (json.is_object()) return record(json, at, path);
        if (json.is_array()) return list(json, at, path, names, key);
        if (!is_number(json)) return;
        const bool large = json.is_number_integer() && std::abs(json.get<double>()) > largest_exact;
        add(path, read_as, large ? 'i' : 'f', false);
        program.numbers.push_back({at, path, program.leaves.size() - 1, {}});
    }
    void record(const Json& json, const Pointer& at, const std::string& path) {
        if (stamp(json, at, path)) return;
        const Names names = names_in(json, at, path);
        for (const auto& [key, value] : json.items()) {
            const std::string inner = path.empty() ? key : fmt::format("{}.{}", path, key);
            go_on(value, at / key, inner, inner, names, key);
        }
    }
    void list(const Json& json, const Pointer& at, const std::string& path, const Names& names,
              std::string_view key) {
        if (json.size() > most_listed_elements) return;
        if (!json.empty()) program.lists.push_back({at, path, json.size()});
        const bool named = !names.empty() && names.size() == json.size();
        for (std::size_t i = 0; i < json.size(); ++i) {
            const std::string inner = fmt::format("{}[{}]", path, i);
            go_on(json[i], at / i, inner, named ? fmt::format("{} {}", names[i], key) : inner, {}, {});
        }
    }
    // The texts of the list that names the joints of a record.
    Names names_in(const Json& json, const Pointer& at, const std::string& path) {
        Names names;
        for (const char* const key : {"name", "joint_names", "names"}) {
            const auto list = json.find(key);
            if (list == json.end() || !list->is_array() || list->size() > most_listed_elements) continue;
            if (!std::all_of(list->begin(), list->end(), [](const Json& one) { return one.is_string(); }))
                return {};
            for (std::size_t i = 0; i < list->size(); ++i) {
                names.push_back((*list)[i].get<std::string>());
                program.names.push_back({at / std::string(key) / i,
                                         fmt::format("{}{}{}[{}]", path, path.empty() ? "" : ".", key, i),
                                         names.back()});
            }
        }
        return names;
    }
    // A record of seconds and nanoseconds, and nothing else.
    bool stamp(const Json& json, const Pointer& at, const std::string& path) {
        if (json.size() != 2 || path.empty()) return false;
        double product = 1.0;
        for (const auto& [key, value] : json.items()) product *= value.is_number() ? ns_per_unit(key) : 0.0;
        if (product != 1e9) return false;
        add(path, path, 'i', true);
        for (const auto& [key, value] : json.items())
            program.numbers.push_back({at / key, path, program.leaves.size() - 1, ns_per_unit(key)});
        return true;
    }
    void add(const std::string& path, const std::string& read_as, char kind, bool stamp) {
        MessageLeaf leaf{path, read_as, {}, stamp, false};
        leaf.clock = stamp && !has_clock_ && (path == "header.stamp" || path == "timestamp");
        has_clock_ = has_clock_ || leaf.clock;
        leaf.type.kind = kind;
        leaf.type.big_endian = std::endian::native == std::endian::big;
        program.leaves.push_back(std::move(leaf));
    }

    std::size_t fields_ = 0;
    bool has_clock_ = false;
};

std::int64_t whole_of(const Json& number, double unit) {
    if (number.is_number_integer() && unit == 1.0) return number.get<std::int64_t>();
    const double value = number.get<double>() * unit;
    if (!(std::abs(value) < 9e18)) raise<DataError>("{} as a time in seconds", number.get<double>());
    return number.is_number_integer() ? number.get<std::int64_t>() * static_cast<std::int64_t>(unit)
                                      : std::llround(value);
}

const Json* find(const Json& json, const Pointer& at) { return json.contains(at) ? &json.at(at) : nullptr; }

// As ReadMessage does.
void read_numbers(const Program& program, const Json& json, const std::vector<bool>& wanted,
                  std::vector<LeafNumber>& into) {
    for (const Program::List& list : program.lists)
        if (const Json* const found = find(json, list.at);
            found != nullptr && found->is_array() && found->size() > list.elements)
            refuse_length(list.elements + 1, list.path + " and more", list.elements);
    for (const Program::Name& name : program.names)
        if (const Json* const found = find(json, name.at);
            found != nullptr && found->is_string() && *found != name.text)
            refuse_name(found->get<std::string>(), name.path, name.text);
    for (std::size_t leaf = 0; leaf < program.leaves.size(); ++leaf)
        if (wanted[leaf]) into[leaf] = {};
    for (const Program::Number& number : program.numbers) {
        if (!wanted[number.leaf]) continue;
        const Json* const found = find(json, number.at);
        const bool whole = program.leaves[number.leaf].type.whole();
        if (found == nullptr || !(whole ? found->is_number() : is_number(*found)))
            raise<DataError>(
                "no number as {}, expected one as in the first message; record messages of one shape on a "
                "topic",
                number.path);
        LeafNumber& leaf = into[number.leaf];
        if (whole) {
            if (__builtin_add_overflow(leaf.count, whole_of(*found, number.ns_per_unit.value_or(1.0)),
                                       &leaf.count))
                raise<DataError>("a time that is no number of seconds as {}", number.path);
            leaf.value = static_cast<double>(leaf.count);
        } else {
            leaf.value = found->is_boolean() ? (found->get<bool>() ? 1.0 : 0.0) : found->get<double>();
        }
    }
}

bool is_list_of_objects(const Json& json) {
    return json.is_array() && !json.empty() &&
           std::ranges::all_of(json, [](const Json& one) { return one.is_object(); });
}

bool is_list_of_numbers(const Json& json) {
    return json.is_array() && !json.empty() &&
           std::ranges::all_of(json, [](const Json& one) { return is_number(one) || one.is_null(); });
}

/// The longest list of objects, and lists of numbers by their length.
struct FoundLists {
    explicit FoundLists(const Json& json) { look(json, ""); }
    const Json* objects = nullptr;
    std::map<std::size_t, std::vector<std::pair<std::string, const Json*>>> numbers;

  private:
    void look(const Json& json, const std::string& path) {
        if (is_list_of_objects(json)) {
            if (objects == nullptr || json.size() > objects->size()) objects = &json;
        } else if (is_list_of_numbers(json)) {
            numbers[json.size()].emplace_back(path, &json);
        } else if (json.is_structured()) {
            for (const auto& [key, value] : json.items())
                look(value, json.is_array() ? fmt::format("{}[{}]", path, key)
                            : path.empty()  ? key
                                            : fmt::format("{}.{}", path, key));
        }
    }
};

std::unique_ptr<Columns> columns_of_lists(const std::string& source,
                                          const std::vector<std::pair<std::string, const Json*>>& lists) {
    std::vector<ColumnInfo> info;
    NumberRows numbers;
    for (const auto& [path, list] : lists) {
        const bool whole =
            std::all_of(list->begin(), list->end(), [](const Json& one) { return one.is_number_integer(); });
        info.push_back({path, "", "", whole, true});
        ColumnNumbers& column = numbers.emplace_back();
        for (const Json& one : *list) {
            const double truth = one.is_boolean() && one.get<bool>() ? 1.0 : 0.0;
            column.values.push_back(one.is_number()    ? one.get<double>()
                                    : one.is_boolean() ? truth
                                                       : not_a_number);
            if (whole) column.counts.push_back(one.get<std::int64_t>());
        }
    }
    return std::make_unique<HeldColumns>(source, std::move(info), std::move(numbers));
}

/// An object a line, a list of objects, or an object of lists of numbers; the longest that there is.
ColumnLog columns_of_json(const std::string& source, std::string_view text) {
    ColumnLog log;
    log.format = "json";
    // Of an object a line, the second begins as the first does.
    const std::size_t begin = text.find_first_not_of(" \t\r\n"), end = text.find('\n', begin);
    const std::size_t next = end == std::string_view::npos ? end : text.find_first_not_of(" \t\r\n", end);
    const bool lines = next != std::string_view::npos && text[begin] == '{' && text[next] == '{';
    std::optional<Program> program;
    std::vector<LeafNumber> numbers_of_row;
    std::vector<ColumnInfo> info;
    NumberRows numbers;
    std::size_t row = 0;
    const auto add_row = [&](const Json& object) {
        if (!program) {
            program = std::move(JsonLayOut(object).program);
            for (const MessageLeaf& leaf : program->leaves)
                info.push_back({leaf.path, leaf.read_as, leaf.stamp ? "ns" : "", leaf.type.whole(), true});
            numbers_of_row.resize(info.size());
            numbers.resize(info.size());
        }
        read_numbers(*program, object, std::vector<bool>(info.size(), true), numbers_of_row);
        for (std::size_t c = 0; c < info.size(); ++c) {
            numbers[c].values.push_back(numbers_of_row[c].value);
            if (info[c].whole) numbers[c].counts.push_back(numbers_of_row[c].count);
        }
    };
    try {
        for (const std::string_view line : lines ? split(text, '\n') : std::vector<std::string_view>()) {
            ++row;
            if (line.find_first_not_of(" \t\r") != std::string_view::npos) add_row(parsed(line));
        }
        const Json json = lines ? Json() : json_of(text);
        const FoundLists found(json);
        const std::size_t longest = found.numbers.empty() ? 0 : found.numbers.rbegin()->first;
        const bool objects = found.objects != nullptr && found.objects->size() >= longest;
        for (std::size_t k = 0; objects && k < found.objects->size(); ++k) {
            ++row;
            add_row((*found.objects)[k]);
        }
        if (lines || objects) {
            if (info.empty()) raise<DataError>("{}: read objects without numbers, expected some", source);
            log.columns = std::make_unique<HeldColumns>(source, std::move(info), std::move(numbers));
            return log;
        }
        if (longest < 2)
            raise<DataError>(
                "JSON without lists, expected an object a line, a list of objects, or an object of lists of "
                "numbers");
        log.columns = columns_of_lists(source, found.numbers.rbegin()->second);
    } catch (const DataError& error) {
        const std::string what = error.what();
        if (what.starts_with(source)) throw;
        raise<DataError>("{}{}: read {}", source,
                         row == 0 ? "" : fmt::format(": {} {}", lines ? "line" : "object", row), what);
    }
    return log;
}

constexpr std::array<std::string_view, 2> json_extensions = {".jsonl", ".ndjson"};

// An object, or a list of objects.
bool sniff(std::string_view bytes) {
    const auto next = [&bytes] {
        bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
        const char first = bytes.empty() ? '\0' : bytes.front();
        bytes.remove_prefix(bytes.empty() ? 0 : 1);
        return first;
    };
    const char first = next(), second = next();
    return (first == '{' && second == '"') || (first == '[' && second == '{');
}

ColumnLog make_json(std::unique_ptr<ByteSource> source, std::string text, const ReadOptions& /*options*/) {
    read_on(*source, text);
    return columns_of_json(source->name(), text);
}

}  // namespace

MessageLayout lay_out_json(std::string_view first) {
    const auto program = std::make_shared<const Program>(std::move(JsonLayOut(parsed(first)).program));
    return {program->leaves, [program](std::string_view message, const std::vector<bool>& wanted,
                                       std::vector<LeafNumber>& into) {
                read_numbers(*program, parsed(message), wanted, into);
            }};
}

const LogFormat formats::json{
    .name = "json",
    .summary = "JSON: an object a line, a list of objects, or an object of lists",
    .extensions = json_extensions,
    .binary = false,
    .sniff = sniff,
    .columns = make_json,
};

}  // namespace ripplenotch
