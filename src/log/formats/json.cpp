// SPDX-License-Identifier: MIT
// Logs in JSON: an object a line, a list of objects, or an object of lists.

#include <array>
#include <limits>

#include "log/formats.hpp"
#include "log/messages/json_message.hpp"
#include "log/read.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> extensions = {".jsonl", ".ndjson"};

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
    text.resize(read_on(*source, text, text.size(), std::numeric_limits<std::size_t>::max()));
    return columns_of_json(source->name(), text);
}

}  // namespace

const LogFormat formats::json{
    .name = "json",
    .summary = "JSON: an object a line, a list of objects, or an object of lists",
    .extensions = extensions,
    .binary = false,
    .sniff = sniff,
    .open = open_as_columns<make_json>,
};

}  // namespace ripplenotch
